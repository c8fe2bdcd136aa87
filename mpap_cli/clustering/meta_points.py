"""Meta-point affinity propagation (section 3.4 of the paper, Algorithm 1)."""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.affinity_propagation import affinity_propagation, weighted_similarities
from mpap_cli.clustering.meta_point_rows.adding.blocks import Block, part_of
from mpap_cli.clustering.meta_point_rows.adding.products import ProductFilter, are_worth_it
from mpap_cli.clustering.meta_point_rows.arrays import MetaPointArrays
from mpap_cli.clustering.meta_point_rows.state import pack, unpack
from mpap_cli.clustering.meta_point_rows.tables import (
    N_ROWS,
    Rows,
    build_index,
    empty_rows,
    kept_rows,
    longest,
    resized,
    rules_of,
    widest_axes,
)
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.distance import similarities
from mpap_cli.observations import (
    Clustering,
    Float32Array,
    Float64Array,
    Int8Array,
    IntArray,
)
from mpap_cli.params import AffinityParams, MetaPointParams

_BLOCK = 1024
# From so many meta-points on, they tell better than a block where points differ.
_ENOUGH_ROWS = 16


class MetaPoints(MetaPointArrays):
    """Cluster-points and noise-points, built in one pass over a stream of points.

    Each point joins the nearest cluster-point within theta, else the nearest noise-point
    within theta, else it becomes a noise-point; a noise-point that stands for
    ``min_points`` points becomes a cluster-point and stays one. Affinity propagation then
    clusters the exemplars of the cluster-points.

    Arrays are copies with one row a meta-point, in the order in which they were made;
    ids ascend and are never used twice.

    Parameters
    ----------
    params : MetaPointParams
        ``theta`` is a distance (the paper calls it theta_similarity).
    n_dims : int
        Coordinates of a point.
    normalized : bool
        Whether points are embedded histograms (equation 7, means of length 1), or any
        points at Euclidean distances.

    Notes
    -----
    The paper does not say what DIST refers to: it is the mean, or the exemplar if
    ``params.reference`` says so. Of the noise-points at most ``max_noise`` are kept;
    those that stand for a single point go first, the longest unseen before others.

    Examples
    --------
    >>> points = MetaPoints(MetaPointParams(theta=1.0), n_dims=1, normalized=False)
    >>> x = np.array([[0.0], [0.5], [9.0]], np.float32)
    >>> ids, cases = points.add_data_points(x, np.arange(3))
    >>> ids.tolist(), cases.tolist(), points.is_cluster_point.tolist()
    ([0, 0, 1], [3, 2, 3], [True, False])
    """

    def __init__(self, params: MetaPointParams, n_dims: int, *, normalized: bool = True) -> None:
        self.params = params
        self.n_dims = n_dims
        self.normalized = normalized
        self._set_rows(empty_rows(0, n_dims))
        self._filter = ProductFilter()

    def _set_rows(self, rows: Rows) -> None:
        """Take over tables of meta-points; the index is made when it is needed."""
        self._rows = rows
        self._index = build_index(rows, np.zeros(0, np.int64))
        self._n_indexed = 0
        self._length = longest(rows.references)

    def add_data_points(
        self, features: Float32Array, stamps_ns: IntArray, log_index: int = 0
    ) -> tuple[IntArray, Int8Array]:
        """Add points one after the other (Algorithm 1).

        Parameters
        ----------
        features : ndarray of shape (m, d)
            Finite; float32, else converted.
        stamps_ns : ndarray of shape (m,)
            Nanoseconds.
        log_index : int
            Which log they come from; kept with the exemplars.

        Returns
        -------
        tuple of ndarray of shape (m,)
            Id of the meta-point each point joined, and the case of Algorithm 1: 1 (of a
            cluster-point), 2 (of a noise-point, be it a cluster-point now), 3 (made).

        Raises
        ------
        ValueError
            If the shapes do not fit or a coordinate is not finite.
        """
        points = np.array(features, np.float32, order="C")
        stamps = np.array(stamps_ns, np.int64)
        m = len(points)
        if points.shape != (m, self.n_dims) or stamps.shape != (m,):
            msg = f"features {points.shape} at {stamps.shape} stamps, expected (m, {self.n_dims})"
            raise ValueError(msg)
        out = np.empty(m, np.int64), np.empty(m, np.int8)
        if m:
            block = Block(points, self._halves(points), stamps, out[0], out[1], log_index)
            for start in range(0, m, _BLOCK):
                self._add_block(part_of(block, start, start + _BLOCK))
        return out

    def _halves(self, points: Float32Array) -> Float64Array:
        """Return half of the squared length of each point; note the longest one."""
        from mpap_cli.clustering.meta_point_rows.distances import _kernels  # noqa: PLC0415  # slow: numba

        halves = np.empty(len(points))
        _kernels.half_squares(points, halves)
        largest = halves.max()
        if not np.isfinite(largest):
            msg = "features: found a coordinate that is not finite"
            raise ValueError(msg)
        self._length = max(self._length, float(np.sqrt(2.0 * largest)))
        return halves

    def _add_block(self, block: Block) -> None:
        """Make room, renew the index if it has become stale, and run the kernel."""
        points = block.points
        kept = kept_rows(self._rows)
        full = self._rows.totals[N_ROWS] + len(points) > len(self._rows.kind)
        if full:
            self._rows = resized(self._rows, len(points))
            kept = kept_rows(self._rows)
        rules = rules_of(self.params, normalized=self.normalized, length=self._length)
        products = are_worth_it(rules, len(kept), self.n_dims)
        unfit = bool(self._index.copies.shape[2]) and not products
        if full or unfit or len(kept) >= 2 * self._n_indexed:
            spread = self._rows.references[kept] if len(kept) >= _ENOUGH_ROWS else points
            self._index = build_index(self._rows, widest_axes(spread), with_copies=products)
            self._n_indexed = len(kept)
        self._filter.add(self._rows, self._index, rules, block)

    def cluster(self, params: AffinityParams) -> Clustering:
        """Cluster the exemplars of the cluster-points by affinity propagation.

        Returns
        -------
        Clustering
            Its items are the cluster-points, in the order of their rows.
        """
        members = self.is_cluster_point
        s = similarities(self.exemplars[members], params.similarity, normalized=self.normalized)
        preference = resolve_preference(s, params.preference)
        if params.weights == "count":
            s, diagonal = weighted_similarities(s, self.count[members], preference)
            return affinity_propagation(s, diagonal, params)
        return affinity_propagation(s, preference, params)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return everything that was learnt as plain arrays, for a model file."""
        return pack(self._rows, normalized=self.normalized)

    @classmethod
    def from_state(cls, params: MetaPointParams, state: Mapping[str, NDArray[Any]]) -> Self:
        """Go on from the state of other meta-points.

        Raises
        ------
        ModelError
            If an array is missing or its shape, type or values cannot be.
        """
        rows, normalized = unpack(state, by_mean=params.reference == "mean")
        points = cls(params, rows.sums.shape[1], normalized=normalized)
        points._set_rows(rows)
        return points
