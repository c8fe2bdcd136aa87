"""Windows of novelty as curves on one clock, for the plots of Fig. 13, 17 and 18."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.novelty import NoveltyRow
from mpap_cli.observations import Float64Array

# A single observation is drawn as wide as a second.
_THINNEST = 1 / 60


@dataclass(frozen=True, slots=True, eq=False)
class Course:
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


def corners(course: Course, values: Float64Array) -> tuple[Float64Array, Float64Array]:
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


def courses_of(rows: Sequence[NoveltyRow]) -> list[Course]:
    """Put the windows of all logs on one clock, gaps between logs and long pauses removed."""
    courses: list[Course] = []
    at = 0.0
    for index in dict.fromkeys(row.log_index for row in rows):
        mine = [row for row in rows if row.log_index == index]
        spans = np.array([(row.window_start_s, row.window_end_s) for row in mine]) / 60
        start, end = spans[:, 0], np.maximum(spans[:, 1], spans[:, 0] + _THINNEST)
        longest = float(np.max(end - start))
        pause = np.maximum(start[1:] - np.maximum.accumulate(end)[:-1] - longest, 0.0)
        shift = at - start[0] - np.concatenate(([0.0], np.cumsum(pause)))
        unknown = [row.percent_unknown_at_start for row in mine]
        course = Course(
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
