"""Compiled search for the nearest exemplar, and what a cluster learns from a point.

Decisions are made in float64 on sums of fixed order, so that results do not depend on the
processor; the float32 product only rules out exemplars that cannot be the nearest.
"""

import numpy as np
from numba import njit

from mpap_cli.clustering.strap_rows.arrays import Items
from mpap_cli.observations import Float32Array, Float64Array, IntArray

_compiled = njit(nogil=True, cache=True, error_model="numpy")
_LANES = 16
# Rounding of a float32 product of two vectors of length 1, per coordinate, twice over.
_ROUNDING = 1.3e-7
_CHUNK_BYTES = 1 << 20


def nearest(points: Float32Array, exemplars: Float32Array) -> tuple[IntArray, Float64Array]:
    """Find the nearest of k exemplars for each of m points, the first of equals.

    Parameters
    ----------
    points, exemplars : ndarray of shape (m, d) and (k, d)
        Of length 1; k is 1 or more.

    Returns
    -------
    tuple of ndarray of shape (m,)
        Rows of the exemplars, and squared distances (equation 7) in float64.
    """
    m, k = len(points), len(exemplars)
    rows, squared = np.empty(m, np.int64), np.empty(m)
    halves = 0.5 * np.square(exemplars, dtype=np.float64).sum(axis=1)
    halves32 = halves.astype(np.float32)
    slack = np.float32(_ROUNDING * (points.shape[1] + 4))
    step = max(1, _CHUNK_BYTES // (4 * k))
    products = np.empty((min(step, m), k), np.float32)
    for start in range(0, m, step):
        part = slice(start, start + step)
        block = points[part]
        np.matmul(block, exemplars.T, out=products[: len(block)])
        _nearest(block, exemplars, products, halves32, slack, rows[part], squared[part])
    return rows, squared


@_compiled
def _nearest(
    points: Float32Array,
    exemplars: Float32Array,
    products: Float32Array,
    halves: Float32Array,
    slack: np.float32,
    rows: IntArray,
    squared: Float64Array,
) -> None:
    """Go through the exemplars whose product comes near the best one.

    The largest of product minus half the squared length of the exemplar is the nearest.
    """
    k = len(exemplars)
    whole = k - k % _LANES
    lanes = np.empty(_LANES, np.float32)
    for i in range(len(points)):
        product = products[i]
        lanes[:] = -np.inf
        for start in range(0, whole, _LANES):
            for lane in range(_LANES):
                value = product[start + lane] - halves[start + lane]
                lanes[lane] = max(lanes[lane], value)
        best = np.float32(-np.inf)
        for lane in range(_LANES):
            best = max(best, lanes[lane])
        for row in range(whole, k):
            best = max(best, product[row] - halves[row])
        limit = best - slack
        least, nearest_row = np.inf, -1
        for row in range(k):
            if product[row] - halves[row] >= limit:
                total = 0.0
                for j in range(points.shape[1]):
                    step = np.float64(points[i, j]) - np.float64(exemplars[row, j])
                    total += step * step
                if total < least:
                    least, nearest_row = total, row
        rows[i], squared[i] = nearest_row, 0.5 * least


@_compiled
def absorb(
    clusters: Items, rows: IntArray, squared: Float64Array, stamps_ns: IntArray, window_ns: float
) -> None:
    """Let points update the clusters of these rows, one after the other (section 3.3).

    With a window, n (g + 1 / (n + 1)) takes the place of n + 1, and the distortion fades
    likewise, g = window / (window + time since the last update); window 0 means none.
    """
    for i in range(len(rows)):
        row, now = rows[i], stamps_ns[i]
        n = clusters.weight[row]
        if window_ns > 0:
            g = window_ns / (window_ns + max(0, now - clusters.faded_ns[row]))
            clusters.weight[row] = n * (g + 1.0 / (n + 1.0))
            clusters.distortion[row] = g * clusters.distortion[row] + n / (n + 1.0) * squared[i]
        else:
            clusters.weight[row] = n + 1.0
            clusters.distortion[row] += squared[i]
        clusters.counts[row] += 1
        clusters.last_ns[row] = now
        clusters.faded_ns[row] = now
