"""float32 products of points and references, which rule out most rows of a search."""

import numpy as np

from mpap_cli.clustering.meta_point_rows.adding.blocks import Block, Products, part_of
from mpap_cli.clustering.meta_point_rows.tables import (
    CLUSTER_POINT,
    LANES,
    NOISE_POINT,
    Index,
    Rows,
    Rules,
)

# More than float32 rounds by, for each coordinate and a few steps around the sum.
_ROUNDING = 6.1e-8
_STEPS_AROUND = 14
# Below these products cost more than they save, or rounding hides what is near.
_FEWEST_DIMS = 24
_FEWEST_ROWS = 768
_LARGEST_SLACK = 1 / 16
_LENGTHS = 1e-3, 1e6
_MOST_POINTS, _FEWEST_POINTS = 1024, 64
_FAR_POINTS = 64
_ELEMENTS = 1 << 19


def product_slack(length: float, n_dims: int) -> float:
    """Return by how much float32 misplaces half of the squared distance of two vectors.

    Products summed in any order, references and lengths rounded to float32.
    """
    return _ROUNDING * (n_dims + _STEPS_AROUND) * length * length


def are_worth_it(rules: Rules, n_rows: int, n_dims: int) -> bool:
    """Whether products tell more than a few coordinates do, for so many rows and dimensions."""
    least, most = _LENGTHS
    fits = n_rows >= _FEWEST_ROWS and n_dims >= _FEWEST_DIMS and least <= rules.length <= most
    return fits and product_slack(rules.length, n_dims) <= _LARGEST_SLACK * rules.bound


class ProductFilter:
    """Adds points in blocks; keeps the memory of products from one block to the next."""

    def __init__(self) -> None:
        self._memory = np.zeros((2, 0), np.float32)
        self._far_share = 1.0

    def add(self, rows: Rows, index: Index, rules: Rules, block: Block) -> None:
        """Run Algorithm 1 for points in turn.

        Products with all cluster-points are taken at once; then those with the noise-points,
        of the points that are far from every cluster-point. An index without copies wants none.
        """
        from mpap_cli.clustering.meta_point_rows.adding import _kernels  # noqa: PLC0415  # slow: numba

        if not index.copies.shape[2]:
            nothing = self._products(rows, part_of(block, 0, 0), rules)
            _kernels.add_block(rows, index, rules, nothing, block, block.points[:0])
            return
        start, n = 0, len(block.points)
        while start < n:
            rest = part_of(block, start, start + _MOST_POINTS)
            start += self._add_some(rows, index, rules, rest)

    def _add_some(self, rows: Rows, index: Index, rules: Rules, block: Block) -> int:
        """Add as many points as suit, from the first on; return how many."""
        from mpap_cli.clustering.meta_point_rows.adding import _kernels  # noqa: PLC0415  # slow: numba

        n_noise, n_clusters = rows.totals[: CLUSTER_POINT + 1].tolist()
        block = part_of(block, 0, self._suitable(n_clusters, len(block.points)))
        products = self._products(rows, block, rules)
        _kernels.start_columns(rows.totals, index.members, index.halves, products)
        known = index.copies[CLUSTER_POINT, :n_clusters]
        np.matmul(block.points, known.T, out=products.of_clusters[:, :n_clusters])
        m, n_far = len(block.points), 0
        products.places[:] = -1
        if n_noise or n_clusters < _FEWEST_POINTS:
            m, n_far = _kernels.find_far(products, rules.bound)
        self._far_share = n_far / m
        far = block.points[:m][products.places[:m] >= 0]
        known = index.copies[NOISE_POINT, :n_noise]
        np.matmul(far, known.T, out=products.of_noise[:n_far, :n_noise])
        _kernels.add_block(rows, index, rules, products, part_of(block, 0, m), far)
        return m

    def _suitable(self, n_clusters: int, most: int) -> int:
        """Return how many points to take: few where many make rows, or products are long."""
        wanted = min(int(_FAR_POINTS / (self._far_share + 1e-9)), _ELEMENTS // _width(n_clusters))
        return min(most, max(_FEWEST_POINTS, wanted))

    def _products(self, rows: Rows, block: Block, rules: Rules) -> Products:
        """Return tables without a column, with room for one more a point."""
        m = len(block.points)
        width, wide = (_width(int(rows.totals[kind]) + m) for kind in (CLUSTER_POINT, NOISE_POINT))
        n_far = min(m, max(_FEWEST_POINTS, _ELEMENTS // wide))
        size = max(m * width, n_far * wide)
        if size > self._memory.shape[1]:
            self._memory = np.zeros((2, max(size, _ELEMENTS)), np.float32)
        most = max(width, wide)
        return Products(
            halves=block.halves,
            places=np.empty(m, np.int64),
            of_noise=self._memory[0, : n_far * wide].reshape(n_far, wide),
            of_clusters=self._memory[1, : m * width].reshape(m, width),
            heights=np.empty((2, most), np.float32),
            bases=np.empty((2, most)),
            drifts=np.empty((2, most)),
            members=np.empty((2, most), np.int64),
            columns=np.empty(len(rows.kind), np.int64),
            n_columns=np.empty(2, np.int64),
            slack=product_slack(rules.length, block.points.shape[1]),
        )


def _width(n: int) -> int:
    """Return room for so many columns: whole lanes, and rows not a power of two apart."""
    return -(-n // LANES) * LANES + 16
