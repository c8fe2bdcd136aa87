"""Algorithm 1 compiled: a block of points is added exactly as one point after the other.

Decisions are made in float64 on sums of fixed order, so that results do not depend on the
processor; float32 only rules out rows that cannot be the nearest.
"""

import math

import numpy as np
from numba import njit

from mpap_cli.clustering.meta_point_rows import tables
from mpap_cli.clustering.meta_point_rows.tables import (
    CLUSTER_POINT,
    NOISE_POINT,
    Index,
    Rows,
    Rules,
)
from mpap_cli.observations import Float32Array, Float64Array, FloatArray, Int8Array, IntArray

_compiled = njit(nogil=True, cache=True, error_model="numpy")
# What runs for every point takes plain arrays: whoever takes a table counts the references
# of all its arrays up and down, which costs more than the work itself.


@_compiled
def _squared_distance(u: FloatArray, rows: FloatArray, row: int, bound: float) -> float:
    """Sum of squared differences in four strands; inf as soon as it is above bound."""
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


@_compiled
def _reach(squared: float, slack: float) -> float:
    """Largest float32 lower bound that a squared distance can have."""
    room = math.sqrt(squared) * (1.0 + 1e-5) + slack
    return room * room + 1e-37


@_compiled
def _lower_bounds(
    near: Float32Array, kind: int, axes: IntArray, point: FloatArray, lower: Float32Array, n: int
) -> int:
    """Sum the squared differences along the axes; return the place of the least sum."""
    for slot in range(n):
        lower[slot] = 0.0
    for q in range(0, len(axes), 4):
        x0, x1 = np.float32(point[axes[q]]), np.float32(point[axes[q + 1]])
        x2, x3 = np.float32(point[axes[q + 2]]), np.float32(point[axes[q + 3]])
        for slot in range(n):
            step0, step1 = near[kind, q, slot] - x0, near[kind, q + 1, slot] - x1
            step2, step3 = near[kind, q + 2, slot] - x2, near[kind, q + 3, slot] - x3
            lower[slot] += (step0 * step0 + step1 * step1) + (step2 * step2 + step3 * step3)
    # floats of 0 and above are ordered like their bits, whose minimum is found faster
    bits = lower.view(np.int32)
    least = bits[0]
    for slot in range(n):
        least = min(least, bits[slot])
    slot = 0
    while bits[slot] != least:
        slot += 1
    return slot


@_compiled
def nearest(
    near: Float32Array, members: IntArray, kind: int, n: int, axes: IntArray,
    references: Float64Array, point: FloatArray, rules: Rules, lower: Float32Array,
) -> int:  # fmt: skip
    """NEAREST-NEIGHBOR of Algorithm 1 among the n rows of a kind: the row within theta, or -1.

    A float32 sum over a part of the coordinates is a lower bound of the distance. A row
    whose bound, with room for rounding, is above the best distance so far cannot win. Of
    equals the oldest is taken.
    """
    if n == 0:
        return -1
    promising = _lower_bounds(near, kind, axes, point, lower, n)
    best, best_row = rules.bound, -1
    limit = _reach(best, rules.slack)
    for turn in range(-1, n):
        slot = promising if turn < 0 else turn
        if lower[slot] <= limit:
            row = members[kind, slot]
            squared = _squared_distance(point, references, row, best)
            if squared < best or (squared == best and row < best_row):
                best, best_row = squared, row
                limit = _reach(best, rules.slack)
    return best_row


@_compiled
def enlist(rows: Rows, index: Index, kind: int, row: int) -> None:
    """Put a row at the end of the cluster-points or of the noise-points."""
    slot = rows.totals[kind]
    rows.totals[kind] += 1
    rows.kind[row], index.slot[row] = kind, slot
    index.members[kind, slot] = row
    locate(index.near, kind, slot, index.axes, rows.references, row)


@_compiled
def _strike(rows: Rows, index: Index, row: int) -> None:
    """Take a row off its list; the last of the list takes its slot."""
    kind, slot = rows.kind[row], index.slot[row]
    rows.totals[kind] -= 1
    last = rows.totals[kind]
    index.slot[index.members[kind, last]] = slot
    index.members[kind, slot] = index.members[kind, last]
    index.near[kind, :, slot] = index.near[kind, :, last]
    rows.kind[row] = tables.DROPPED


@_compiled
def locate(
    near: Float32Array, kind: int, slot: int, axes: IntArray, references: Float64Array, row: int
) -> None:
    """Renew the coordinates by which a row is searched."""
    for q in range(len(axes)):
        near[kind, q, slot] = references[row, axes[q]]


@_compiled
def _take_in(
    point_count: IntArray, sums: Float64Array, means: Float64Array, row: int, point: FloatArray,
    zero: Float64Array, normalised: bool,
) -> None:  # fmt: skip
    """Add a point to the sum of a row, and renew its mean."""
    point_count[row] += 1
    for j in range(len(point)):
        sums[row, j] += point[j]
    divisor = math.sqrt(_squared_distance(zero, sums, row, math.inf))
    if not normalised or divisor == 0.0:
        divisor = np.float64(point_count[row])
    for j in range(len(point)):
        means[row, j] = sums[row, j] / divisor


@_compiled
def create_row(rows: Rows, stamp_ns: int) -> int:
    """Return a new row, which is on no list and stands for no point yet."""
    row: int = rows.totals[tables.N_ROWS]
    rows.totals[tables.N_ROWS] += 1
    rows.ids[row] = rows.totals[tables.NEXT_ID]
    rows.totals[tables.NEXT_ID] += 1
    rows.first_ns[row] = stamp_ns
    return row


@_compiled
def _update_meta_point(
    rows: Rows, row: int, point: FloatArray, seen: tuple[int, int], rules: Rules, zero: Float64Array
) -> None:
    """UPDATE-META-POINT of Algorithm 1 with a point seen at (stamp, log)."""
    rows.last_ns[row] = seen[0]
    means = rows.references  # until they become the exemplar
    _take_in(rows.point_count, rows.sums, means, row, point, zero, rules.normalised)
    replaced = rows.point_count[row] == 1
    if rules.closest and not replaced:
        kept = _squared_distance(rows.exemplars[row], means, row, math.inf)
        replaced = _squared_distance(point, means, row, math.inf) < kept
    if replaced:
        rows.exemplars[row] = point
        rows.exemplar_stamp_ns[row], rows.exemplar_log[row] = seen
    if not rules.by_mean:
        rows.references[row] = rows.exemplars[row]


@_compiled
def _drop_expired(rows: Rows, index: Index, stamp_ns: int, ttl_ns: int) -> None:
    """Drop the noise-points last seen before their time to live; note the oldest left."""
    oldest = tables.UNSEEN_NS
    for slot in range(rows.totals[NOISE_POINT] - 1, -1, -1):
        row = index.members[NOISE_POINT, slot]
        if stamp_ns - rows.last_ns[row] > ttl_ns:
            _strike(rows, index, row)
            rows.totals[tables.N_DROPPED] += 1
        else:
            oldest = min(oldest, rows.last_ns[row])
    rows.totals[tables.OLDEST_NS] = oldest


@_compiled
def drop_oldest(rows: Rows, index: Index) -> None:
    """Drop a noise-point: one that stands for one point if possible, the longest unseen."""
    oldest = index.members[NOISE_POINT, 0]
    for slot in range(1, rows.totals[NOISE_POINT]):
        row = index.members[NOISE_POINT, slot]
        key = (rows.point_count[row] > 1, rows.last_ns[row], row)
        if key < (rows.point_count[oldest] > 1, rows.last_ns[oldest], oldest):
            oldest = row
    _strike(rows, index, oldest)
    rows.totals[tables.N_DROPPED] += 1


@_compiled
def add_block(
    rows: Rows, index: Index, rules: Rules, points: Float32Array, stamps_ns: IntArray,
    log_index: int, ids: IntArray, cases: Int8Array,
) -> None:  # fmt: skip
    """ADD-DATA-POINT of Algorithm 1 for each point in turn."""
    lower, zero = np.empty(len(index.slot), np.float32), np.zeros(points.shape[1])
    totals, slots, near, members = rows.totals, index.slot, index.near, index.members
    axes, point_count, sums, references = index.axes, rows.point_count, rows.sums, rows.references
    last_ns, row_ids, has_plain_means = rows.last_ns, rows.ids, rules.by_mean and not rules.closest
    for i in range(len(points)):
        point, now, case = points[i], stamps_ns[i], 1
        if rules.ttl_ns >= 0 and now - totals[tables.OLDEST_NS] > rules.ttl_ns:
            _drop_expired(rows, index, now, rules.ttl_ns)
        n = totals[CLUSTER_POINT]
        row = nearest(near, members, CLUSTER_POINT, n, axes, references, point, rules, lower)
        if row >= 0 and has_plain_means:  # most points: what follows in short
            _take_in(point_count, sums, references, row, point, zero, rules.normalised)
            locate(near, CLUSTER_POINT, slots[row], axes, references, row)
            last_ns[row], ids[i], cases[i] = now, row_ids[row], case
            continue
        if row < 0:  # lines 4-5
            case, n = 2, totals[NOISE_POINT]
            row = nearest(near, members, NOISE_POINT, n, axes, references, point, rules, lower)
        if row < 0:  # lines 11-13
            case, row = 3, create_row(rows, now)
            enlist(rows, index, NOISE_POINT, row)
        _update_meta_point(rows, row, point, (now, log_index), rules, zero)
        locate(near, rows.kind[row], slots[row], axes, references, row)
        if case > 1:
            totals[tables.OLDEST_NS] = min(totals[tables.OLDEST_NS], now)
            if point_count[row] >= rules.min_points:  # lines 8-10
                _strike(rows, index, row)
                enlist(rows, index, CLUSTER_POINT, row)
        ids[i], cases[i] = row_ids[row], case
        while totals[NOISE_POINT] > rules.max_noise:
            drop_oldest(rows, index)
