"""Novelty over time, the model carried on from log to log (Fig. 13, 17 and 18)."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpap_cli.evaluation.novelty import Boundary, NoveltyRow
from mpap_cli.outputs.figures import PREDICTION, figure_for, plain, say
from mpap_cli.outputs.novelty_curves import Course, corners, courses_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_UNKNOWN, _EDGE = "#D55E00", "#333333"
_WIDTH, _HEIGHT = 11.0, 4.6
# About as many letters of the heading of a log fit across the plot.
_LETTERS = 120
_FEWEST = 10


def plot_novelty(
    path: Path, rows: Sequence[NoveltyRow], boundaries: Sequence[Boundary] = (), title: str = ""
) -> None:
    """Draw how much was new in each window, log after log (Fig. 13, 17, 18).

    Parameters
    ----------
    path : Path
        PNG to write.
    rows : sequence of NoveltyRow
        Windows in the order of novelty.csv. Time runs on from log to log; where a log has
        no observation for longer than a window, the gap is drawn one window wide.
    boundaries : sequence of Boundary
        What was met when each log began: the share that was unknown then is written
        above its log.
    title : str
        Heading.

    Notes
    -----
    A log too short for its name has its ``log_index`` above it, or nothing.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    courses = courses_of(rows)
    with figure_for(path, (_WIDTH, _HEIGHT)) as figure:
        axis = figure.subplots()
        _frame(axis, courses)
        for course in courses:
            _draw_course(axis, course)
        _name_logs(axis, courses, boundaries)
        if courses:
            figure.legend(*axis.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        else:
            say(axis, "nothing was observed")
        figure.suptitle(plain(title))


def _frame(axis: "Axes", courses: Sequence[Course]) -> None:
    """Draw axes in percent and minutes, and what the lines mean."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415  # slow to import

    axis.set(ylim=(0, 101), ylabel="new observations in %", xlabel="minutes of log time")
    axis.set_yticks(range(0, 101, 20))
    axis.margins(x=0)
    axis.xaxis.set_major_locator(MaxNLocator(steps=[1, 2, 5, 10]))
    axis.plot([], [], color=PREDICTION, lw=2, label="novel to the model as it learns on")
    if any(np.isfinite(course.unknown).any() for course in courses):
        words = "unknown to the model as it stood when the log began"
        axis.plot([], [], color=_UNKNOWN, lw=2, ls="--", label=words)


def _draw_course(axis: "Axes", course: Course) -> None:
    """Draw both lines of one log."""
    x, novel = corners(course, course.novel)
    axis.fill_between(x, novel, color=PREDICTION, alpha=0.2, lw=0)
    axis.plot(x, novel, color=PREDICTION, lw=2)
    x, unknown = corners(course, course.unknown)
    axis.plot(x, unknown, color=_UNKNOWN, lw=2, ls="--")


def _name_logs(axis: "Axes", courses: Sequence[Course], boundaries: Sequence[Boundary]) -> None:
    """Mark where logs meet, and write above each what it is and how much was unknown."""
    if not courses:
        return
    unknown = {one.log_index: one.percent_unknown_at_start for one in boundaries}
    whole = courses[-1].end[-1] - courses[0].start[0]
    place = axis.get_xaxis_transform()
    for course in courses:
        left, right = course.start[0], course.end[-1]
        if course is not courses[0]:
            axis.axvline(left, color=_EDGE, lw=1.5)
        letters = int(_LETTERS * (right - left) / whole)
        share = unknown.get(course.log_index)
        texts = [(1.09, _heading(course, letters), "black")]
        if share is not None:
            words = f"{share:.0f} % unknown"
            texts.append((1.02, words if len(words) <= letters else f"{share:.0f} %", _UNKNOWN))
        for height, text, color in texts:
            if len(text) <= letters:
                middle = (left + right) / 2
                axis.text(middle, height, plain(text), ha="center", color=color, transform=place)


def _heading(course: Course, letters: int) -> str:
    """Return the name of a log, cut in the middle; its number where hardly anything fits."""
    name = course.log
    if len(name) <= letters:
        return name
    if letters < _FEWEST:
        return str(course.log_index)
    kept = letters - 3
    return f"{name[: kept - kept // 2]}...{name[len(name) - kept // 2 :]}"
