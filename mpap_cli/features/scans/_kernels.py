"""Compiled loops over a block of scans: cleaning, values of bins, minimum over a window.

LANES scans go side by side (vector instructions), each with its sums in beam order: a value
does not depend on how a log is cut into blocks.
"""

import numpy as np
from numba import njit

from mpap_cli.observations import Float32Array, Float64Array, IntArray

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
        value = min(cap, r)
        value = near if r < range_min else value
        value = none if r > reach else value
        value = none if r < _ZERO else value
        value = near if r == -_INF else value
        value = zero if r == _ZERO else value
        value = none if r != r else value  # noqa: PLR0124  # NaN is not equal to itself
        cleaned[i] = value


@njit(nogil=True, cache=True, error_model="numpy")
def _clean_block(ranges: F32, limits: F32, cleaned: F32) -> None:
    """Clean every scan of a block."""
    for i in range(ranges.shape[0]):
        _clean_row(ranges[i], limits, cleaned[i])


@njit(nogil=True, cache=True, error_model="numpy")
def _reduce_extremes(beams: F32, start: int, stop: int, extremes: F32) -> None:
    """Find least (row 0) and greatest (row 1) range of one bin in LANES scans at once.

    Where all beams are dropped they are infinity and below zero.
    """
    for s in range(LANES):
        extremes[0, s], extremes[1, s] = _INF, -_INF
    for position in range(start, stop):
        k = position if position < beams.shape[0] else position - beams.shape[0]
        for s in range(LANES):
            r = beams[k, s]
            near = r if r >= _ZERO else _INF
            extremes[0, s] = min(extremes[0, s], near)
            extremes[1, s] = max(extremes[1, s], r)


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
def _fill_empty(values: F64, runs: I64, empty: float, held: F64) -> None:
    """Give bins without a range the value of the scan before, or else ``empty``."""
    for i in range(values.shape[0]):
        for b in range(values.shape[1]):
            if np.isnan(values[i, b]):
                outside = runs[b, 0] == runs[b, 1]
                values[i, b] = empty if outside or np.isnan(held[b]) else held[b]
            held[b] = values[i, b]


@njit(nogil=True, cache=True, error_model="numpy")
def _bin_block(  # a kernel takes plain arrays
    ranges: F32,
    limits: F32,
    runs: I64,
    stretch: F32,
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
    cleaned = np.empty(ranges.shape[1], np.float32)
    beams = np.zeros((n_turn, LANES), np.float32)
    extremes, least = np.empty((2, LANES), np.float32), np.empty(LANES, np.float32)
    sums, steps = np.empty((2, LANES), np.float64), np.empty((4, LANES), np.float64)
    for first in range(0, n_scans, LANES):
        last = min(first + LANES, n_scans)
        for i in range(first, last):
            _clean_row(ranges[i], limits, cleaned)
            for k in range(n_turn):
                beams[k, i - first] = cleaned[k]
        least[:] = _INF
        for b in range(n_bins):
            _reduce_stretched(beams, runs[b, 0], runs[b, 1], stretch, least)
            if wants_extremes:
                _reduce_extremes(beams, runs[b, 0], runs[b, 1], extremes)
            if wants_sums:
                _reduce_sums(beams, runs[b, 0], runs[b, 1], sums)
            if wants_steps:
                _reduce_steps(beams, runs[b, 0], runs[b, 1], steps)
            for f in range(statistics.size):
                _write_values(statistics[f], extremes, sums, steps, values[f, first:last, b])
        _reduce_extremes(beams, runs[n_bins, 0], runs[n_bins, 1], extremes)
        for i in range(first, last):
            nearest[i] = min(extremes[0, i - first], cap)
            front[i] = min(least[i - first], cap)
    for f in range(statistics.size):
        _fill_empty(values[f], runs, np.float64(cap) if statistics[f] <= MEAN else 0.0, held[f])


@njit(nogil=True, cache=True, error_model="numpy")
def _window_minimum(
    stamps_ns: I64, values: F64, n_before: int, window_ns: int, minima: F64
) -> None:
    """Write per column the least value of the rows not older than the window.

    ``queue`` holds rows of the window whose values rise: its head is the minimum.
    """
    n_rows, n_columns = values.shape
    queue = np.empty(n_rows, np.int64)
    for column in range(n_columns):
        head, tail = 0, 0
        for i in range(n_rows):
            while tail > head and values[queue[tail - 1], column] >= values[i, column]:
                tail -= 1
            queue[tail] = i
            tail += 1
            while stamps_ns[queue[head]] < stamps_ns[i] - window_ns:
                head += 1
            if i >= n_before:
                minima[i - n_before, column] = values[queue[head], column]


def clean_block(ranges: F32, limits: F32) -> F32:
    """Return cleaned ranges (n, n_beams); see RangeLimits."""
    cleaned = np.empty(ranges.shape, np.float32)
    _clean_block(ranges, limits, cleaned)
    return cleaned


def bin_block(
    ranges: F32, limits: F32, runs: I64, stretch: F32, statistics: I64, held: F64
) -> tuple[F64, F32, F32]:
    """Return values (statistics, n, bins), nearest ahead (n,) and nearest in front (n,).

    ``runs`` (bins + 1, 2) are runs start..stop-1 of beams, counted on over the end of the
    turn, the last of them the beams ahead. Nearest in front is the least range of all bins
    after each beam of the turn was multiplied by its ``stretch`` (n_turn,). ``held``
    (statistics, bins) are the values of the scan before, NaN if there is none; those of
    the last scan are written there.
    """
    n_scans, n_bins = ranges.shape[0], runs.shape[0] - 1
    values = np.empty((statistics.size, n_scans, n_bins), np.float64)
    nearest, front = np.empty(n_scans, np.float32), np.empty(n_scans, np.float32)
    _bin_block(ranges, limits, runs, stretch, statistics, held, values, nearest, front)
    return values, nearest, front


def window_minimum(stamps_ns: I64, values: F64, n_before: int, window_ns: int) -> F64:
    """Return minima (n - n_before, columns) of values (n, columns) over a window of time.

    Rows before ``n_before`` only look on; a row exactly ``window_ns`` old still counts.
    """
    minima = np.empty((values.shape[0] - n_before, values.shape[1]), np.float64)
    _window_minimum(stamps_ns, values, n_before, window_ns, minima)
    return minima
