"""Labels become counts of meta-points, and counts become probabilities (equation 8)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.observations import (
    NS_PER_S,
    BoolArray,
    Clustering,
    Float64Array,
    Int8Array,
    IntArray,
    Press,
)
from mpap_cli.params import BumperParams, PropertyParams
from mpap_cli.properties.labels import NO_LABEL, label_scans, press_starts

SHORTEST_WAIT_S = 5.0
_SPARE_S = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class SettledLabels:
    """Observations of one log whose labels do not change any more.

    ``stamps_ns``, ``ids`` (of the meta-points that took them in) and ``press_ns`` (start
    of the press that the observation lies in or after, -1 if there is none near) have
    shape (n,); ``labels`` (n, 3) int8 has the columns contact, onset, early.
    """

    stamps_ns: IntArray
    ids: IntArray
    labels: Int8Array
    press_ns: IntArray


class LabelQueue:
    """Observations that wait until the presses around them are known (section 2.3).

    Clustering never waits for labels: an observation is taken in at once and its label
    is counted later, on the meta-point that took it in. The wait is the longer of 5 s
    and the warning time (or ``bump_merge``) plus 1 s of log time, so what waits is bounded.
    """

    def __init__(self, params: PropertyParams, bumper: BumperParams) -> None:
        needed_s = max(params.early_s, bumper.bump_merge) + _SPARE_S
        self._params = params
        self._wait_ns = round(max(SHORTEST_WAIT_S, needed_s) * NS_PER_S)
        self._stamps_ns = np.empty(0, dtype=np.int64)
        self._ids = np.empty(0, dtype=np.int64)

    def __len__(self) -> int:
        return self._ids.size

    def add(self, stamps_ns: IntArray, ids: IntArray) -> None:
        """Let observations wait; both arrays have shape (n,)."""
        self._stamps_ns = np.concatenate([self._stamps_ns, stamps_ns])
        self._ids = np.concatenate([self._ids, ids])

    @property
    def needs_presses_from_ns(self) -> int | None:
        """Presses that end at or before this stamp no longer matter (None: nothing waits)."""
        if not len(self):
            return None
        return int(self._stamps_ns.min()) - round(self._params.release_s * NS_PER_S)

    def settle(self, presses: Sequence[Press], until_ns: int) -> SettledLabels:
        """Label and let go what was observed long enough before ``until_ns``.

        Parameters
        ----------
        presses : sequence of Press
            Those known up to ``until_ns``, at least from :attr:`needs_presses_from_ns` on.
        until_ns : int
            No bump stamped at or before is still to come.

        Returns
        -------
        SettledLabels
            In the order in which the observations were added.
        """
        return self._label(presses, self._stamps_ns <= until_ns - self._wait_ns)

    def end(self, presses: Sequence[Press]) -> SettledLabels:
        """Label and let go everything at the end of the log."""
        return self._label(presses, np.ones(len(self), dtype=np.bool_))

    def _label(self, presses: Sequence[Press], ripe: BoolArray) -> SettledLabels:
        """Label the observations marked as ripe; the others go on waiting."""
        stamps_ns, ids = self._stamps_ns[ripe], self._ids[ripe]
        self._stamps_ns, self._ids = self._stamps_ns[~ripe], self._ids[~ripe]
        labels = label_scans(stamps_ns, presses, self._params)
        return SettledLabels(stamps_ns, ids, labels, press_starts(stamps_ns, presses))


def count_labels(meta_points: MetaPoints, ids: IntArray, labels: Int8Array) -> None:
    """Add labels to the counts of the meta-points that took the observations in.

    Parameters
    ----------
    meta_points : MetaPoints
        Its three pairs of counts grow; nothing else changes.
    ids : ndarray of shape (n,)
        Meta-points; those dropped since are left out.
    labels : ndarray of shape (n, 3)
        1, 0 or -1 (not counted); columns contact, onset, early.
    """
    for pair in range(labels.shape[1]):
        counted = labels[:, pair] != NO_LABEL
        meta_points.add_counts(ids[counted], pair, labels[counted, pair] == 1)


@dataclass(frozen=True, slots=True, eq=False)
class ClusteredPoints:
    """A clustering and the ids of the cluster-points (n,) that it was made of, in its order."""

    clustering: Clustering
    ids: IntArray

    @property
    def n_clusters(self) -> int:
        """Number of clusters."""
        return self.clustering.exemplars.size

    def clusters_of(self, ids: IntArray) -> IntArray:
        """Return the clusters of meta-points by their ids (n,), -1 where they have none."""
        place = np.searchsorted(self.ids, ids)
        known = np.append(self.ids, -1)[place] == ids
        found: IntArray = np.where(known, np.append(self.clustering.labels, -1)[place], -1)
        return found


def cluster_counts(meta_points: MetaPoints, clustered: ClusteredPoints, pair: int) -> IntArray:
    """Sum the labels of each cluster over its cluster-points (equation 8).

    Returns
    -------
    ndarray of shape (n_clusters, 2)
        Negatives and positives of one pair of counts.
    """
    counts = np.zeros((clustered.n_clusters, 2), dtype=np.int64)
    rows = meta_points.rows_of(clustered.ids)
    np.add.at(counts, clustered.clustering.labels, meta_points.counts[rows, pair])
    return counts


def ratio(counts: IntArray) -> Float64Array:
    """Share of positives, the form of equation 8.

    Parameters
    ----------
    counts : ndarray of shape (..., 2)
        Negatives and positives.

    Returns
    -------
    ndarray of shape (...)
        In [0, 1]; NaN where nothing is counted.

    Examples
    --------
    >>> ratio(np.array([[3, 1], [0, 0]])).tolist()
    [0.25, nan]
    """
    total = counts.sum(axis=-1)
    shares: Float64Array = np.where(total > 0, counts[..., 1] / np.maximum(total, 1), np.nan)
    return shares


def jeffreys(
    positives: IntArray, negatives: IntArray, level: float = 0.95
) -> tuple[Float64Array, Float64Array, Float64Array]:
    """Posterior of a share under Jeffreys' prior, Beta(positives + 1/2, negatives + 1/2).

    Parameters
    ----------
    positives, negatives : ndarray of one shape
        Counts, 0 or more.
    level : float
        Mass of the equal-tailed interval, in (0, 1).

    Returns
    -------
    mean, low, high : ndarray of that shape
        In (0, 1); NaN where nothing is counted.

    Examples
    --------
    >>> mean, low, high = jeffreys(np.array([1]), np.array([9]))
    >>> [float(value[0].round(3)) for value in (mean, low, high)]
    [0.136, 0.011, 0.381]
    """
    from scipy.special import betaincinv  # noqa: PLC0415  # slow to import

    first = np.asarray(positives, np.float64) + 0.5
    second = np.asarray(negatives, np.float64) + 0.5
    nothing = first + second <= 1.0
    figures = (
        first / (first + second),
        betaincinv(first, second, (1 - level) / 2),
        betaincinv(first, second, (1 + level) / 2),
    )
    mean, low, high = (np.where(nothing, np.nan, figure) for figure in figures)
    return mean, low, high
