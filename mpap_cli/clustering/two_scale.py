"""Clusters on two time scales (section 4.2.4 of the paper, Algorithm 2)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.preference import coarse_preference, resolve_preference
from mpap_cli.clustering.strap import Strap
from mpap_cli.clustering.strap_rows.long_clusters import LongClusters
from mpap_cli.clustering.strap_rows.state import LENGTH_TOLERANCE, pack, unpack
from mpap_cli.distance import similarities, squared_distances
from mpap_cli.observations import BoolArray, Clustering, Float32Array, Float64Array, IntArray
from mpap_cli.params import AffinityParams, StrapParams

# What is searched in vain when a rebuild comes in between is at most that.
_BLOCK = 1024


@dataclass(frozen=True, slots=True, eq=False)
class Insertion:
    """What became of m observations.

    ``ids`` (m,) are those of the cluster that took them or of the outlier that they are;
    ``distances`` (m,) go to the nearest long-term exemplar at arrival, inf if there was
    none; ``outlier`` (m,) tells which fitted no cluster.
    """

    ids: IntArray
    distances: Float64Array
    outlier: BoolArray


@dataclass(frozen=True, slots=True, eq=False)
class FineExemplars:
    """Long-term and short-term exemplars together, f of them, the long-term ones first.

    ``features`` (f, d) float32; ``labels`` (f, 2) int64, negative and positive; ``count``
    (f,) observations that each stands for; ``is_short`` (f,). The others say where the
    picture of an exemplar is found.
    """

    ids: IntArray
    features: Float32Array
    labels: IntArray
    count: IntArray
    is_short: BoolArray
    exemplar_stamp_ns: IntArray
    exemplar_log: IntArray
    exemplar_patch: IntArray


class TwoScale(LongClusters):
    """Long-term clusters by STRAP, and short-term ones by affinity propagation.

    What fits no long-term cluster is an outlier. Affinity propagation over the outliers is
    the short-term model, which reacts at once; when there are enough of them they are
    merged into the long-term one (Algorithm 2).

    Arrays are copies with one row a long-term cluster, ids ascending.

    Parameters
    ----------
    strap, affinity : StrapParams, AffinityParams
        Settings. Preferences are fixed: the median, and for the coarse clusters
        :func:`~mpap_cli.clustering.preference.coarse_preference`; items weigh as STRAP
        says.
    n_dims : int
        Coordinates of an observation.

    Notes
    -----
    The paper updates the short-term model with each outlier; here it is made when it is
    asked for, which gives the same whenever it is read. Label counts are never lost: their
    sum over clusters and reservoir stays the same through rebuilds, and as outliers leave the
    reservoir of a known place. After a rebuild every former exemplar, long-term and
    short-term, is within the fit radius of a new one. When a place is known, and from what on
    it is not any more, :class:`~mpap_cli.clustering.strap_rows.restarts.Restarts` says.

    Examples
    --------
    >>> two = TwoScale(StrapParams(reservoir=5, eps=0.2), AffinityParams(), n_dims=2)
    >>> points = np.eye(2, dtype=np.float32)[[0, 0, 0, 1, 1, 1, 0]]
    >>> added = two.add_observations(points, np.arange(7), np.zeros(7, int), log_index=0)
    >>> added.outlier.tolist(), two.count.tolist()
    ([True, True, True, True, True, True, False], [4, 3])
    """

    def __init__(self, strap: StrapParams, affinity: AffinityParams, n_dims: int) -> None:
        self.strap = strap
        self.affinity = affinity
        self.n_dims = n_dims
        self._long = Strap(strap, affinity, n_dims)
        self._fine: FineExemplars | None = None
        self._coarse: Clustering | None = None

    def add_observations(
        self, features: Float32Array, stamps_ns: IntArray, patches: IntArray, log_index: int
    ) -> Insertion:
        """Add observations one after the other (Algorithm 2).

        Parameters
        ----------
        features : ndarray of shape (m, d)
            Embedded histograms: of length 1.
        stamps_ns, patches : ndarray of shape (m,)
            Nanoseconds, and where in its image each was.
        log_index : int
            Which log they come from; kept with the exemplars.

        Returns
        -------
        Insertion

        Raises
        ------
        ValueError
            If the shapes do not fit or an observation is not of length 1.
        """
        points = self._checked(features, np.shape(stamps_ns), np.shape(patches))
        stamps, places = np.array(stamps_ns, np.int64), np.array(patches, np.int64)
        m = len(points)
        ids, squared = np.empty(m, np.int64), np.empty(m)
        start = 0
        while start < m:
            part = slice(start, start + _BLOCK)
            new_ids, new_squared = self._long.insert(
                points[part], stamps[part], places[part], log_index
            )
            added = slice(start, start + len(new_ids))
            ids[added], squared[added] = new_ids, new_squared
            start = added.stop
            if self._long.restarts.is_due:
                self.rebuild()
        if m:
            self._fine = None
        return Insertion(ids, np.sqrt(squared), ~(squared < self.strap.eps**2))

    def _checked(
        self, features: Float32Array, stamps: tuple[int, ...], patches: tuple[int, ...]
    ) -> Float32Array:
        """Return the features as float32, or say what is wrong with the input."""
        points = np.ascontiguousarray(features, np.float32)
        wanted = len(points), self.n_dims
        if points.shape != wanted or stamps != wanted[:1] or patches != wanted[:1]:
            msg = f"features {points.shape} at {stamps} stamps and {patches} patches, not {wanted}"
            raise ValueError(msg)
        squared = np.einsum("md,md->m", points, points)
        if not (np.abs(squared - 1.0) < LENGTH_TOLERANCE).all():
            msg = "features: found an observation whose length is not 1"
            raise ValueError(msg)
        return points

    def rebuild(self) -> None:
        """Make the long-term clusters anew and empty the reservoir (lines 6 to 8)."""
        self._long.update_clustering(self._short_exemplars())
        self._fine = self._coarse = None

    def _short_exemplars(self) -> IntArray:
        """Cluster the outliers; return the rows of the exemplars in the reservoir (line 4)."""
        s = similarities(self._long.reservoir.exemplars, self.affinity.similarity)
        return affinity_propagation(s, resolve_preference(s, "median"), self.affinity).exemplars

    def current_ids(self, ids: IntArray) -> IntArray:
        """Return the ids of what these ids stand for now, -1 for unknown ones (m,)."""
        return self._long.lineage.current(ids)

    def rows_of(self, ids: IntArray) -> IntArray:
        """Return the rows of the clusters that ids (m,) belong to now, -1 for outliers."""
        known, current = self._long.clusters.ids, self.current_ids(ids)
        if not known.size:
            return np.full(np.shape(ids), -1, np.int64)
        rows = np.minimum(np.searchsorted(known, current), known.size - 1)
        return np.where(known[rows] == current, rows, -1)

    def add_labels(self, ids: IntArray, positive: BoolArray) -> None:
        """Count labels of observations on what they belong to now.

        Parameters
        ----------
        ids : ndarray of shape (m,)
            As returned by :meth:`add_observations` at any time; unknown ones are left out.
        positive : ndarray of shape (m,)
            The labels.
        """
        self._long.add_labels(ids, positive)
        self._fine = None

    def fine(self) -> FineExemplars:
        """Return the exemplars of both time scales.

        A short-term exemplar stands for the outliers that it is nearest to, of all
        short-term ones, and that it explains; it has their labels.
        """
        if self._fine is None:
            self._fine = self._made_fine()
        return self._fine

    def _made_fine(self) -> FineExemplars:
        long, reservoir = self._long.clusters, self._long.reservoir
        short = self._short_exemplars()
        count, labels = np.zeros(len(short), np.int64), np.zeros((len(short), 2), np.int64)
        if short.size:
            squared = squared_distances(reservoir.exemplars, reservoir.exemplars[short])
            explained = squared.min(axis=1) < self.strap.eps**2
            nearest = squared.argmin(axis=1)[explained]
            np.add.at(count, nearest, 1)
            np.add.at(labels, nearest, reservoir.labels[explained])
        joined = {
            name: np.concatenate([getattr(long, name), getattr(reservoir, name)[short]])
            for name in ("ids", "exemplar_stamp_ns", "exemplar_log", "exemplar_patch")
        }
        return FineExemplars(
            features=np.concatenate([long.exemplars, reservoir.exemplars[short]]),
            labels=np.concatenate([long.labels, labels]),
            count=np.concatenate([long.counts, count]),
            is_short=np.arange(long.n_items + len(short)) >= long.n_items,
            **joined,
        )

    def coarse(self) -> Clustering:
        """Cluster the long-term exemplars: the level that people look at."""
        if self._coarse is None:
            s = similarities(self._long.clusters.exemplars, self.affinity.similarity)
            self._coarse = affinity_propagation(s, coarse_preference(s), self.affinity)
        return self._coarse

    def state(self) -> dict[str, NDArray[Any]]:
        """Return everything that was learnt as plain arrays, for a model file."""
        return pack(self._long.parts())

    @classmethod
    def from_state(
        cls, strap: StrapParams, affinity: AffinityParams, state: Mapping[str, NDArray[Any]]
    ) -> Self:
        """Go on from the state of another one; ids that were merged before it are unknown.

        Raises
        ------
        ModelError
            If an array is missing or its shape, type or values cannot be.
        """
        long = Strap.from_parts(strap, affinity, unpack(state))
        two_scale = cls(strap, affinity, long.clusters.exemplars.shape[1])
        two_scale._long = long
        return two_scale
