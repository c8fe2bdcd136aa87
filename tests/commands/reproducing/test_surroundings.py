"""Figures 13 to 15."""

from dataclasses import replace

import pytest

from mpap_cli.commands.reproducing.surroundings import progress_of
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
from tests.outputs.novelty_windows import windows


def test_named_places_are_explored_by_both_profiles(tried: Tried) -> None:
    """Each log is an environment; profile paper, with a narrower radius, finds more novel."""
    bench = tried("surroundings", indoor=(A,), outdoor=(B,))

    first = {
        (place, profile): ours(
            bench, "Figure 13", f"{place}, profile {profile}", "novel in the first minute (%)"
        )
        for place in ("Indoor", "Outdoor")
        for profile in ("robust", "paper")
    }
    for place in ("Indoor", "Outdoor"):
        robust, paper = first[place, "robust"], first[place, "paper"]
        assert robust is not None
        assert paper is not None
        assert 0 < robust < paper <= 100
        exemplars = ours(bench, "Figure 13", f"{place}, profile paper", "exemplars")
        assert exemplars is not None
        assert exemplars > 0
    assert files(bench) == ["figure-13.png", "figure-14.png", "figure-15.png"]
    assert [item.name for item in bench.found.inputs] == ["camera-a.mcap", "camera-b.mcap"]
    (finding,) = bench.found.findings
    assert f"{first['Outdoor', 'robust']:.0f}" in finding.words


def test_clusters_of_both_places_are_drawn(tried: Tried) -> None:
    """Exemplars stand side by side, rows of members one below the other; some are obstacles."""
    bench = tried("surroundings", "figure-14", "figure-15", indoor=(A,), outdoor=(B,))

    exemplars, members = picture(bench, "figure-14.png"), picture(bench, "figure-15.png")
    assert exemplars.shape[1] > 2 * 800
    assert members.shape[0] > members.shape[1] / 2
    half = exemplars.shape[1] // 2
    for side in (exemplars[:, :half], exemplars[:, half:]):
        assert share_of(side, (255, 255, 255)) < 0.9
    assert share_of(members, probability_color(1.0), tolerance=40) > 0.001
    assert bench.found.rows == []


def test_logs_of_the_novelty_experiment_are_environments(tried: Tried) -> None:
    """A log that is named twice is one environment."""
    bench = tried("surroundings", "figure-13", novelty=(A, B, A))

    rows = list(dict.fromkeys(row.row.partition(", ")[0] for row in bench.found.rows))
    assert rows == ["camera-a.mcap", "camera-b.mcap"]


@pytest.mark.slow
def test_simulated_places(tried: Tried) -> None:
    """Without logs an indoor and an outdoor place are simulated."""
    bench = tried("surroundings", "figure-13")

    assert {row.row.partition(",")[0] for row in bench.found.rows} == {"Indoor", "Outdoor"}
    assert bench.found.inputs == []


def test_the_beginning_and_the_end_are_summed_up() -> None:
    """First window, mean of the windows of the last five minutes, minutes of a majority."""
    assert progress_of(windows(60, 51, 20, 8, 6, 4, 12)) == (60, 10, 2)
    assert progress_of(windows(50, 90)) == (50, 70, 0)
    assert progress_of(windows(90, 80)) == (90, 85, 2)


def test_several_logs_are_on_one_clock() -> None:
    """What is novel in a second log counts at the end, though its times begin anew."""
    second = [replace(row, log_index=1) for row in windows(*[10.0] * 5)]

    assert progress_of([*windows(*[90.0] * 5), *second]) == (90, 10, 5)
