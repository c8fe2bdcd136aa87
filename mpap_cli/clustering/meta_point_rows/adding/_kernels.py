"""Algorithm 1 compiled: a block of points is added exactly as one point after the other.

Decisions are made in float64 on sums of fixed order, so that results do not depend on the
processor; float32 only rules out rows that cannot be the nearest.
"""

import math

import numpy as np

from mpap_cli.clustering.meta_point_rows import tables
from mpap_cli.clustering.meta_point_rows._kernels import (
    create_row,
    drop_expired,
    drop_oldest,
    enlist,
    locate,
    nearest,
    strike,
    take_in,
    update_meta_point,
)
from mpap_cli.clustering.meta_point_rows.adding.blocks import Block, Products
from mpap_cli.clustering.meta_point_rows.distances._kernels import (
    compiled,
    dot,
    least_of_lanes,
    squared_distance,
)
from mpap_cli.clustering.meta_point_rows.tables import (
    CLUSTER_POINT,
    LANES,
    NOISE_POINT,
    Index,
    Rows,
    Rules,
)
from mpap_cli.observations import (
    Float32Array,
    Float64Array,
    Int8Array,
    IntArray,
)

# More than a number changes when it is rounded to float32.
_UP = 2.0**-22


@compiled
def reach(squared: float, slack: float) -> np.float32:
    """Largest lower bound that half of a squared distance can have."""
    return np.float32((0.5 * squared + slack) * (1.0 + _UP))


@compiled
def nearest_by_products(
    heights: Float32Array, products: Float32Array, members: IntArray, n: int, kinds: Int8Array,
    kind: int, references: Float64Array, point: Float32Array, bound: float, half: np.float32,
    slack: float, lanes: Float32Array,
) -> int:  # fmt: skip
    """NEAREST-NEIGHBOR of Algorithm 1 among n columns: the row within theta, or -1.

    Height minus product is half of the squared distance, less half of the squared length of
    the point, where the row was when the product was taken. The height is lower by what the
    row may have come nearer since. Of equals the oldest is taken.
    """
    if n == 0:
        return -1
    promising = least_of_lanes(heights, products, n, half, lanes)
    best, best_row = bound, -1
    limit = reach(best, slack)
    for turn in range(-1, LANES):
        lane = promising if turn < 0 else turn
        if lanes[lane] > limit:
            if turn < 0:
                return -1
            continue
        if turn == promising:
            continue
        for column in range(lane, n, LANES):
            if (heights[column] - products[column]) + half <= limit:
                row = members[column]
                if kinds[row] != kind:  # it was taken off its list since
                    continue
                squared = squared_distance(point, references, row)
                if squared < best or (squared == best and row < best_row):
                    best, best_row = squared, row
                    limit = reach(best, slack)
    return best_row


@compiled
def start_columns(
    totals: IntArray, members: IntArray, halves: Float64Array, products: Products
) -> None:
    """Make a column of each row of both kinds, in the order of the lists."""
    for kind in range(2):
        n = totals[kind]
        products.n_columns[kind] = n
        products.heights[kind, n:] = np.inf
        for column in range(n):
            row = members[kind, column]
            products.members[kind, column] = row
            products.columns[row] = column
            products.drifts[kind, column] = 0.0
            half = halves[kind, column]
            products.bases[kind, column] = half
            products.heights[kind, column] = np.float32(half - _UP * half)


@compiled
def find_far(products: Products, bound: float) -> tuple[int, int]:
    """Give the points that no column of a cluster-point is near a number, -1 the others.

    Return up to which point there is room for their products, and how many they are.
    """
    lanes = np.empty(LANES, np.float32)
    height, values, places = products.heights[CLUSTER_POINT], products.of_clusters, products.places
    n, limit, n_far = products.n_columns[CLUSTER_POINT], reach(bound, products.slack), 0
    for i in range(len(places)):
        half = np.float32(products.halves[i])
        promising = least_of_lanes(height, values[i], n, half, lanes)
        if lanes[promising] <= limit:
            places[i] = -1
        elif n_far == len(products.of_noise):
            return i, n_far
        else:
            places[i] = n_far
            n_far += 1
    return len(places), n_far


@compiled
def sink(
    heights: Float32Array, bases: Float64Array, drifts: Float64Array, kind: int, column: int,
    moved: float, theta: float,
) -> None:  # fmt: skip
    """Lower a column by what its row, which has moved, may have come nearer to a point.

    What is within b of it now, b at most theta, was within b + drift: triangle inequality.
    """
    drifts[kind, column] += moved
    drift = drifts[kind, column]
    height = bases[kind, column] - drift * (theta + 0.5 * drift)
    heights[kind, column] = np.float32(height - _UP * abs(height))


@compiled
def append_column(
    products: Products, kind: int, row: int, values: Float32Array, points: Float32Array,
    first: int, copy: Float32Array, half: float,
) -> None:  # fmt: skip
    """Take the products of the points from the first on with a row that is new on its list."""
    column = products.n_columns[kind]
    products.n_columns[kind] += 1
    products.members[kind, column] = row
    products.columns[row] = column
    products.drifts[kind, column] = 0.0
    products.bases[kind, column] = half
    products.heights[kind, column] = np.float32(half - _UP * half)
    for i in range(first, len(points)):
        values[i, column] = dot(points[i], copy)


@compiled
def add_block(
    rows: Rows, index: Index, rules: Rules, products: Products, block: Block, far: Float32Array,
) -> None:  # fmt: skip
    """ADD-DATA-POINT of Algorithm 1 for each point in turn."""
    points, stamps_ns, ids, cases = block.points, block.stamps_ns, block.ids, block.cases
    lower, zero = np.empty(len(index.slot), np.float32), np.zeros(points.shape[1])
    lanes, theta = np.empty(LANES, np.float32), math.sqrt(rules.bound)
    totals, slots, near, members = rows.totals, index.slot, index.near, index.members
    axes, point_count, sums, references = index.axes, rows.point_count, rows.sums, rows.references
    copies, kinds, places = index.copies, rows.kind, products.places
    of_clusters, of_noise, columns = products.of_clusters, products.of_noise, products.columns
    heights, listed, n_columns = products.heights, products.members, products.n_columns
    bases, drifts = products.bases, products.drifts
    point_halves, slack, halves = products.halves, products.slack, index.halves
    last_ns, row_ids, has_plain_means = rows.last_ns, rows.ids, rules.by_mean and not rules.closest
    height, cluster_points = heights[CLUSTER_POINT], listed[CLUSTER_POINT]
    by_products, n_passed = copies.shape[2] > 0, 0
    for i in range(len(points)):
        point, now, case = points[i], stamps_ns[i], 1
        if by_products:
            n_passed += places[i] >= 0
        if rules.ttl_ns >= 0 and now - totals[tables.OLDEST_NS] > rules.ttl_ns:
            drop_expired(rows, index, now, rules.ttl_ns)
        if by_products:
            row = nearest_by_products(
                height, of_clusters[i], cluster_points, n_columns[CLUSTER_POINT], kinds,
                CLUSTER_POINT, references, point, rules.bound, np.float32(point_halves[i]), slack,
                lanes,
            )  # fmt: skip
        else:
            n = totals[CLUSTER_POINT]
            row = nearest(near, members, CLUSTER_POINT, n, axes, references, point, rules, lower)
        if row >= 0 and has_plain_means:  # most points: what follows in short
            take_in(point_count, sums, references, row, point, zero, rules.normalized)
            moved = locate(near, copies, halves, CLUSTER_POINT, slots[row], axes, references, row)
            if by_products:
                sink(heights, bases, drifts, CLUSTER_POINT, columns[row], moved, theta)
            last_ns[row], ids[i], cases[i] = now, row_ids[row], case
            continue
        n_known = totals[tables.N_ROWS]
        if row < 0:  # lines 4-5
            case = 2
            if by_products and places[i] >= 0:
                row = nearest_by_products(
                    heights[NOISE_POINT], of_noise[places[i]], listed[NOISE_POINT],
                    n_columns[NOISE_POINT], kinds, NOISE_POINT, references, point, rules.bound,
                    np.float32(point_halves[i]), slack, lanes,
                )  # fmt: skip
            else:
                n = totals[NOISE_POINT]
                row = nearest(near, members, NOISE_POINT, n, axes, references, point, rules, lower)
        if row < 0:  # lines 11-13
            case, row = 3, create_row(rows, now)
            enlist(rows, index, NOISE_POINT, row)
        update_meta_point(rows, row, point, (now, block.log_index), rules, zero)
        moved = locate(near, copies, halves, kinds[row], slots[row], axes, references, row)
        if row < n_known and by_products:
            sink(heights, bases, drifts, kinds[row], columns[row], moved, theta)
        if case > 1:
            totals[tables.OLDEST_NS] = min(totals[tables.OLDEST_NS], now)
            is_promoted = point_count[row] >= rules.min_points
            if is_promoted:  # lines 8-10
                strike(rows, index, row)
                enlist(rows, index, CLUSTER_POINT, row)
            if by_products and (is_promoted or row == n_known):
                kind, slot = kinds[row], slots[row]
                copy, half = copies[kind, slot], halves[kind, slot]
                if kind == CLUSTER_POINT:
                    append_column(products, kind, row, of_clusters, points, i + 1, copy, half)
                else:
                    append_column(products, kind, row, of_noise, far, n_passed, copy, half)
        ids[i], cases[i] = row_ids[row], case
        while totals[NOISE_POINT] > rules.max_noise:
            drop_oldest(rows, index)
