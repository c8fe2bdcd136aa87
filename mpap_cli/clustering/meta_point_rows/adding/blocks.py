"""Points that are added together, and the products that rule out most rows for them."""

from typing import NamedTuple

from mpap_cli.observations import Float32Array, Float64Array, Int8Array, IntArray


class Products(NamedTuple):
    """Products of m points with the rows of both kinds, a column a row.

    ``of_clusters`` (m, width) has all points; ``of_noise`` only those that are far from every
    cluster-point, the i-th of them at ``places[i]``, -1 for others. Of each column
    ``heights`` (2, width) is half of the squared length of the reference, ``bases``, less what
    the row may have come nearer by ``drifts`` since; behind the last it is inf. ``members``
    is the row of a column, ``columns`` the column of a row. ``halves`` (m,) are half of the
    squared lengths of the points. ``slack`` is the most by which half of a squared distance
    is misplaced.
    """

    halves: Float64Array
    places: IntArray
    of_noise: Float32Array
    of_clusters: Float32Array
    heights: Float32Array
    bases: Float64Array
    drifts: Float64Array
    members: IntArray
    columns: IntArray
    n_columns: IntArray
    slack: float


class Block(NamedTuple):
    """Points that come one after the other, half of their squared lengths, and what they get."""

    points: Float32Array
    halves: Float64Array
    stamps_ns: IntArray
    ids: IntArray
    cases: Int8Array
    log_index: int


def part_of(block: Block, start: int, stop: int) -> Block:
    """Return a view of some of the points."""
    rows = slice(start, stop)
    return Block(
        block.points[rows],
        block.halves[rows],
        block.stamps_ns[rows],
        block.ids[rows],
        block.cases[rows],
        block.log_index,
    )
