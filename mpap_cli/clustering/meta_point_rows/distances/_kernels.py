"""Compiled distances; decisions are made on float64 sums of fixed order."""

import math

import numpy as np
from numba import njit

from mpap_cli.clustering.meta_point_rows.tables import LANES
from mpap_cli.observations import Float32Array, Float64Array, FloatArray

compiled = njit(nogil=True, cache=True, error_model="numpy")
# For sums that decide nothing, which may run in any order.
filtering = njit(nogil=True, cache=True, error_model="numpy", fastmath={"reassoc", "contract"})


@compiled
def squared_distance(u: FloatArray, rows: FloatArray, row: int) -> float:
    """Sum of squared differences in four strands, the last coordinates in the first strand."""
    n = len(u)
    whole = n - n % 4
    sum0 = sum1 = sum2 = sum3 = 0.0
    for j in range(0, whole, 4):
        step0 = np.float64(u[j]) - rows[row, j]
        step1 = np.float64(u[j + 1]) - rows[row, j + 1]
        step2 = np.float64(u[j + 2]) - rows[row, j + 2]
        step3 = np.float64(u[j + 3]) - rows[row, j + 3]
        sum0 += step0 * step0
        sum1 += step1 * step1
        sum2 += step2 * step2
        sum3 += step3 * step3
    for j in range(whole, n):
        step0 = np.float64(u[j]) - rows[row, j]
        sum0 += step0 * step0
    return (sum0 + sum1) + (sum2 + sum3)


@compiled
def bounded_distance(u: FloatArray, rows: FloatArray, row: int, bound: float) -> float:
    """Return the same sum, or inf as soon as it is above bound."""
    n = len(u)
    whole = n - n % 4
    sum0 = sum1 = sum2 = sum3 = 0.0
    for j in range(0, whole, 4):
        step0 = np.float64(u[j]) - rows[row, j]
        step1 = np.float64(u[j + 1]) - rows[row, j + 1]
        step2 = np.float64(u[j + 2]) - rows[row, j + 2]
        step3 = np.float64(u[j + 3]) - rows[row, j + 3]
        sum0 += step0 * step0
        sum1 += step1 * step1
        sum2 += step2 * step2
        sum3 += step3 * step3
        if (j + 4) % 16 == 0 and (sum0 + sum1) + (sum2 + sum3) > bound:
            return math.inf
    for j in range(whole, n):
        step0 = np.float64(u[j]) - rows[row, j]
        sum0 += step0 * step0
    return (sum0 + sum1) + (sum2 + sum3)


@filtering
def half_square(u: Float32Array) -> float:
    """Half of the squared length of a vector, but for rounding."""
    total = 0.0
    for j in range(len(u)):
        total += np.float64(u[j]) * np.float64(u[j])
    return 0.5 * total


@filtering
def moved_squared(copy: Float32Array, reference: Float64Array) -> float:
    """Squared distance, a little more of it, and of what rounding adds."""
    total = 0.0
    for j in range(len(copy)):
        step = reference[j] - np.float64(copy[j])
        total += step * step
    return total * (1.0 + 1e-9)


@compiled
def half_squares(points: Float32Array, halves: Float64Array) -> None:
    """Write half of the squared length of each point (m,); inf or NaN where it is not finite."""
    for i in range(len(points)):
        halves[i] = half_square(points[i])


@filtering
def dot(u: Float32Array, v: Float32Array) -> np.float32:
    """Product of two vectors, as near as float32 sums in any order are."""
    total = np.float32(0.0)
    for j in range(len(u)):
        total += u[j] * v[j]
    return total


@compiled
def least_of_lanes(
    heights: Float32Array, products: Float32Array, n: int, half: np.float32, lanes: Float32Array
) -> int:
    """Write the least of each lane; return the lane of the least of all.

    What is compared is a lower bound of half of the squared distance. Columns behind the
    last one up to a whole number of lanes are of height inf.
    """
    lanes[:] = np.inf
    for start in range(0, n, LANES):
        height, product = heights[start : start + LANES], products[start : start + LANES]
        for lane in range(LANES):
            lanes[lane] = min(lanes[lane], height[lane] - product[lane])
    for lane in range(LANES):
        lanes[lane] = max(np.float32(0.0), lanes[lane] + half)
    # floats of 0 and above are ordered like their bits, whose minimum is found faster
    bits = lanes.view(np.int32)
    least = bits[0]
    for lane in range(LANES):
        least = min(least, bits[lane])
    promising = 0
    while bits[promising] != least:
        promising += 1
    return promising
