"""Streaming affinity propagation (section 3.3 of the paper; Zhang, Furtlehner, Sebag 2008)."""

from typing import Self

import numpy as np

from mpap_cli.clustering.strap_rows.arrays import (
    Items,
    absorbed,
    empty_items,
    faded,
    joined,
    single_items,
    taken,
)
from mpap_cli.clustering.strap_rows.choosing import assign, choose_exemplars, cover
from mpap_cli.clustering.strap_rows.lineage import Lineage
from mpap_cli.clustering.strap_rows.restarts import Restarts
from mpap_cli.clustering.strap_rows.state import StrapParts
from mpap_cli.errors import ModelError
from mpap_cli.observations import NS_PER_S, BoolArray, Float32Array, Float64Array, IntArray
from mpap_cli.params import AffinityParams, StrapParams

_NOTHING = np.zeros(0, np.int64)


class Strap:
    """Clusters with fixed exemplars, and a reservoir of outliers that waits for a rebuild.

    A point within the fit radius of an exemplar updates the nearest cluster, else it joins
    the reservoir. Once the reservoir overflows (or, as an option, the share of outliers has
    risen) affinity propagation over clusters and outliers makes the clusters anew.

    Parameters
    ----------
    strap, affinity : StrapParams, AffinityParams
        Settings.
    n_dims : int
        Coordinates of a point.

    Notes
    -----
    A cluster weighs at most ``weight_cap`` in a rebuild, else heavy ones could never merge.
    An exemplar stays if no new one is within the fit radius of it: what was explained stays
    explained.

    :class:`~mpap_cli.clustering.strap_rows.restarts.Restarts` says when a rebuild comes and
    when a known place adds no exemplar. Of the outliers of a known place the last
    ``reservoir`` wait; older ones join the nearest cluster, however far, which counts them
    and their labels, but they add nothing to its weight and distortion.
    """

    def __init__(self, strap: StrapParams, affinity: AffinityParams, n_dims: int) -> None:
        self._strap = strap
        self._affinity = affinity
        self.clusters = empty_items(0, n_dims)
        self.lineage = Lineage()
        self.restarts = Restarts(strap)
        self.n_outliers_ever = 0
        self.n_rebuilds = 0
        self._outliers = empty_items(strap.reservoir + 1, n_dims)
        self.n_reservoir = 0

    @property
    def reservoir(self) -> Items:
        """Outliers that wait; a view, with one row each."""
        return Items._make(column[: self.n_reservoir] for column in self._outliers)

    def insert(
        self, features: Float32Array, stamps_ns: IntArray, patches: IntArray, log_index: int
    ) -> tuple[IntArray, Float64Array]:
        """Add points one after the other, up to the one that calls for a rebuild.

        Parameters
        ----------
        features : ndarray of shape (m, d)
            Points of length 1.
        stamps_ns, patches : ndarray of shape (m,)
            Nanoseconds, and places in the image.
        log_index : int
            Which log they are from.

        Returns
        -------
        tuple of ndarray of shape (n,)
            For the first n <= m points, which were added, the ids of the clusters they
            fitted or of the outliers they are, and squared distances to the nearest
            exemplar, inf without any. ``restarts.is_due`` tells whether a rebuild is due.
        """
        rows, squared = self._nearest(features)
        is_outlier = ~(squared < self._strap.eps**2)
        n = self.restarts.take(is_outlier, self.n_reservoir)
        rows, squared, is_outlier = rows[:n], squared[:n], is_outlier[:n]
        fits, at = np.flatnonzero(~is_outlier), np.flatnonzero(is_outlier)
        ids = np.empty(n, np.int64)
        ids[fits] = self._fit(rows[fits], squared[fits], stamps_ns[fits])
        ids[at] = self.lineage.issue(len(at))
        self.n_outliers_ever += len(at)
        self._keep(single_items(features[at], ids[at], stamps_ns[at], patches[at], log_index))
        return ids, squared

    def _nearest(self, features: Float32Array) -> tuple[IntArray, Float64Array]:
        """Return the row of the nearest exemplar and the squared distance; inf without any."""
        from mpap_cli.clustering.strap_rows import _kernels  # noqa: PLC0415  # slow: numba

        if not self.clusters.n_items:
            return np.zeros(len(features), np.int64), np.full(len(features), np.inf)
        return _kernels.nearest(features, self.clusters.exemplars)

    def _fit(self, rows: IntArray, squared: Float64Array, stamps_ns: IntArray) -> IntArray:
        """Update clusters with points that fit; return the ids of the clusters."""
        from mpap_cli.clustering.strap_rows import _kernels  # noqa: PLC0415  # slow: numba

        window_ns = NS_PER_S * (self._strap.strap_window_s or 0.0)
        _kernels.absorb(self.clusters, rows, squared, stamps_ns, window_ns)
        return self.clusters.ids[rows]

    def _keep(self, outliers: Items) -> None:
        """Append outliers to the reservoir; the oldest of more than it holds leave it."""
        most = self._strap.reservoir + self.restarts.is_due
        n_leaving = self.n_reservoir + outliers.n_items - most
        if n_leaving > 0:
            waiting = joined(self.reservoir, outliers)
            self._settle(taken(waiting, slice(n_leaving)))
            self.n_reservoir, outliers = 0, taken(waiting, slice(n_leaving, None))
        rows = slice(self.n_reservoir, self.n_reservoir + outliers.n_items)
        for name in Items._fields:
            getattr(self._outliers, name)[rows] = getattr(outliers, name)
        self.n_reservoir += outliers.n_items

    def _settle(self, outliers: Items) -> None:
        """Let the nearest clusters count outliers that are too few to matter."""
        rows, _ = self._nearest(outliers.exemplars)
        np.add.at(self.clusters.counts, rows, outliers.counts)
        np.add.at(self.clusters.labels, rows, outliers.labels)
        self.lineage.replace(outliers.ids, self.clusters.ids[rows])

    def update_clustering(self, kept: IntArray = _NOTHING) -> None:
        """Make the clusters anew out of clusters and outliers; the reservoir is empty then.

        Parameters
        ----------
        kept : ndarray of shape (n,)
            Rows of the reservoir that must be within the fit radius of a new exemplar, as
            all old exemplars must.
        """
        n_clusters = self.clusters.n_items
        items = faded(joined(self.clusters, self.reservoir), self._strap.strap_window_s)
        if items.n_items:
            exemplars = np.arange(n_clusters)
            if self.n_reservoir:
                exemplars = choose_exemplars(items, n_clusters, self._strap, self._affinity)
                must = np.concatenate([np.arange(n_clusters), n_clusters + kept])
                exemplars = cover(items, exemplars, must, self._strap.eps)
            labels, squared = assign(items, exemplars)
            self._replace(items, exemplars, labels, squared)
        self.restarts.reset()
        self.n_rebuilds += 1

    def _replace(
        self, items: Items, exemplars: IntArray, labels: IntArray, squared: Float64Array
    ) -> None:
        """Put new clusters in the place of clusters and outliers."""
        made = absorbed(items, exemplars, labels, squared)
        self.lineage.replace(items.ids, made.ids[labels])
        self.clusters = taken(made, np.argsort(made.ids))
        self.n_reservoir = 0

    def parts(self) -> StrapParts:
        """Return everything that it knows; arrays are shared, not copied."""
        return StrapParts(
            clusters=self.clusters,
            reservoir=self.reservoir,
            surplus=self.restarts.surplus.state,
            rises=self.restarts.rises.state,
            next_id=self.lineage.next_id,
            n_since_rebuild=self.restarts.n_points,
            n_outliers_ever=self.n_outliers_ever,
            n_rebuilds=self.n_rebuilds,
        )

    @classmethod
    def from_parts(cls, strap: StrapParams, affinity: AffinityParams, parts: StrapParts) -> Self:
        """Go on from the parts of another one, whose clusters are taken over.

        Raises
        ------
        ModelError
            If its reservoir holds more outliers than these settings allow.
        """
        waiting = parts.reservoir.n_items
        if waiting > strap.reservoir:
            found = f"{waiting} outliers wait, setting reservoir is {strap.reservoir}"
            msg = f"model: {found}; use the setting it was learnt with"
            raise ModelError(msg)
        made = cls(strap, affinity, parts.clusters.exemplars.shape[1])
        made.clusters = parts.clusters
        made._keep(parts.reservoir)
        made.lineage = Lineage(
            np.concatenate([made.clusters.ids, made.reservoir.ids]), parts.next_id
        )
        made.restarts.resume(parts.n_since_rebuild, parts.surplus, parts.rises)
        made.n_outliers_ever, made.n_rebuilds = parts.n_outliers_ever, parts.n_rebuilds
        return made

    def add_labels(self, ids: IntArray, positive: BoolArray) -> None:
        """Count labels of points on what they belong to now.

        Parameters
        ----------
        ids : ndarray of shape (m,)
            As returned by :meth:`insert`, also before rebuilds; unknown ones are left out.
        positive : ndarray of shape (m,)
            The labels.
        """
        reservoir = self.reservoir
        living = np.concatenate([self.clusters.ids, reservoir.ids])
        current = self.lineage.current(ids)
        rows = np.searchsorted(living, current[current >= 0])
        columns = np.asarray(positive, np.bool_)[current >= 0].astype(np.int64)
        counts = np.zeros((len(living), 2), np.int64)
        np.add.at(counts, (rows, columns), 1)
        self.clusters.labels[:] += counts[: self.clusters.n_items]
        reservoir.labels[:] += counts[self.clusters.n_items :]
