"""Compiled loops that sort things by the bearings at which they are seen.

Things are in the frame of the camera's foot (x ahead, y left): walls of two points, boxes
of four corners, round things of one.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from mpap_cli.observations import Float64Array, IntArray

F64 = Float64Array
I64 = IntArray

_TINY = 1e-9


class Bins(NamedTuple):
    """Bin by bin of bearing, the things that may be seen there, nearest first.

    ``near`` (n,): how near each thing comes; ``members[starts[b] : starts[b + 1]]`` are the
    things of bin b.
    """

    near: F64
    starts: I64
    members: I64


@njit(nogil=True, cache=True, error_model="numpy")
def _span(points: F64, count: int, radius: float) -> tuple[float, float, float]:
    """Return the bearings between which a thing is seen, and how near it comes."""
    first = math.atan2(points[0, 1], points[0, 0])
    if count == 1:
        gap = math.hypot(points[0, 0], points[0, 1])
        half = math.asin(min(radius / max(gap, _TINY), 1.0))
        return first - half, first + half, max(gap - radius, 0.0)
    low = high = 0.0
    near = math.inf
    for i in range(count):
        j = (i + 1) % count
        ax, ay = points[i, 0], points[i, 1]
        dx, dy = points[j, 0] - ax, points[j, 1] - ay
        share = -(ax * dx + ay * dy) / max(dx * dx + dy * dy, _TINY)
        share = min(max(share, 0.0), 1.0)
        near = min(near, math.hypot(ax + share * dx, ay + share * dy))
        turn = math.atan2(ay, ax) - first
        turn -= 2 * math.pi * math.floor(turn / (2 * math.pi) + 0.5)
        low = min(low, turn)
        high = max(high, turn)
    return first + low, first + high, near


@njit(nogil=True, cache=True, error_model="numpy")
def _spans(points: F64, counts: I64, solids: F64, spans: F64) -> None:
    """Write for each thing the bearings between which it is seen, and how near it comes."""
    for i in range(counts.size):
        low, high, near = _span(points[i], counts[i], solids[i, 0])
        spans[i, 0], spans[i, 1], spans[i, 2] = low, high, near


@njit(nogil=True, cache=True, error_model="numpy")
def _list_bins(spans: F64, reach: float, half_width: float, starts: I64, members: I64) -> None:
    """List for each bin of bearing the things seen in it, nearest first."""
    n_bins = starts.size - 1
    scale = n_bins / (2 * half_width)
    order = np.argsort(spans[:, 2])
    counts = np.zeros(n_bins, np.int64)
    for turn in (-2 * math.pi, 0.0, 2 * math.pi):
        for i in order:
            low = max(math.floor((spans[i, 0] + turn + half_width) * scale), 0)
            high = min(math.floor((spans[i, 1] + turn + half_width) * scale), n_bins - 1)
            if spans[i, 2] <= reach:
                for b in range(low, high + 1):
                    counts[b] += 1
    starts[0] = 0
    for b in range(n_bins):
        starts[b + 1] = starts[b] + counts[b]
    counts[:] = 0
    for i in order:
        if spans[i, 2] > reach:
            continue
        for turn in (-2 * math.pi, 0.0, 2 * math.pi):
            low = max(math.floor((spans[i, 0] + turn + half_width) * scale), 0)
            high = min(math.floor((spans[i, 1] + turn + half_width) * scale), n_bins - 1)
            for b in range(low, high + 1):
                members[starts[b] + counts[b]] = i
                counts[b] += 1


def list_bins(
    points: F64, counts: I64, solids: F64, reach_m: float, half_width_rad: float, n_bins: int
) -> Bins:
    """Return what may be seen in each bin of the bearings -half_width_rad..half_width_rad.

    ``points`` (n, 4, 2) with ``counts`` (n,) of them in use, radii in the first column of
    ``solids``; what is farther than ``reach_m`` is left out.
    """
    spans = np.empty((counts.size, 3))
    _spans(points, counts, solids, spans)
    starts = np.empty(n_bins + 1, np.int64)
    # less than a turn is in view, so that a thing is in a bin at most twice
    members = np.empty(2 * n_bins * counts.size, np.int64)
    _list_bins(spans, reach_m, half_width_rad, starts, members)
    return Bins(np.ascontiguousarray(spans[:, 2]), starts, members)
