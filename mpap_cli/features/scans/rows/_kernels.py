"""Compiled loops over rows of values: what is missing, least over a window of time, embedding."""

import numpy as np
from numba import njit

from mpap_cli.observations import Float32Array, Float64Array, IntArray

F32 = Float32Array
F64 = Float64Array
I64 = IntArray

_ABREAST = 8


@njit(nogil=True, cache=True, error_model="numpy")
def fill_empty(values: F64, runs: I64, empty: float, held: F64) -> None:
    """Give bins without a range the value of the scan before, or else ``empty``."""
    for i in range(values.shape[0]):
        for b in range(values.shape[1]):
            if np.isnan(values[i, b]):
                outside = runs[b, 0] == runs[b, 1]
                values[i, b] = empty if outside or np.isnan(held[b]) else held[b]
            held[b] = values[i, b]


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


@njit(nogil=True, cache=True, error_model="numpy")
def _mass_of(row: F64, sums: F64) -> float:
    """Sum a row as numpy does: eight sums side by side, then in pairs, then what is left."""
    n_abreast, mass = row.size // _ABREAST * _ABREAST, 0.0
    if n_abreast:
        sums[:] = 0.0
        for k in range(0, n_abreast, _ABREAST):
            for s in range(_ABREAST):
                sums[s] += row[k + s]
        low = (sums[0] + sums[1]) + (sums[2] + sums[3])
        mass = low + ((sums[4] + sums[5]) + (sums[6] + sums[7]))
    for k in range(n_abreast, row.size):
        mass += row[k]
    return mass


@njit(nogil=True, cache=True, error_model="numpy")
def _embed_rows(histograms: F64, root: float, zero_mass: float, points: F32, begin: int) -> int:
    """Write points of length ``root``; return how many values no histogram can have."""
    n_bins = histograms.shape[1]
    n_bad, sums = 0, np.empty(_ABREAST, np.float64)
    for i in range(histograms.shape[0]):
        row, point = histograms[i], points[i, begin : begin + n_bins]
        for k in range(n_bins):
            n_bad += 0 if 0.0 <= row[k] < np.inf else 1
        mass = _mass_of(row, sums)
        is_empty = mass <= zero_mass
        if is_empty:
            point[:] = np.float32(0.0)
        else:
            for k in range(n_bins):
                point[k] = np.float32(root * np.sqrt(row[k] / mass))
        points[i, begin + n_bins] = np.float32(root if is_empty else 0.0)
    return n_bad


def window_minimum(stamps_ns: I64, values: F64, n_before: int, window_ns: int) -> F64:
    """Return minima (n - n_before, columns) of values (n, columns) over a window of time.

    Rows before ``n_before`` only look on; a row exactly ``window_ns`` old still counts.
    """
    minima = np.empty((values.shape[0] - n_before, values.shape[1]), np.float64)
    _window_minimum(stamps_ns, values, n_before, window_ns, minima)
    return minima


def embed_rows(histograms: F64, root: float, zero_mass: float, points: F32, begin: int) -> int:
    """Write embedded histograms (n, bins) as points (n, bins + 1) of length ``root``.

    They stand in the columns of ``points`` from ``begin`` on, and are ``root`` times those of
    `distance.embed`: to the bit up to 128 bins. Returns how many values are negative or not
    finite; points are written for them too, without meaning.
    """
    return int(_embed_rows(np.ascontiguousarray(histograms), root, zero_mass, points, begin))
