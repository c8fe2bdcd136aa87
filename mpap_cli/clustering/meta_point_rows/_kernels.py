"""Steps of Algorithm 1 compiled: search for the nearest, update of tables and index.

Decisions are made in float64 on sums of fixed order, so that results do not depend on the
processor; float32 only rules out rows that cannot be the nearest.
"""

import math

import numpy as np

from mpap_cli.clustering.meta_point_rows import tables
from mpap_cli.clustering.meta_point_rows.distances._kernels import (
    bounded_distance,
    compiled,
    half_square,
    moved_squared,
    squared_distance,
)
from mpap_cli.clustering.meta_point_rows.tables import (
    NOISE_POINT,
    Index,
    Rows,
    Rules,
)
from mpap_cli.observations import Float32Array, Float64Array, FloatArray, IntArray

# What runs for every point takes plain arrays: whoever takes a table counts the references
# of all its arrays up and down, which costs more than the work itself.


@compiled
def _reach(squared: float, slack: float) -> float:
    """Largest float32 lower bound that a squared distance can have."""
    room = math.sqrt(squared) * (1.0 + 1e-5) + slack
    return room * room + 1e-37


@compiled
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


@compiled
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
            squared = bounded_distance(point, references, row, best)
            if squared < best or (squared == best and row < best_row):
                best, best_row = squared, row
                limit = _reach(best, rules.slack)
    return best_row


@compiled
def enlist(rows: Rows, index: Index, kind: int, row: int) -> None:
    """Put a row at the end of the cluster-points or of the noise-points."""
    slot = rows.totals[kind]
    rows.totals[kind] += 1
    rows.kind[row], index.slot[row] = kind, slot
    index.members[kind, slot] = row
    locate(index.near, index.copies, index.halves, kind, slot, index.axes, rows.references, row)


@compiled
def strike(rows: Rows, index: Index, row: int) -> None:
    """Take a row off its list; the last of the list takes its slot."""
    kind, slot = rows.kind[row], index.slot[row]
    rows.totals[kind] -= 1
    last = rows.totals[kind]
    index.slot[index.members[kind, last]] = slot
    index.members[kind, slot] = index.members[kind, last]
    index.near[kind, :, slot] = index.near[kind, :, last]
    index.copies[kind, slot] = index.copies[kind, last]
    index.halves[kind, slot] = index.halves[kind, last]
    rows.kind[row] = tables.DROPPED


@compiled
def locate(
    near: Float32Array, copies: Float32Array, halves: Float64Array, kind: int, slot: int,
    axes: IntArray, references: Float64Array, row: int,
) -> float:  # fmt: skip
    """Renew the coordinates by which a row is searched; return how far the copy moved."""
    n = copies.shape[2]
    if n == 0 or kind == NOISE_POINT:
        for q in range(len(axes)):
            near[kind, q, slot] = references[row, axes[q]]
    copy, reference = copies[kind, slot], references[row]
    moved = moved_squared(copy, reference)
    for j in range(n):
        copy[j] = reference[j]
    halves[kind, slot] = half_square(copy)
    return math.sqrt(moved)


@compiled
def take_in(
    point_count: IntArray, sums: Float64Array, means: Float64Array, row: int, point: FloatArray,
    zero: Float64Array, normalized: bool,
) -> None:  # fmt: skip
    """Add a point to the sum of a row, and renew its mean."""
    point_count[row] += 1
    for j in range(len(point)):
        sums[row, j] += point[j]
    divisor = math.sqrt(squared_distance(zero, sums, row))
    if not normalized or divisor == 0.0:
        divisor = np.float64(point_count[row])
    for j in range(len(point)):
        means[row, j] = sums[row, j] / divisor


@compiled
def create_row(rows: Rows, stamp_ns: int) -> int:
    """Return a new row, which is on no list and stands for no point yet."""
    row: int = rows.totals[tables.N_ROWS]
    rows.totals[tables.N_ROWS] += 1
    rows.ids[row] = rows.totals[tables.NEXT_ID]
    rows.totals[tables.NEXT_ID] += 1
    rows.first_ns[row] = stamp_ns
    return row


@compiled
def update_meta_point(
    rows: Rows, row: int, point: FloatArray, seen: tuple[int, int], rules: Rules, zero: Float64Array
) -> None:
    """UPDATE-META-POINT of Algorithm 1 with a point seen at (stamp, log)."""
    rows.last_ns[row] = seen[0]
    means = rows.references  # until they become the exemplar
    take_in(rows.point_count, rows.sums, means, row, point, zero, rules.normalized)
    replaced = rows.point_count[row] == 1
    if rules.closest and not replaced:
        kept = squared_distance(rows.exemplars[row], means, row)
        replaced = squared_distance(point, means, row) < kept
    if replaced:
        rows.exemplars[row] = point
        rows.exemplar_stamp_ns[row], rows.exemplar_log[row] = seen
    if not rules.by_mean:
        rows.references[row] = rows.exemplars[row]


@compiled
def drop_expired(rows: Rows, index: Index, stamp_ns: int, ttl_ns: int) -> None:
    """Drop the noise-points last seen before their time to live; note the oldest left."""
    oldest = tables.UNSEEN_NS
    for slot in range(rows.totals[NOISE_POINT] - 1, -1, -1):
        row = index.members[NOISE_POINT, slot]
        if stamp_ns - rows.last_ns[row] > ttl_ns:
            strike(rows, index, row)
            rows.totals[tables.N_DROPPED] += 1
        else:
            oldest = min(oldest, rows.last_ns[row])
    rows.totals[tables.OLDEST_NS] = oldest


@compiled
def drop_oldest(rows: Rows, index: Index) -> None:
    """Drop a noise-point: one that stands for one point if possible, the longest unseen."""
    oldest = index.members[NOISE_POINT, 0]
    for slot in range(1, rows.totals[NOISE_POINT]):
        row = index.members[NOISE_POINT, slot]
        key = (rows.point_count[row] > 1, rows.last_ns[row], row)
        if key < (rows.point_count[oldest] > 1, rows.last_ns[oldest], oldest):
            oldest = row
    strike(rows, index, oldest)
    rows.totals[tables.N_DROPPED] += 1
