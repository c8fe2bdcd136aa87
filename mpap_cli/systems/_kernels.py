"""Compiled search for several nearest exemplars; the decision is made in float64."""

import numpy as np
from numba import njit

from mpap_cli.observations import Float32Array, Float64Array, IntArray

# Rounding of a float32 product of two vectors of length 1, per coordinate, twice over.
_ROUNDING = 1.3e-7


def find_several(
    points: Float32Array, exemplars: Float32Array, k: int
) -> tuple[IntArray, Float64Array]:
    """Find the k nearest of f exemplars for each of m points.

    Parameters
    ----------
    points, exemplars : ndarray of shape (m, d) and (f, d)
        Of length 1; f is k or more.
    k : int
        1 or more.

    Returns
    -------
    tuple of ndarray of shape (m, k)
        Rows of the exemplars and squared distances (equation 7), the nearest first, of
        equals the first.
    """
    m = len(points)
    rows, squared = np.empty((m, k), np.int64), np.empty((m, k))
    halves = 0.5 * np.square(exemplars, dtype=np.float64).sum(axis=1)
    closeness = points @ exemplars.T - halves.astype(np.float32)
    slack = np.float32(_ROUNDING * (points.shape[1] + 4))
    _find_several(points, exemplars, closeness, slack, rows, squared)
    return rows, squared


@njit(nogil=True, cache=True, error_model="numpy")
def _find_several(
    points: Float32Array,
    exemplars: Float32Array,
    closeness: Float32Array,
    slack: np.float32,
    rows: IntArray,
    squared: Float64Array,
) -> None:
    """Compare exactly what float32 cannot rule out, and insert it into the sorted result.

    ``closeness`` (m, f) is product minus half the squared length of the exemplar.
    """
    k = rows.shape[1]
    best = np.empty(k, np.float32)
    for i in range(len(points)):
        best[:] = -np.inf  # the k largest, falling
        for row in range(len(exemplars)):
            value = closeness[i, row]
            if value > best[k - 1]:
                at = k - 1
                while at > 0 and best[at - 1] < value:
                    best[at] = best[at - 1]
                    at -= 1
                best[at] = value
        limit = best[k - 1] - slack
        squared[i] = np.inf
        for row in range(len(exemplars)):
            if closeness[i, row] >= limit:
                total = 0.0
                for j in range(points.shape[1]):
                    step = np.float64(points[i, j]) - np.float64(exemplars[row, j])
                    total += step * step
                total *= 0.5
                if total < squared[i, k - 1]:
                    at = k - 1
                    while at > 0 and squared[i, at - 1] > total:
                        squared[i, at], rows[i, at] = squared[i, at - 1], rows[i, at - 1]
                        at -= 1
                    squared[i, at], rows[i, at] = total, row
