"""Novelty over time, the model carried on from log to log (Fig. 13, 17 and 18)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpap_cli.evaluation.novelty import Boundary, NoveltyRow
from mpap_cli.observations import Float64Array
from mpap_cli.outputs.figures import PREDICTION, figure_for, plain, say

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_UNKNOWN, _EDGE = "#D55E00", "#333333"
_WIDTH, _HEIGHT = 11.0, 4.6
# About as many letters of the heading of a log fit across the plot.
_LETTERS = 120
_FEWEST = 10
# A single observation is drawn as wide as a second.
_THINNEST = 1 / 60


@dataclass(frozen=True, slots=True, eq=False)
class _Course:
    """One log on the common clock, in minutes.

    ``start`` and ``end`` (n,) of its windows, ``novel`` and ``unknown`` (n,) percent, NaN
    where there is none.
    """

    log: str
    log_index: int
    start: Float64Array
    end: Float64Array
    novel: Float64Array
    unknown: Float64Array


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
    courses = _courses(rows)
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


def _frame(axis: "Axes", courses: Sequence[_Course]) -> None:
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


def _draw_course(axis: "Axes", course: _Course) -> None:
    """Draw both lines of one log."""
    x, novel = _line(course, course.novel)
    axis.fill_between(x, novel, color=PREDICTION, alpha=0.2, lw=0)
    axis.plot(x, novel, color=PREDICTION, lw=2)
    x, unknown = _line(course, course.unknown)
    axis.plot(x, unknown, color=_UNKNOWN, lw=2, ls="--")


def _line(course: _Course, values: Float64Array) -> tuple[Float64Array, Float64Array]:
    """Return the corners of the line of one log, NaN where it breaks.

    Windows that follow one another are steps; those that overlap are a curve through
    their middles.
    """
    x: list[Float64Array] = []
    y: list[Float64Array] = []
    broken = np.array([np.nan])
    gaps = np.flatnonzero(course.start[1:] > course.end[:-1]) + 1
    for part in np.split(np.arange(values.size), gaps):
        start, end, value = course.start[part], course.end[part], values[part]
        if np.any(start[1:] < end[:-1]):
            x += [start[:1], (start + end) / 2, end[-1:], broken]
            y += [value[:1], value, value[-1:], broken]
        else:
            x += [np.stack((start, end), axis=1).ravel(), broken]
            y += [np.repeat(value, 2), broken]
    return np.concatenate(x), np.concatenate(y)


def _name_logs(axis: "Axes", courses: Sequence[_Course], boundaries: Sequence[Boundary]) -> None:
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


def _heading(course: _Course, letters: int) -> str:
    """Return the name of a log, cut in the middle; its number where hardly anything fits."""
    name = course.log
    if len(name) <= letters:
        return name
    if letters < _FEWEST:
        return str(course.log_index)
    kept = letters - 3
    return f"{name[: kept - kept // 2]}...{name[len(name) - kept // 2 :]}"


def _courses(rows: Sequence[NoveltyRow]) -> list[_Course]:
    """Put the windows of all logs on one clock, gaps between logs and long pauses removed."""
    courses: list[_Course] = []
    at = 0.0
    for index in dict.fromkeys(row.log_index for row in rows):
        mine = [row for row in rows if row.log_index == index]
        spans = np.array([(row.window_start_s, row.window_end_s) for row in mine]) / 60
        start, end = spans[:, 0], np.maximum(spans[:, 1], spans[:, 0] + _THINNEST)
        longest = float(np.max(end - start))
        pause = np.maximum(start[1:] - np.maximum.accumulate(end)[:-1] - longest, 0.0)
        shift = at - start[0] - np.concatenate(([0.0], np.cumsum(pause)))
        unknown = [row.percent_unknown_at_start for row in mine]
        course = _Course(
            log=mine[0].log,
            log_index=index,
            start=start + shift,
            end=end + shift,
            novel=np.array([row.percent_novel for row in mine], dtype=np.float64),
            unknown=np.array(unknown, dtype=np.float64),
        )
        courses.append(course)
        at = float(course.end[-1])
    return courses
