"""Tables of meta-points: one row each, in the order in which they were made.

A row keeps its place until the tables are resized; a dropped row only loses its kind.
"""

from typing import NamedTuple

import numpy as np

from mpap_cli.observations import (
    NS_PER_S,
    Float32Array,
    Float64Array,
    FloatArray,
    Int8Array,
    IntArray,
)
from mpap_cli.params import MetaPointParams

NOISE_POINT, CLUSTER_POINT, DROPPED = 0, 1, 2
# Places in Rows.totals; the first two, the sizes of both sets, are found by kind.
N_ROWS, NEXT_ID, N_DROPPED, OLDEST_NS = 2, 3, 4, 5
UNSEEN_NS = np.iinfo(np.int64).max
N_AXES = 16
# So many columns side by side become vector instructions; half as many would be unrolled.
LANES = 64
_SMALLEST_CAPACITY = 64
_APART = 16  # rows that lie a power of two apart drive one another out of the cache


class Rows(NamedTuple):
    """Everything known of the meta-points; the first axis is the row.

    ``totals`` (6,) holds the numbers of noise-points, cluster-points and rows in use, the
    next id, the number of dropped noise-points and a stamp that no noise-point was last
    seen before. ``references`` is what distances go to, the mean or the exemplar.
    """

    totals: IntArray
    kind: Int8Array
    ids: IntArray
    point_count: IntArray
    first_ns: IntArray
    last_ns: IntArray
    exemplar_stamp_ns: IntArray
    exemplar_log: IntArray
    label_counts: IntArray
    sums: Float64Array
    references: Float64Array
    exemplars: Float32Array


class Index(NamedTuple):
    """What finds a nearest meta-point fast; it can be rebuilt from the rows at any time.

    ``members`` (2, capacity) lists the rows of each kind in no order, ``slot`` (capacity,)
    is the place of a row in its list, ``near`` (2, n_axes, capacity and some to spare) holds
    the coordinates ``axes`` of the references in the order of the lists, one after the other.
    ``copies`` (2, capacity, d) holds the references in that order, for products with them, and
    ``halves`` (2, capacity) half of their squared lengths; without products d is 0.
    """

    slot: IntArray
    members: IntArray
    near: Float32Array
    copies: Float32Array
    halves: Float64Array
    axes: IntArray


class Rules(NamedTuple):
    """Settings of Algorithm 1 as plain numbers.

    ``bound``: theta as a sum of squared differences; ``slack``: the most by which float32
    can misplace a point; ``length``: that of the longest vector; ``ttl_ns``: nanoseconds that
    a noise-point lives, -1 for ever.
    """

    bound: float
    slack: float
    length: float
    min_points: int
    by_mean: bool
    closest: bool
    normalized: bool
    ttl_ns: int
    max_noise: int


def empty_rows(capacity: int, n_dims: int) -> Rows:
    """Return tables without a meta-point."""

    def numbers(*shape: int) -> IntArray:
        return np.zeros((capacity, *shape), np.int64)

    return Rows(
        totals=np.array([0, 0, 0, 0, 0, UNSEEN_NS], np.int64),
        kind=np.full(capacity, DROPPED, np.int8),
        ids=numbers(),
        point_count=numbers(),
        first_ns=numbers(),
        last_ns=numbers(),
        exemplar_stamp_ns=numbers(),
        exemplar_log=numbers(),
        label_counts=numbers(3, 2),
        sums=np.zeros((capacity, n_dims)),
        references=np.zeros((capacity, n_dims)),
        exemplars=np.zeros((capacity, n_dims), np.float32),
    )


def kept_rows(rows: Rows) -> IntArray:
    """Return the rows that are not dropped, oldest first."""
    return np.flatnonzero(rows.kind[: rows.totals[N_ROWS]] != DROPPED)


def resized(rows: Rows, n_more: int) -> Rows:
    """Copy the kept rows into tables with room for more of them, a quarter to spare."""
    kept = kept_rows(rows)
    capacity = _SMALLEST_CAPACITY
    while capacity < (len(kept) + n_more) * 4 // 3:
        capacity *= 2
    larger = empty_rows(capacity, rows.sums.shape[1])
    for name in set(Rows._fields) - {"totals"}:
        getattr(larger, name)[: len(kept)] = getattr(rows, name)[kept]
    larger.totals[:] = rows.totals
    larger.totals[N_ROWS] = len(kept)
    return larger


def recount(rows: Rows) -> None:
    """Find the totals of rows whose kinds were set from outside."""
    kinds = rows.kind[: rows.totals[N_ROWS]]
    for kind in (NOISE_POINT, CLUSTER_POINT):
        rows.totals[kind] = np.count_nonzero(kinds == kind)
    seen = rows.last_ns[np.flatnonzero(kinds == NOISE_POINT)]
    rows.totals[OLDEST_NS] = seen.min(initial=UNSEEN_NS)


def longest(points: FloatArray, at_least: float = 0.0) -> float:
    """Return the length of the longest vector: float32 rounds in proportion to it."""
    lengths = np.sqrt(np.square(points, dtype=np.float64).sum(axis=1))
    return float(lengths.max(initial=at_least))


def rules_of(params: MetaPointParams, *, normalized: bool, length: float) -> Rules:
    """Return the settings as the kernel takes them, for points of at most this length."""
    ttl_s = params.noise_ttl
    length = max(length, 1.0) if normalized else length
    return Rules(
        bound=params.theta * params.theta / (0.5 if normalized else 1.0),
        slack=1e-6 * length,
        length=length,
        min_points=params.min_points,
        by_mean=params.reference == "mean",
        closest=params.exemplar == "closest",
        normalized=normalized,
        ttl_ns=-1 if ttl_s is None else round(ttl_s * NS_PER_S),
        max_noise=params.max_noise,
    )


def means(sums: Float64Array, count: IntArray, *, normalized: bool) -> Float64Array:
    """Return the means of some rows, bit for bit as the kernel finds them."""
    divisors = count.astype(np.float64)
    if normalized:
        # four strands, each from first to last; cumsum keeps that order, sum does not
        squares = sums**2
        n, d = sums.shape
        whole = d - d % 4
        strands = np.zeros((4, n))
        if whole:
            strands = squares[:, :whole].reshape(n, whole // 4, 4).cumsum(axis=1)[:, -1].T.copy()
        for j in range(whole, d):
            strands[0] += squares[:, j]
        lengths = np.sqrt((strands[0] + strands[1]) + (strands[2] + strands[3]))
        divisors = np.where(lengths > 0, lengths, divisors)
    return sums / divisors[:, None]


def widest_axes(points: FloatArray) -> IntArray:
    """Return the coordinates in which points differ most, widest first, four at a time."""
    spread = points.astype(np.float64).var(axis=0)
    n_axes = min(N_AXES, len(spread) // 4 * 4)
    return np.argsort(-spread, kind="stable")[:n_axes]


def build_index(rows: Rows, axes: IntArray, *, with_copies: bool = False) -> Index:
    """Build the index of some rows."""
    capacity, n_dims = rows.references.shape
    index = Index(
        slot=np.zeros(capacity, np.int64),
        members=np.zeros((2, capacity), np.int64),
        near=np.zeros((2, len(axes), capacity + _APART), np.float32),
        copies=np.zeros((2, capacity, n_dims if with_copies else 0), np.float32),
        halves=np.zeros((2, capacity)),
        axes=axes,
    )
    for kind in (NOISE_POINT, CLUSTER_POINT):
        members = np.flatnonzero(rows.kind == kind)
        index.members[kind, : len(members)] = members
        index.slot[members] = np.arange(len(members))
        index.near[kind, :, : len(members)] = rows.references[np.ix_(members, axes)].T
        if with_copies:
            index.copies[kind, : len(members)] = rows.references[members]
            squares = np.square(index.copies[kind, : len(members)], dtype=np.float64)
            index.halves[kind, : len(members)] = 0.5 * squares.sum(axis=1)
    return index
