"""The large-scale lines of table 3."""

import numpy as np

from mpap_cli.commands.reproducing.large_scale import summarize
from tests.commands.reproducing.camera_benches import A, B, ours
from tests.commands.reproducing.conftest import Tried

ITEM = "Table 3, large-scale data"


def test_every_patch_of_named_logs_is_clustered(tried: Tried) -> None:
    """Named logs are not cut: 36 patches of each image; few of them are left to cluster."""
    bench = tried("large scale", indoor=(A,), outdoor=(B,))

    for place, n_images in (("Indoor", 60), ("Outdoor", 44)):
        left = ours(bench, ITEM, place, "clustered points")
        assert ours(bench, ITEM, place, "raw points") == 36 * n_images
        assert left is not None
        assert 1 < left < 36 * n_images / 10
    papers = [row.paper for row in bench.found.rows if row.quantity == "duration (s)"]
    assert sorted(paper or 0 for paper in papers) == [185, 307]
    assert "paper: 1.3 to 1.9 %" in bench.found.findings[0].words


def test_tight_groups_are_clusters() -> None:
    """Three directions with a little noise: three meta-points, as many clusters, all covered."""
    rng = np.random.default_rng(3)
    features = np.eye(3, 8, dtype=np.float32)[np.arange(300) % 3]
    features += rng.uniform(0, 0.01, features.shape).astype(np.float32)
    features /= np.linalg.norm(features, axis=1, keepdims=True)

    found = summarize(features, np.arange(300))

    assert (found.raw_points, found.cluster_points, found.coverage) == (300, 3, 1.0)
    assert 1 <= found.clusters <= 3


def test_nothing_is_written_of_a_place_that_was_not_named(tried: Tried) -> None:
    """With indoor logs only there is no outdoor line."""
    bench = tried("large scale", indoor=(A,))

    assert {row.row for row in bench.found.rows} == {"Indoor"}
