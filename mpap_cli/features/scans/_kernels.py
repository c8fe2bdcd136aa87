"""Compiled loops over a block of scans: cleaning, values of bins.

LANES scans go side by side (vector instructions), each with its sums in beam order: a value
does not depend on how a log is cut into blocks.
"""

import numpy as np
from numba import njit

from mpap_cli.features.scans.rows._kernels import fill_empty
from mpap_cli.observations import BoolArray, Float32Array, Float64Array, IntArray

F32 = Float32Array
F64 = Float64Array
I64 = IntArray

MIN, MAX, MEAN, SPAN, STEP, SLOPE = range(6)
DROPPED = -1.0
LANES = 32

_ZERO = np.float32(0.0)
_INF = np.float32(np.inf)


@njit(nogil=True, cache=True, error_model="numpy")
def _clean_row(row: F32, limits: F32, cleaned: F32) -> None:
    """Write the cleaned ranges of one scan."""
    range_min, reach, cap = limits[0], limits[1], limits[2]
    near, zero, none = limits[3], limits[4], limits[5]
    for i in range(row.size):
        r = row[i]
        value = r if r < cap else cap  # noqa: FURB136  # min() is slower
        value = near if r < range_min else value
        is_none = (r > reach) | (r < _ZERO) | (r != r)  # noqa: PLR0124  # NaN is no number
        value = none if is_none else value
        value = near if r == -_INF else value
        value = zero if r == _ZERO else value
        cleaned[i] = value


@njit(nogil=True, cache=True, error_model="numpy")
def _clean_block(ranges: F32, limits: F32, cleaned: F32) -> None:
    """Clean every scan of a block."""
    for i in range(ranges.shape[0]):
        _clean_row(ranges[i], limits, cleaned[i])


@njit(nogil=True, cache=True, error_model="numpy")
def _beam(beams: F32, position: int, stop: int) -> F32:
    """Return one beam of LANES scans, at ``stop`` and behind it the one before."""
    k = min(position, stop - 1)
    beam: F32 = beams[k if k < beams.shape[0] else k - beams.shape[0]]
    return beam


@njit(nogil=True, cache=True, error_model="numpy")
def _near(r: np.float32) -> np.float32:
    """Return a range, or infinity for a dropped beam."""
    return r if r >= _ZERO else _INF


@njit(nogil=True, cache=True, error_model="numpy")
def _reduce_extremes(beams: F32, start: int, stop: int, extremes: F32) -> None:
    """Find least (row 0) and greatest (row 1) range of one bin in LANES scans at once.

    Four beams a turn are fewer stores. Without a range they are infinity and below zero.
    """
    for s in range(LANES):
        extremes[0, s], extremes[1, s] = _INF, -_INF
    for position in range(start, stop, 4):
        a, b = _beam(beams, position, stop), _beam(beams, position + 1, stop)
        c, d = _beam(beams, position + 2, stop), _beam(beams, position + 3, stop)
        for s in range(LANES):
            near = min(_near(a[s]), _near(b[s]), _near(c[s]), _near(d[s]))
            extremes[0, s] = min(extremes[0, s], near)
            extremes[1, s] = max(extremes[1, s], a[s], b[s], c[s], d[s])


@njit(nogil=True, cache=True, error_model="numpy")
def _reduce_stretched(beams: F32, start: int, stop: int, stretch: F32, least: F32) -> None:
    """Lower ``least`` to the least stretched range of one bin in LANES scans at once."""
    for position in range(start, stop):
        k = position if position < beams.shape[0] else position - beams.shape[0]
        for s in range(LANES):
            r = beams[k, s]
            least[s] = min(least[s], r * stretch[k] if r >= _ZERO else _INF)


@njit(nogil=True, cache=True, error_model="numpy")
def _reduce_sums(beams: F32, start: int, stop: int, sums: F64) -> None:
    """Find sum (row 0) and number (row 1) of the ranges of one bin in LANES scans at once."""
    for s in range(LANES):
        sums[0, s] = sums[1, s] = 0.0
    for position in range(start, stop):
        k = position if position < beams.shape[0] else position - beams.shape[0]
        for s in range(LANES):
            r = np.float64(beams[k, s])
            sums[0, s] += max(r, 0.0)
            sums[1, s] += 1.0 if r >= 0.0 else 0.0


@njit(nogil=True, cache=True, error_model="numpy")
def _reduce_steps(beams: F32, start: int, stop: int, steps: F64) -> None:
    """Sum the steps of one bin in LANES scans at once.

    Rows: sum of absolute steps, sum of signed steps, number of steps, last range.
    """
    for s in range(LANES):
        steps[0, s] = steps[1, s] = steps[2, s] = 0.0
        steps[3, s] = -1.0
    for position in range(start, stop):
        k = position if position < beams.shape[0] else position - beams.shape[0]
        for s in range(LANES):
            r, before = np.float64(beams[k, s]), steps[3, s]
            is_step = (r >= 0.0) & (before >= 0.0)
            fall = before - r if is_step else 0.0
            steps[0, s] += abs(fall)
            steps[1, s] += fall
            steps[2, s] += 1.0 if is_step else 0.0
            steps[3, s] = r if r >= 0.0 else before


@njit(nogil=True, cache=True, error_model="numpy")
def _write_values(statistic: int, extremes: F32, sums: F64, steps: F64, values: F64) -> None:
    """Write the values of one bin in up to LANES scans, NaN where it holds no range."""
    for s in range(values.size):
        if statistic == MEAN:
            values[s] = sums[0, s] / sums[1, s]
        elif statistic in (STEP, SLOPE):
            total = steps[0, s] if statistic == STEP else steps[1, s]
            values[s] = total / max(steps[2, s], 1.0) if steps[3, s] >= 0.0 else np.nan
        elif extremes[1, s] < _ZERO:
            values[s] = np.nan
        elif statistic == MIN:
            values[s] = extremes[0, s]
        elif statistic == MAX:
            values[s] = extremes[1, s]
        else:
            values[s] = np.float64(extremes[1, s]) - np.float64(extremes[0, s])


@njit(nogil=True, cache=True, error_model="numpy")
def _take_bins(runs: I64, is_rest: BoolArray, is_taken: BoolArray) -> None:
    """Mark the bins that lie whole in the rest of a turn, and take their beams out of it."""
    for b in range(is_taken.size):
        beams = np.arange(runs[b, 0], runs[b, 1]) % is_rest.size
        if is_rest[beams].all():
            is_taken[b], is_rest[beams] = True, False


@njit(nogil=True, cache=True, error_model="numpy")
def _bin_block(  # a kernel takes plain arrays
    ranges: F32,
    limits: F32,
    runs: I64,
    stretch: F32,
    wants_front: bool,
    statistics: I64,
    held: F64,
    values: F64,
    nearest: F32,
    front: F32,
) -> None:
    """Clean, bin and reduce every scan of a block in one pass, LANES scans side by side.

    The last of the ``runs`` is not a bin but the beams ahead.
    """
    n_scans, n_bins, cap = ranges.shape[0], runs.shape[0] - 1, limits[2]
    n_turn = stretch.size
    wants_extremes = wants_sums = wants_steps = False
    for statistic in statistics:
        wants_extremes |= statistic in (MIN, MAX, SPAN)
        wants_sums |= statistic == MEAN
        wants_steps |= statistic in (STEP, SLOPE)
    n_ahead = runs[n_bins, 1] - runs[n_bins, 0]
    is_rest = np.zeros(n_turn, np.bool_)
    for position in range(n_ahead):
        is_rest[(runs[n_bins, 0] + position) % n_turn] = True
    is_ahead = np.zeros(n_bins, np.bool_)
    if wants_extremes:
        _take_bins(runs, is_rest, is_ahead)
    cleaned = np.zeros((LANES, ranges.shape[1]), np.float32)
    beams = np.zeros((n_turn, LANES), np.float32)
    extremes, least = np.empty((2, LANES), np.float32), np.empty((2, LANES), np.float32)
    sums, steps = np.empty((2, LANES), np.float64), np.empty((4, LANES), np.float64)
    for first in range(0, n_scans, LANES):
        last = min(first + LANES, n_scans)
        for i in range(first, last):
            _clean_row(ranges[i], limits, cleaned[i - first])
        for k in range(n_turn):
            for s in range(LANES):
                beams[k, s] = cleaned[s, k]
        least[:] = _INF
        for b in range(n_bins):
            if wants_front:
                _reduce_stretched(beams, runs[b, 0], runs[b, 1], stretch, least[1])
            if wants_extremes:
                _reduce_extremes(beams, runs[b, 0], runs[b, 1], extremes)
                if is_ahead[b]:
                    for s in range(LANES):
                        least[0, s] = min(least[0, s], extremes[0, s])
            if wants_sums:
                _reduce_sums(beams, runs[b, 0], runs[b, 1], sums)
            if wants_steps:
                _reduce_steps(beams, runs[b, 0], runs[b, 1], steps)
            for f in range(statistics.size):
                _write_values(statistics[f], extremes, sums, steps, values[f, first:last, b])
        for k in range(n_turn):
            if is_rest[k]:
                _reduce_extremes(beams, k, k + 1, extremes)
                for s in range(LANES):
                    least[0, s] = min(least[0, s], extremes[0, s])
        for i in range(first, last):
            nearest[i] = min(least[0, i - first], cap)
            front[i] = min(least[1, i - first], cap)
    for f in range(statistics.size):
        fill_empty(values[f], runs, np.float64(cap) if statistics[f] <= MEAN else 0.0, held[f])


def clean_block(ranges: F32, limits: F32) -> F32:
    """Return cleaned ranges (n, n_beams); see RangeLimits."""
    cleaned = np.empty(ranges.shape, np.float32)
    _clean_block(ranges, limits, cleaned)
    return cleaned


def bin_block(
    ranges: F32,
    limits: F32,
    runs: I64,
    stretch: F32,
    statistics: I64,
    held: F64,
    *,
    wants_front: bool = True,
) -> tuple[F64, F32, F32]:
    """Return values (statistics, n, bins), nearest ahead (n,) and nearest in front (n,).

    ``runs`` (bins + 1, 2) are runs start..stop-1 of beams, counted on over the end of the
    turn, the last of them the beams ahead. Nearest in front is the least range of all bins
    after each beam of the turn was multiplied by its ``stretch`` (n_turn,); the cap where it
    is not wanted. ``held`` (statistics, bins) are the values of the scan before, NaN if there
    is none; those of the last scan are written there.
    """
    n_scans, n_bins = ranges.shape[0], runs.shape[0] - 1
    values = np.empty((statistics.size, n_scans, n_bins), np.float64)
    nearest, front = np.empty(n_scans, np.float32), np.empty(n_scans, np.float32)
    _bin_block(ranges, limits, runs, stretch, wants_front, statistics, held, values, nearest, front)
    return values, nearest, front
