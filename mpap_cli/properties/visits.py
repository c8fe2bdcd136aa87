"""Visits to a cluster: runs of its observations that are parted by two seconds or more.

Scans that follow one another are not independent, so the interval of a cluster's
probability counts visits, not scans. Which cluster a meta-point belongs to is only known
when the clustering is made; until then the observations wait in a temporary file.
"""

import tempfile
import weakref
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mpap_cli.observations import NS_PER_S, Int8Array, IntArray
from mpap_cli.properties.counts import SettledLabels

VISIT_GAP_NS = 2 * NS_PER_S
_IN_MEMORY_BYTES = 1 << 20
_RUNS_PER_CHUNK = 1 << 15
_RUN = np.dtype(
    [
        ("first_ns", "<i8"),
        ("last_ns", "<i8"),
        ("press_ns", "<i8"),
        ("id", "<i8"),
        ("log", "<i4"),
        ("label", "<i4"),
    ]
)
_NONE = -2


@dataclass(frozen=True, slots=True, eq=False)
class Visits:
    """Visits of k clusters; arrays of shape (k,), int64.

    ``positive`` visits hold a positive label, ``negative`` ones only negative labels;
    a visit without any label is neither. ``presses`` counts the presses that the
    positive labels come from.
    """

    visits: IntArray
    positive: IntArray
    negative: IntArray
    presses: IntArray

    def __add__(self, other: "Visits") -> "Visits":
        return Visits(
            self.visits + other.visits,
            self.positive + other.positive,
            self.negative + other.negative,
            self.presses + other.presses,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Sightings:
    """What was seen of clusters: arrays of shape (n,), in time order.

    ``ids`` tell what took each observation in, ``press_ns`` is the start of the press that
    it belongs to, -1 if there is none.
    """

    stamps_ns: IntArray
    ids: IntArray
    press_ns: IntArray


class VisitSpool:
    """Runs of observations, kept in a temporary file until their clusters are known.

    Observations of one meta-point that follow one another with one label are one run.
    Memory does not grow with the log; the file holds 40 bytes a run.
    """

    def __init__(self) -> None:
        self._file = tempfile.SpooledTemporaryFile(max_size=_IN_MEMORY_BYTES)  # noqa: SIM115  # lives as long as the model
        self.close = weakref.finalize(self, self._file.close)

    def add(self, settled: SettledLabels | Sightings, labels: Int8Array, log_index: int) -> None:
        """Append observations of one log, in time order.

        Parameters
        ----------
        settled : SettledLabels or Sightings
            Stamps, ids and presses of n observations.
        labels : ndarray of shape (n,)
            1, 0 or -1: the target that the clusters are shown for.
        log_index : int
            Which log they are from; a visit does not go on from log to log.
        """
        if not settled.ids.size:
            return
        stamps_ns, label = settled.stamps_ns, labels.astype(np.int64)
        begins = np.ones(stamps_ns.size, dtype=np.bool_)
        begins[1:] = np.diff(stamps_ns) >= VISIT_GAP_NS
        for column in (settled.ids, label, np.where(label == 1, settled.press_ns, 0)):
            begins[1:] |= np.diff(column) != 0
        first = np.flatnonzero(begins)
        last = np.append(first[1:], stamps_ns.size) - 1
        runs = np.empty(first.size, dtype=_RUN)
        runs["first_ns"], runs["last_ns"] = stamps_ns[first], stamps_ns[last]
        runs["press_ns"], runs["id"] = settled.press_ns[first], settled.ids[first]
        runs["log"], runs["label"] = log_index, label[first]
        self._file.seek(0, 2)
        self._file.write(runs.tobytes())

    def count(self, cluster_of: Callable[[IntArray], IntArray], n_clusters: int) -> Visits:
        """Count the visits of each cluster over everything that was added.

        Parameters
        ----------
        cluster_of : callable
            Turns ids of meta-points (n,) into clusters (n,), -1 where there is none.
        n_clusters : int
            Number of clusters.

        Returns
        -------
        Visits
            Of ``n_clusters`` clusters.
        """
        counter = _VisitCounter(n_clusters)
        for runs in self._chunks():
            counter.add(runs, cluster_of(runs["id"].astype(np.int64)))
        return counter.visits()

    def _chunks(self) -> Iterator[NDArray[np.void]]:
        """Read the runs back, a bounded number at a time."""
        self._file.seek(0)
        while chunk := self._file.read(_RUNS_PER_CHUNK * _RUN.itemsize):
            yield np.frombuffer(chunk, dtype=_RUN)


class _VisitCounter:
    """Counts visits over runs in time order and remembers the last run of each cluster."""

    def __init__(self, n_clusters: int) -> None:
        self._last_log = np.full(n_clusters, _NONE)
        self._last_ns = np.zeros(n_clusters, dtype=np.int64)
        self._n_visits = np.zeros(n_clusters, dtype=np.int64)
        self._positive = _Changes(n_clusters)
        self._labelled = _Changes(n_clusters)
        self._presses = _Changes(n_clusters)

    def add(self, runs: NDArray[np.void], clusters: IntArray) -> None:
        """Take in the runs of the next stretch of time."""
        order = np.argsort(clusters, kind="stable")
        order = order[clusters[order] >= 0]
        if not order.size:
            return
        cluster, run = clusters[order], runs[order]
        visit = self._number_visits(cluster, run)
        positive, labelled = run["label"] == 1, run["label"] >= 0
        self._positive.add(cluster[positive], visit[positive])
        self._labelled.add(cluster[labelled], visit[labelled])
        # A log that is given twice has the same stamps, but its presses count twice.
        press = run["press_ns"] + run["log"].astype(np.int64)
        self._presses.add(cluster[positive], press[positive])

    def visits(self) -> Visits:
        """Return the counts."""
        positive = self._positive.counts
        return Visits(
            self._n_visits.copy(),
            positive.copy(),
            self._labelled.counts - positive,
            self._presses.counts.copy(),
        )

    def _number_visits(self, cluster: IntArray, run: NDArray[np.void]) -> IntArray:
        """Return the number of the visit that each run belongs to, from 1 in each cluster."""
        log, first_ns, last_ns = run["log"], run["first_ns"], run["last_ns"]
        new_cluster = np.ones(cluster.size, dtype=np.bool_)
        new_cluster[1:] = cluster[1:] != cluster[:-1]
        log_before = np.where(new_cluster, self._last_log[cluster], np.roll(log, 1))
        ns_before = np.where(new_cluster, self._last_ns[cluster], np.roll(last_ns, 1))
        begins = (log != log_before) | (first_ns - ns_before >= VISIT_GAP_NS)
        begun = np.cumsum(begins)
        begun_before = (begun - begins)[new_cluster][np.cumsum(new_cluster) - 1]
        number: IntArray = self._n_visits[cluster] + begun - begun_before
        # A repeated index keeps the last value, which is the last run of the cluster.
        self._last_log[cluster], self._last_ns[cluster] = log, last_ns
        self._n_visits[cluster] = number
        return number


class _Changes:
    """Counts how often a key changes in each cluster."""

    def __init__(self, n_clusters: int) -> None:
        self.counts = np.zeros(n_clusters, dtype=np.int64)
        self._last = np.full(n_clusters, _NONE, dtype=np.int64)

    def add(self, cluster: IntArray, key: IntArray) -> None:
        """Take in keys in time order within each cluster; clusters ascend."""
        if not cluster.size:
            return
        before = np.roll(key, 1)
        first = np.ones(cluster.size, dtype=np.bool_)
        first[1:] = cluster[1:] != cluster[:-1]
        changed = key != np.where(first, self._last[cluster], before)
        self.counts += np.bincount(cluster[changed], minlength=self.counts.size)
        self._last[cluster] = key
