"""Images that wait until the presses and the odometry around them are known (4.2.3)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import (
    NS_PER_S,
    BoolArray,
    Float64Array,
    Int8Array,
    IntArray,
    PoseBlock,
    Press,
)
from mpap_cli.params import BumperParams, ObstacleParams
from mpap_cli.params.checks import require
from mpap_cli.properties.counts import SHORTEST_WAIT_S
from mpap_cli.properties.driven import OLDEST_POSE_NS, driven_ahead
from mpap_cli.properties.obstacle_labels import label_patches, pressed_images
from mpap_cli.properties.visits import VISIT_GAP_NS, Sightings

_SPARE_S = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class SettledPatches:
    """Patches of images of one log whose labels do not change any more.

    ``stamps_ns`` and ``press_ns`` (start of the press that an image is of, else -1) have
    shape (n,); ``ids`` (of what took the patches in) and ``labels`` (int8: 1, 0, -1) have
    shape (n, n_patches).
    """

    stamps_ns: IntArray
    ids: IntArray
    labels: Int8Array
    press_ns: IntArray

    def sightings(self) -> tuple[Sightings, Int8Array]:
        """Return what the visits are counted from, and its labels.

        Returns
        -------
        tuple of Sightings and ndarray of shape (m,)
            In time order. Of the patches with one id, label and press the first and the
            last in each two seconds: no gap between them grows to that of a visit.
        """
        n_patches = self.ids.shape[1]
        stamps_ns = np.repeat(self.stamps_ns, n_patches)
        press_ns = np.repeat(self.press_ns, n_patches)
        ids, labels = self.ids.ravel(), self.labels.ravel()
        keys = (stamps_ns // VISIT_GAP_NS, press_ns, labels, ids)
        order = np.lexsort((stamps_ns, *keys))
        changes = np.zeros(max(0, order.size - 1), dtype=np.bool_)
        for key in keys:
            changes |= np.diff(key[order]) != 0
        kept = order[np.append(True, changes) | np.append(changes, True)] if order.size else order
        kept = kept[np.argsort(stamps_ns[kept], kind="stable")]
        return Sightings(stamps_ns[kept], ids[kept], press_ns[kept]), labels[kept]


class PatchQueue:
    """Images that wait until the presses and the odometry around them are known.

    As with scans, clustering never waits for labels. The wait is the longest of 5 s and of
    what the labels look ahead (or ``bump_merge``) plus 1 s of log time, so what waits is
    bounded.

    Parameters
    ----------
    params : ObstacleParams
        How patches are labelled.
    bumper : BumperParams
        ``bump_merge``.
    shape : tuple of int
        Rows and columns of patches.

    Raises
    ------
    SettingError
        If rows are to be labelled that there are not.
    """

    def __init__(
        self, params: ObstacleParams, bumper: BumperParams, shape: tuple[int, int]
    ) -> None:
        rows, columns = shape
        _, last = params.labelled_rows() or (0, rows)
        require(last <= rows, "label-rows", params.label_rows, f"rows of the grid, 0:{rows}")
        ahead_s = max(params.driven_before_s, params.bump_image_s, bumper.bump_merge)
        self._params = params
        self._shape = shape
        self._wait_ns = round(max(SHORTEST_WAIT_S, ahead_s + _SPARE_S) * NS_PER_S)
        self._stamps_ns = np.empty(0, dtype=np.int64)
        self._ids = np.empty((0, rows * columns), dtype=np.int64)
        self._poses: PoseBlock | None = None
        # The image that was let go last may be nearer to a press than those that wait; it
        # also stands for the farthest that the robot has got ahead after one.
        self._gone_ns = np.empty(0, dtype=np.int64)
        self._farthest_m = 0.0

    def __len__(self) -> int:
        return self._stamps_ns.size

    def add(self, stamps_ns: IntArray, ids: IntArray) -> None:
        """Let images wait: arrays of shape (n,) and (n, n_patches), in time order."""
        self._stamps_ns = np.concatenate([self._stamps_ns, stamps_ns])
        self._ids = np.concatenate([self._ids, ids])

    def add_poses(self, poses: PoseBlock) -> None:
        """Take in the odometry that follows what came before."""
        if self._poses is None:
            self._poses = poses
            return
        before = self._poses
        self._poses = PoseBlock(
            np.concatenate([before.stamps_ns, poses.stamps_ns]),
            np.concatenate([before.poses, poses.poses]),
        )

    @property
    def needs_presses_from_ns(self) -> int | None:
        """Presses that end at or before this stamp no longer matter (None: nothing waits)."""
        if not len(self):
            return None
        back_s = max(self._params.driven_after_s, self._params.bump_image_s)
        return int(self._stamps_ns.min()) - round(back_s * NS_PER_S)

    def settle(self, presses: Sequence[Press], until_ns: int) -> SettledPatches:
        """Label and let go the images made long enough before ``until_ns``.

        Parameters
        ----------
        presses : sequence of Press
            Those known up to ``until_ns``, at least from :attr:`needs_presses_from_ns` on.
        until_ns : int
            No bump, image or pose stamped at or before is still to come.

        Returns
        -------
        SettledPatches
            In the order in which the images were added.
        """
        settled = self._label(presses, self._stamps_ns <= until_ns - self._wait_ns)
        oldest_ns = int(self._stamps_ns.min()) if len(self) else until_ns
        self._forget_poses(oldest_ns - OLDEST_POSE_NS)
        return settled

    def end(self, presses: Sequence[Press]) -> SettledPatches:
        """Label and let go everything at the end of the log, or where labels do not matter."""
        settled = self._label(presses, np.ones(len(self), dtype=np.bool_))
        self._poses = None
        return settled

    def _label(self, presses: Sequence[Press], ripe: BoolArray) -> SettledPatches:
        """Label the images marked as ripe; the others go on waiting."""
        n_gone = self._gone_ns.size
        stamps_ns = np.concatenate([self._gone_ns, self._stamps_ns])
        driven_m = self._driven_m(stamps_ns)
        labels = label_patches(stamps_ns, presses, self._params, self._shape, driven_m)
        press_ns = pressed_images(stamps_ns, presses, self._params.bump_image_s)
        settled = SettledPatches(
            self._stamps_ns[ripe], self._ids[ripe], labels[n_gone:][ripe], press_ns[n_gone:][ripe]
        )
        if driven_m is not None:
            gone = np.concatenate([np.ones(n_gone, dtype=np.bool_), ripe])
            self._farthest_m = float(np.nanmax(driven_m[gone], initial=self._farthest_m))
        self._stamps_ns, self._ids = self._stamps_ns[~ripe], self._ids[~ripe]
        self._gone_ns = np.append(self._gone_ns, settled.stamps_ns)[-1:]
        return settled

    def _driven_m(self, stamps_ns: IntArray) -> Float64Array | None:
        """Return how far the robot gets ahead; None without odometry."""
        if self._poses is None:
            return None
        driven_m = driven_ahead(stamps_ns, self._poses, self._params.driven_before_s)
        driven_m[: self._gone_ns.size] = self._farthest_m
        return driven_m

    def _forget_poses(self, before_ns: int) -> None:
        """Let go of odometry from before a stamp."""
        if self._poses is not None:
            kept = slice(int(np.searchsorted(self._poses.stamps_ns, before_ns)), None)
            self._poses = PoseBlock(
                self._poses.stamps_ns[kept].copy(), self._poses.poses[kept].copy()
            )
