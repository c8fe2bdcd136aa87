"""Plot of novelty over time."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mpap_cli.evaluation.novelty import Boundary, NoveltyRow
from mpap_cli.outputs.novelty_curves import corners, courses_of
from mpap_cli.outputs.novelty_plot import _heading, plot_novelty


def windows(
    log_index: int,
    starts_s: list[float],
    length_s: float = 60.0,
    unknown: float | None = 5.0,
    log: str = "_$a.mcap",
) -> list[NoveltyRow]:
    """Make the windows of one log, ever less of it novel."""
    return [
        NoveltyRow(
            log=log,
            log_index=log_index,
            sensor="image",
            window_start_s=start_s,
            window_end_s=start_s + length_s,
            start_stamp_ns=0,
            observations=100,
            novel=100 // (index + 1),
            percent_novel=100 / (index + 1),
            percent_unknown_at_start=unknown,
            clusters=None,
        )
        for index, start_s in enumerate(starts_s)
    ]


A_B_A = [
    *windows(0, [2, 62, 122], unknown=None),
    *windows(1, [900, 960], unknown=98.0),
    *windows(2, [0, 60], unknown=3.0),
]
BOUNDARIES = [
    Boundary(
        log="a",
        log_index=index,
        percent_unknown_at_start=share,
        first_window_percent=100.0,
        ratio=None,
    )
    for index, share in enumerate([None, 98.0, 3.0])
]
DRAWINGS: dict[str, Callable[[Path], None]] = {
    "logs": lambda path: plot_novelty(path, A_B_A, BOUNDARIES, "_images $x"),
    "no boundaries": lambda path: plot_novelty(path, A_B_A),
    "overlapping": lambda path: plot_novelty(path, windows(0, [0, 10, 20, 30, 400, 410])),
    "nothing": lambda path: plot_novelty(path, []),
    "one observation": lambda path: plot_novelty(path, windows(0, [7], 0.0)),
    "many logs": lambda path: plot_novelty(
        path,
        [row for index in range(60) for row in windows(index, [0, 60])],
        BOUNDARIES,
    ),
}


@pytest.mark.parametrize("name", DRAWINGS)
def test_same_windows_same_bytes(tmp_path: Path, name: str) -> None:
    """Every plot is drawn, twice with the same bytes."""
    DRAWINGS[name](tmp_path / "a.png")
    DRAWINGS[name](tmp_path / "b.png")

    content = (tmp_path / "a.png").read_bytes()
    assert content == (tmp_path / "b.png").read_bytes()
    assert content.startswith(b"\x89PNG")


def test_time_runs_on_across_logs() -> None:
    """Each log begins where the one before it ended, whatever its own clock says."""
    courses = courses_of(A_B_A)

    starts = [start for course in courses for start in course.start]
    assert starts == pytest.approx([0, 1, 2, 3, 4, 5, 6])
    assert [course.end[-1] for course in courses] == pytest.approx([3, 5, 7])
    assert np.isnan(courses[0].unknown).all()


def test_long_pause_is_drawn_one_window_wide() -> None:
    """A clock that jumps years ahead does not squeeze the rest of the plot."""
    course = courses_of(windows(0, [0, 60, 1e9, 1e9 + 90]))[0]

    assert course.start == pytest.approx([0, 1, 3, 4.5])


def test_line_steps_and_breaks_where_nothing_was_seen() -> None:
    """A window is level from its start to its end; a gap is not bridged."""
    course = courses_of(windows(0, [0, 60, 180]))[0]

    x, y = corners(course, course.novel)

    assert x[[0, 1, 2, 3]].tolist() == [0, 1, 1, 2]
    assert y[[0, 1, 2, 3]].tolist() == [100, 100, 50, 50]
    assert np.isnan([x[4], y[4]]).all()
    assert x[5:7].tolist() == [3, 4]


def test_overlapping_windows_are_a_curve_through_their_middles() -> None:
    """It reaches from the start of the first to the end of the last."""
    course = courses_of(windows(0, [0, 30, 60]))[0]

    x, y = corners(course, course.novel)

    assert x[:-1].tolist() == [0, 0.5, 1, 1.5, 2]
    assert y[:-1] == pytest.approx([100, 100, 50, 100 / 3, 100 / 3])


@pytest.mark.parametrize(
    ("letters", "heading"),
    [(30, "a_long_name.mcap"), (16, "a_long_name.mcap"), (11, "a_lo...mcap"), (9, "4"), (0, "4")],
)
def test_name_is_cut_to_the_width_of_its_log(letters: int, heading: str) -> None:
    """Where hardly anything fits there is the number of the log."""
    course = courses_of(windows(4, [0], log="a_long_name.mcap"))[0]

    assert _heading(course, letters) == heading
