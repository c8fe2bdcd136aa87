"""Figures 6 and 12, and the stopping distance."""

import numpy as np

from mpap_cli.commands.predicting.images import PredictedImages
from mpap_cli.commands.reproducing.decided_images import Decided, choose_decided
from mpap_cli.commands.reproducing.stopping_runs import Judged
from mpap_cli.evaluation.stopping import Stops, summarize_stops
from mpap_cli.outputs.canvas import probability_color
from tests.commands.reproducing.camera_benches import (
    A,
    B,
    files,
    ours,
    picture,
    share_of,
)
from tests.commands.reproducing.conftest import Tried

ITEM = "Stopping distance"
GREEN = (115, 158, 0)


def test_another_environment_is_unknown(tried: Tried) -> None:
    """Halves of two logs: a model knows the second half of its own log, not that of the other."""
    bench = tried("stopping", indoor=(A,), outdoor=(B,))

    own, other = (
        ours(bench, ITEM, row, "unknown patches (%)")
        for row in ("environment learnt", "another environment learnt")
    )
    assert own is not None
    assert other is not None
    assert own < 30
    assert other > 90
    row = "discrepancies (section 4.2.4)"
    assert ours(bench, ITEM, row, "clusters with both labels") is not None
    papers = {row.row: row.paper for row in bench.found.rows if row.quantity == "distance (m)"}
    assert papers["environment learnt"] == 0.94
    assert papers["another environment learnt"] is None
    assert files(bench) == ["figure-06.png", "figure-12.png"]
    sheet = picture(bench, "figure-06.png")
    assert share_of(sheet, GREEN) > 0.001
    assert share_of(sheet, probability_color(1.0)) > 0.001


def test_only_the_pictures(tried: Tried) -> None:
    """For a figure no other environment is predicted, and no number is written."""
    bench = tried("stopping", "figure-6", indoor=(A,))

    assert files(bench) == ["figure-06.png"]
    assert bench.found.rows == []
    assert len(list(bench.scratch.glob("*-on-*"))) == 1


def test_distances_are_those_of_every_stop() -> None:
    """Stops without a distance do not count; a test without contacts has no share."""
    stops = (
        Stops(np.array([1, 2]), np.array([0.5, np.nan])),
        Stops(np.array([4]), np.array([1.5])),
    )
    judged = Judged()

    for contacts in (0, 4):
        judged.add(
            PredictedImages(
                n_images=10,
                n_patches=360,
                n_obstacle=3,
                n_unknown=36,
                actions={},
                contacts=contacts,
                contacts_foreseen=contacts // 4,
                stops=stops,
                stopping=summarize_stops(stops),
                patch_threshold=0.5,
                inputs=(),
                exit_code=0,
            )
        )

    assert judged.distances_m == [0.5, 1.5, 0.5, 1.5]
    assert judged.announced == [None, 25]
    assert judged.unknown == [10, 10]


def test_the_most_balanced_image_of_each_action_is_chosen() -> None:
    """Of equals the first; an action that was never decided has no image."""
    decisions = [
        Decided("straight", 1, 0.1, 0),
        Decided("straight", 2, 0.2, 12),
        Decided("stop", 3, 0.3, 36),
        Decided("straight", 4, 0.4, 24),
    ]

    chosen = choose_decided(decisions, 36)

    assert [one.stamp_ns for one in chosen] == [2, 3]
