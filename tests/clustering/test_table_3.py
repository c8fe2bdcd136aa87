"""Table 3 of the paper in shape: ten Gaussians, with and without noise."""

import numpy as np
import pytest
from sklearn.metrics import v_measure_score

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.distance import similarities, squared_distances
from mpap_cli.observations import Float32Array, Float64Array, IntArray
from mpap_cli.params import AffinityParams, MetaPointParams

MEDIAN = AffinityParams(preference="median")


def gaussians(seed: int, n_noise: int) -> tuple[Float32Array, IntArray]:
    """2,000 points around ten centres 8 sd or more apart, and uniform noise (label -1).

    The centres lie close together, as in figure 8; in a world twice as wide the median
    similarity is so low that two of ten far neighbours may share a cluster.
    """
    rng = np.random.default_rng(seed)
    centres: list[Float64Array] = []
    while len(centres) < 10:
        centres = []
        for centre in rng.uniform(0, 27, (200, 2)):
            if all(np.linalg.norm(centre - other) >= 8 for other in centres):
                centres.append(centre)
    centres = centres[:10]
    labels = rng.integers(0, 10, 2000)
    points = np.array(centres)[labels] + rng.normal(size=(2000, 2))
    points = np.concatenate([points, rng.uniform(-4, 31, (n_noise, 2))])
    labels = np.concatenate([labels, np.full(n_noise, -1)])
    order = rng.permutation(len(points))
    return points[order].astype(np.float32), labels[order]


@pytest.mark.slow
@pytest.mark.parametrize("n_noise", [0, 500])
@pytest.mark.parametrize("seed", range(10))
def test_mpap_finds_the_ten_clusters(seed: int, n_noise: int) -> None:
    """From 90 to 130 cluster-points, with V = 1 on the points that are no noise."""
    points, truth = gaussians(seed, n_noise)
    meta_points = MetaPoints(MetaPointParams(theta=0.7, min_points=5), 2, normalised=False)

    meta_points.add_data_points(points, np.arange(len(points)))
    clustering = meta_points.cluster(MEDIAN)

    cluster_points = meta_points.references()[meta_points.is_cluster_point]
    nearest = squared_distances(points, cluster_points, normalised=False).argmin(axis=1)
    found = clustering.labels[nearest]
    assert len(clustering.exemplars) == 10
    assert 90 <= len(cluster_points) <= 130
    assert v_measure_score(truth[truth >= 0], found[truth >= 0]) == pytest.approx(1.0)


@pytest.mark.slow
@pytest.mark.parametrize(("n_noise", "low", "high"), [(0, 10, 10), (500, 15, 40)])
def test_affinity_propagation_splits_clusters_because_of_noise(
    n_noise: int, low: int, high: int
) -> None:
    """With median preference it finds ten clusters without noise and many more with it."""
    points, _ = gaussians(0, n_noise)
    s = similarities(points, normalised=False)

    clustering = affinity_propagation(s, resolve_preference(s, "median"), MEDIAN)

    assert low <= len(clustering.exemplars) <= high
