"""Figures 16 to 18."""

import numpy as np
import pytest

from mpap_cli.errors import UsageError
from tests.commands.reproducing.camera_benches import (
    A,
    B,
    files,
    ours,
    picture,
    share_of,
)
from tests.commands.reproducing.conftest import Tried

UNKNOWN = "unknown at start (%)"
BLUE, VERMILION = (178, 114, 0), (0, 94, 213)


def test_a_new_place_is_unknown_and_a_return_is_not(tried: Tried) -> None:
    """Named logs are A, B and A again; what was unknown is said in numbers and in words."""
    bench = tried("long term", novelty=(A, B, A))

    there = ours(bench, "Figure 17", "B", UNKNOWN)
    back = ours(bench, "Figure 17", "A again", UNKNOWN)
    assert there is not None
    assert back is not None
    assert ours(bench, "Figure 17", "A", UNKNOWN) is None
    assert there >= 90
    assert back <= 5
    words = {finding.item: finding.words for finding in bench.found.findings}
    assert f"{there:.0f} % was unknown" in words["figure-17"]
    assert "Figure 17" in words["figure-18"]
    assert files(bench) == ["figure-17.png", "figure-16.png"]
    plot = picture(bench, "figure-17.png")
    assert share_of(plot, BLUE) > 0.001
    assert share_of(plot, VERMILION) > 0.001
    assert len(bench.found.inputs) == 2


def test_images_of_each_log_stand_in_a_row(tried: Tried) -> None:
    """A and A again look alike, B does not: the mean color of their rows tells."""
    bench = tried("long term", "figure-16", novelty=(A, B, A))

    sheet = picture(bench, "figure-16.png").astype(np.float64)
    first, again, other = (
        sheet[26 + 202 * row : 26 + 202 * row + 192, 176:].mean(axis=(0, 1)) for row in range(3)
    )
    assert (first == again).all()
    assert np.abs(first - other).max() > 10


@pytest.mark.slow
def test_other_light_is_less_known_than_a_return(tried: Tried) -> None:
    """Of A' more is unknown than of A again, and less than of B; both chains are drawn."""
    bench = tried("long term", "figure-17", "figure-18")

    there, light = (ours(bench, "Figure 18", row, UNKNOWN) for row in ("B", "A'"))
    assert there is not None
    assert light is not None
    assert light < there
    assert files(bench) == ["figure-17.png", "figure-18.png"]


def test_three_logs_are_wanted(tried: Tried) -> None:
    """A glob that matches more is refused with what was found."""
    with pytest.raises(UsageError, match="found 4 logs, expected three"):
        tried("long term", novelty=(A, B, A, B))
