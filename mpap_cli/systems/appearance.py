"""Learning what surroundings look like, and which of it is an obstacle (section 4.2)."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.errors import ModelError
from mpap_cli.features.images.patch_features import PatchEmbedder
from mpap_cli.observations import (
    Batch,
    BoolArray,
    Bump,
    Float64Array,
    Frame,
    IntArray,
    PatchBlock,
    PoseBlock,
    Press,
)
from mpap_cli.params import Settings
from mpap_cli.properties.labels import NO_LABEL
from mpap_cli.properties.patch_queue import PatchQueue, SettledPatches
from mpap_cli.properties.visits import VisitSpool
from mpap_cli.systems.appearance_parts import AppearanceParts, new_parts, unpack
from mpap_cli.systems.appearance_reading import LearntAppearance
from mpap_cli.systems.labelling import LogLabeller, LogStart
from mpap_cli.systems.model_parts import ModelState


@dataclass(frozen=True, slots=True, eq=False)
class LearntPatches:
    """Patches of n images that were taken in; arrays of shape (n, n_patches).

    ``ids`` are those of what took them in; ``outlier`` tells which fitted no long-term
    cluster on arrival, ``distance`` goes to the nearest long-term exemplar, inf if there
    was none.
    """

    block: PatchBlock
    ids: IntArray
    outlier: BoolArray
    distance: Float64Array


@dataclass(slots=True)
class _OpenLog:
    """The log that is being replayed."""

    start: LogStart
    queue: PatchQueue
    labeller: LogLabeller[SettledPatches]
    n_images: int = 0


class AppearanceModel(LearntAppearance):
    """Clusters of image patches with the probability that each is an obstacle.

    Parameters
    ----------
    settings : Settings
        Everything that can change the result.
    parts : AppearanceParts, optional
        What an older model knows (it is learnt on, not copied); its settings count.

    Notes
    -----
    A log is ``begin_log``, then any number of ``observe``, then ``end_log``. ``observe`` is
    ``embed``, ``learn`` and ``settle``; ``embed`` touches nothing that the others use, so
    that it may run ahead in another thread. Clustering never waits for labels, and labels
    never enter it.
    """

    def __init__(self, settings: Settings, parts: AppearanceParts | None = None) -> None:
        self._embedder = PatchEmbedder((settings if parts is None else parts.settings).image)
        super().__init__(new_parts(settings, self._embedder.n_dims) if parts is None else parts)
        self._log: _OpenLog | None = None
        self._n_labels = Counter[str]()

    @property
    def n_labels(self) -> Counter[str]:
        """How many patches of the last log were labelled ``free`` and ``obstacle``."""
        return self._n_labels

    @property
    def skipped(self) -> Counter[str]:
        """Images of the last log that were left out, by reason."""
        return self._embedder.skipped

    @property
    def changes(self) -> Counter[str]:
        """What changed between images of the last log, and how often."""
        return self._embedder.changes

    def begin_log(self, start: LogStart) -> None:
        """Start to replay a log; labels do not look back beyond it."""
        self._embedder.for_log()
        queue = PatchQueue(self.settings.obstacle, self.settings.bumper, self.shape)
        self._log = _OpenLog(start, queue, LogLabeller(start, self.settings.bumper, queue))
        self._n_labels = Counter()

    def observe(self, batch: Batch) -> LearntPatches:
        """Take in what the log holds up to ``batch.until_ns``."""
        learnt = self.learn(self.embed(batch.frames))
        self.settle(batch.bumps, batch.poses, batch.until_ns)
        return learnt

    def embed(self, frames: Sequence[Frame], jobs: int = 1) -> PatchBlock:
        """Turn images into features of their patches (section 4.2.2), in so many threads."""
        return self._embedder.transform(frames, jobs)

    def learn(self, block: PatchBlock) -> LearntPatches:
        """Add patches to the clusters (Algorithm 2); their labels come later."""
        log = self._opened()
        n_images = block.stamps_ns.size
        added = self.two_scale.add_observations(
            block.features.reshape(n_images * self.n_patches, self.two_scale.n_dims),
            np.repeat(block.stamps_ns, self.n_patches),
            np.tile(np.arange(self.n_patches), n_images),
            len(self.logs),
        )
        shape = n_images, self.n_patches
        ids = added.ids.reshape(shape)
        log.queue.add(block.stamps_ns, ids)
        log.n_images += n_images
        return LearntPatches(
            block, ids, added.outlier.reshape(shape), added.distances.reshape(shape)
        )

    def settle(self, bumps: Sequence[Bump], poses: PoseBlock | None, until_ns: int) -> None:
        """Take in bumps and odometry up to ``until_ns``; count the labels settled by them."""
        log = self._opened()
        if poses is not None:
            log.queue.add_poses(poses)
        self._count(log.labeller.settle(bumps, until_ns))

    def end_log(self, end_ns: int) -> tuple[Press, ...] | None:
        """Count the labels that still wait.

        Parameters
        ----------
        end_ns : int
            Stamp of the log's last message.

        Returns
        -------
        tuple of Press or None
            The presses of the log; None if it has no bumper.

        Notes
        -----
        If the outliers have not been enough for long-term clusters yet, they are made now.
        """
        log = self._opened()
        self._count(log.labeller.end(end_ns))
        presses = log.labeller.presses
        source = log.start.source(end_ns, log.n_images, presses)
        self._known = replace(self._known, logs=(*self.logs, source))
        self._log = None
        if not self.two_scale.n_clusters and self.two_scale.n_reservoir:
            self.two_scale.rebuild()
        return presses

    def finish(self) -> None:
        """Sum up the visits; the temporary file that they were counted from goes."""
        self._known = self.parts()
        self._spool.close()
        self._spool = VisitSpool()

    @classmethod
    def from_state(cls, state: ModelState) -> "AppearanceModel":
        """Build the model again; ModelError if the state is damaged or of another version."""
        parts = unpack(state)
        model = cls(parts.settings, parts)
        n_dims, found = model._embedder.n_dims, parts.two_scale.n_dims
        if found != n_dims:
            sizes = f"exemplars of {found} dimensions, its settings make {n_dims}"
            msg = f"model: found {sizes}; learn it again"
            raise ModelError(msg)
        return model

    def _opened(self) -> _OpenLog:
        if self._log is None:
            msg = "no log is open: begin_log comes first"
            raise RuntimeError(msg)
        return self._log

    def _count(self, settled: SettledPatches) -> None:
        """Count settled labels on the clusters, and keep them for the visits."""
        labelled = settled.labels != NO_LABEL
        positive = settled.labels[labelled] == 1
        self.two_scale.add_labels(settled.ids[labelled], positive)
        n_positive = int(positive.sum())
        self._n_labels.update(free=positive.size - n_positive, obstacle=n_positive)
        sightings, labels = settled.sightings()
        self._spool.add(sightings, labels, len(self.logs))
