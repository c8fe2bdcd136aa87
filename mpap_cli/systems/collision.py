"""Learning to predict collisions from laser scans and a bumper (section 4.1)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.errors import ModelError
from mpap_cli.features.scans.scan_features import ScanEmbedder
from mpap_cli.observations import (
    NS_PER_S,
    Batch,
    Bump,
    Clustering,
    FeatureBlock,
    Int8Array,
    IntArray,
    Prediction,
    Press,
    ScanBlock,
)
from mpap_cli.params import Settings
from mpap_cli.properties.counts import LabelQueue, SettledLabels, count_labels
from mpap_cli.properties.visits import Visits, VisitSpool
from mpap_cli.systems.cluster_rows import ClusterRow, make_cluster_rows, pair_of
from mpap_cli.systems.labelling import LogLabeller, LogSource, LogStart
from mpap_cli.systems.model_parts import (
    CarriedVisits,
    ModelParts,
    ModelState,
    new_parts,
    pack,
    recluster,
    unpack,
)
from mpap_cli.systems.reading import SelfCheck, check_theta, fit_reading, predict

_GROWN_BY = 20
_GROWN_SHARE = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class LearntBlock:
    """Observations that were taken in.

    ``ids`` (n,) are the meta-points that took them; ``cases`` (n,) tell by which of the
    three cases of algorithm 1 (1 cluster-point, 2 noise-point, 3 new).
    """

    features: FeatureBlock
    ids: IntArray
    cases: Int8Array


@dataclass(slots=True)
class _OpenLog:
    """The log that is being replayed."""

    start: LogStart
    embedder: ScanEmbedder
    queue: LabelQueue
    labeller: LogLabeller[SettledLabels]
    n_scans: int = 0
    clustered_ns: int | None = None


class CollisionModel:
    """Clusters of scans with the probability that each means a collision.

    Parameters
    ----------
    settings : Settings
        Everything that can change the result.
    parts : ModelParts, optional
        What an older model knows (it is learnt on, not copied); its settings count.
    online : bool
        Cluster again while a log is replayed: whenever the cluster-points have grown by
        20 or by a tenth, at most once per second of log time. Else only after the end of
        a log, when what was learnt is asked for.

    Notes
    -----
    A log is ``begin_log``, then any number of ``observe``, then ``end_log``. Clustering
    never waits for labels, and labels never enter it: they are counted on the meta-points
    as soon as the presses around an observation are known.
    """

    def __init__(
        self, settings: Settings, parts: ModelParts | None = None, *, online: bool = False
    ) -> None:
        if parts is None:
            parts = new_parts(settings, ScanEmbedder(settings.scan).n_dims)
        self._known = parts
        self._spool = VisitSpool()
        self._online = online
        self._stale = False
        self._log: _OpenLog | None = None

    @property
    def settings(self) -> Settings:
        """Settings it was made with."""
        return self._known.settings

    @property
    def meta_points(self) -> MetaPoints:
        """Meta-points with their counts."""
        return self._known.meta_points

    @property
    def clustering(self) -> Clustering:
        """The last clustering of the cluster-points."""
        return self._clustered().clustered.clustering

    @property
    def logs(self) -> tuple[LogSource, ...]:
        """Logs that were learnt, in their order."""
        return self._known.logs

    def begin_log(self, start: LogStart) -> None:
        """Start to replay a log; features and labels do not look back beyond it."""
        queue = LabelQueue(self.settings.properties, self.settings.bumper)
        self._log = _OpenLog(
            start,
            ScanEmbedder(self.settings.scan, start.forward_rad, start.range_max),
            queue,
            LogLabeller(start, self.settings.bumper, queue),
        )

    def observe(self, batch: Batch) -> tuple[LearntBlock, ...]:
        """Take in what the log holds up to ``batch.until_ns``: one result a block of scans."""
        learnt = tuple(self.learn(self.embed(block)) for block in batch.scans)
        self.settle(batch.bumps, batch.until_ns)
        return learnt

    def embed(self, block: ScanBlock) -> FeatureBlock:
        """Turn the next scans of the log into features (section 4.1)."""
        return self._opened().embedder.transform(block)

    def learn(self, features: FeatureBlock) -> LearntBlock:
        """Add observations to the meta-points (algorithm 1); their labels come later."""
        log = self._opened()
        ids, cases = self.meta_points.add_data_points(
            features.features, features.stamps_ns, len(self.logs)
        )
        log.queue.add(features.stamps_ns, ids)
        log.n_scans += ids.size
        return LearntBlock(features, ids, cases)

    def settle(self, bumps: Sequence[Bump], until_ns: int) -> None:
        """Take in the bumps up to ``until_ns`` and count the labels settled by them."""
        log = self._opened()
        self._count(log.labeller.settle(bumps, until_ns))
        if self._online and self._grown(log, until_ns):
            log.clustered_ns = until_ns
            self.recluster()

    def end_log(self, end_ns: int) -> tuple[Press, ...] | None:
        """Count the labels that still wait; the log's last message is stamped ``end_ns``.

        Returns
        -------
        tuple of Press or None
            The presses of the log; None if it has no bumper.
        """
        log = self._opened()
        self._count(log.labeller.end(end_ns))
        presses = log.labeller.presses
        source = log.start.source(end_ns, log.n_scans, presses)
        self._known = replace(self._known, logs=(*self.logs, source))
        self._log, self._stale = None, True
        if self._online:
            self.recluster()
        return presses

    def recluster(self) -> None:
        """Run affinity propagation over the cluster-points and fit what probabilities mean."""
        clustered = replace(self._known, clustered=recluster(self.meta_points, self.settings))
        self._known, self._stale = fit_reading(clustered), False

    def finish(self) -> None:
        """Sum up the visits; the temporary file that they were counted from goes."""
        self._known = self.parts()
        self._spool.close()
        self._spool = VisitSpool()

    def predict(self, block: FeatureBlock, target: str = "contact") -> Prediction:
        """Tell what the model says of observations (:func:`reading.predict`)."""
        return predict(self._clustered(), block.features, target)

    def clusters(self) -> list[ClusterRow]:
        """Describe the clusters: the rows of clusters.csv."""
        return make_cluster_rows(self._clustered(), self._visits())

    def self_check(self) -> SelfCheck:
        """Tell whether theta suits the data."""
        return check_theta(self.meta_points)

    def parts(self) -> ModelParts:
        """Return what the model knows; its meta-points are shared, not copied."""
        known = self._clustered()
        return replace(known, carried=CarriedVisits.of(self._visits(), known.clustered))

    def state(self) -> ModelState:
        """Return the model as arrays and a header, to be kept between two logs."""
        return pack(self.parts())

    @classmethod
    def from_state(cls, state: ModelState, *, online: bool = False) -> "CollisionModel":
        """Build the model again; ModelError if the state is damaged or of another version."""
        parts = unpack(state)
        n_dims = ScanEmbedder(parts.settings.scan).n_dims
        if parts.meta_points.n_dims != n_dims:
            found = f"meta-points of {parts.meta_points.n_dims} dimensions"
            msg = f"model: found {found}, its settings make {n_dims}; learn it again"
            raise ModelError(msg)
        return cls(parts.settings, parts, online=online)

    def _opened(self) -> _OpenLog:
        if self._log is None:
            msg = "no log is open: begin_log comes first"
            raise RuntimeError(msg)
        return self._log

    def _clustered(self) -> ModelParts:
        """Return what is known; a run of affinity propagation serves all logs before it."""
        if self._stale:
            self.recluster()
        return self._known

    def _visits(self) -> Visits:
        """Count the visits of each cluster over all logs."""
        clustered = self._clustered().clustered
        before = self._known.carried.visits(clustered)
        return before + self._spool.count(clustered.clusters_of, clustered.n_clusters)

    def _count(self, settled: SettledLabels) -> None:
        """Count settled labels on the meta-points, and keep them for the visits."""
        count_labels(self.meta_points, settled.ids, settled.labels)
        shown = settled.labels[:, pair_of(self.settings, "contact")]
        self._spool.add(settled, shown, len(self.logs))

    def _grown(self, log: _OpenLog, until_ns: int) -> bool:
        """Whether there are enough new cluster-points to cluster again."""
        last = self._known.clustered.ids.size
        grown = int(self.meta_points.is_cluster_point.sum()) - last
        waited = log.clustered_ns is None or until_ns - log.clustered_ns >= NS_PER_S
        return waited and grown > 0 and grown >= min(_GROWN_BY, _GROWN_SHARE * last)
