"""What a map of one log is drawn from: the way of the robot and what the laser met (Fig. 12)."""

import numpy as np

from mpap_cli.evaluation.driving import returned_ranges
from mpap_cli.features.scans.scan_bins import beam_bearings
from mpap_cli.observations import (
    NS_PER_S,
    Float64Array,
    IntArray,
    PoseBlock,
    ScanBlock,
)
from mpap_cli.params import ScanParams

MOST_POSES = 20_000
MOST_CELLS = 200_000
# A turn of one radian counts as a way of so many metres.
_TURN_M = 0.3
_STEP_M = 0.02
_CELL_M = 0.04
_SCAN_NS = NS_PER_S // 2
_NEAR_NS = NS_PER_S // 5
_FARTHEST_M = 1e7
_CODE = 2**32


class MapSketch:
    """Way of the robot and laser returns of one log, in the frame of its odometry.

    A pose is kept for every step of 2 cm or so, returns as the cells of a grid of 4 cm
    that they fall into, from two scans a second. Of a long log both grow coarser, so that
    memory stays bounded. The scanner is taken to sit in the middle of the robot.

    Parameters
    ----------
    params : ScanParams
        How ranges are cleaned.
    forward_rad : float
        Direction of travel in the frame of the scanner.
    range_max : float, optional
        Metres, instead of an unusable ``range_max`` of the scans.

    Examples
    --------
    >>> sketch = MapSketch(ScanParams(), 0.0)
    >>> poses = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    >>> sketch.add_poses(PoseBlock(np.array([0, NS_PER_S]), poses))
    >>> sketch.places(np.array([NS_PER_S // 4])).tolist()
    [[0.25, 0.0, 0.0]]
    """

    def __init__(
        self, params: ScanParams, forward_rad: float, range_max: float | None = None
    ) -> None:
        self._params = params
        self._forward_rad = forward_rad
        self._range_max = range_max
        self._step_m = _STEP_M
        self._cell_m = _CELL_M
        self._stamps_ns = np.zeros(0, np.int64)
        self._poses = np.zeros((0, 3))
        self._way_m = 0.0
        self._recent = PoseBlock(np.zeros(0, np.int64), np.zeros((0, 3)))
        self._last_slot = -1
        self._codes = np.zeros(0, np.int64)
        self._fresh: list[IntArray] = []
        self._n_fresh = 0

    @property
    def way(self) -> Float64Array:
        """Poses (n, 3) along the way: x, y, heading."""
        return self._poses.copy()

    @property
    def returns(self) -> Float64Array:
        """Places (m, 2) in metres at which the laser met something."""
        self._gather()
        return self._decoded()

    def add_poses(self, block: PoseBlock) -> None:
        """Add the next poses of the log."""
        if not block.stamps_ns.size:
            return
        poses, is_first = block.poses, not self._poses.size
        before = poses[:1] if is_first else self._recent.poses[-1:]
        steps = np.diff(poses, axis=0, prepend=before)
        turns = np.abs(np.remainder(steps[:, 2] + np.pi, 2 * np.pi) - np.pi)
        ways_m = self._way_m + np.cumsum(np.hypot(steps[:, 0], steps[:, 1]) + _TURN_M * turns)
        kept = np.diff(np.floor(np.concatenate(([self._way_m], ways_m)) / self._step_m)) > 0
        kept[0] |= is_first
        self._stamps_ns = np.concatenate((self._stamps_ns, block.stamps_ns[kept]))
        self._poses = np.concatenate((self._poses, poses[kept]))
        self._way_m = float(ways_m[-1])
        last = self._recent
        self._recent = PoseBlock(
            np.concatenate((last.stamps_ns[-1:], block.stamps_ns)),
            np.concatenate((last.poses[-1:], poses)),
        )
        while self._stamps_ns.size > MOST_POSES:
            self._stamps_ns, self._poses = self._stamps_ns[::2], self._poses[::2]
            self._step_m *= 2

    def places(self, stamps_ns: IntArray) -> Float64Array:
        """Return where the robot was.

        Parameters
        ----------
        stamps_ns : ndarray of shape (n,)
            Moments of the log.

        Returns
        -------
        ndarray of shape (n, 3)
            x, y, heading; NaN more than 0.2 s before the first or after the last pose.
        """
        last = self._recent
        known_ns = np.concatenate((self._stamps_ns, last.stamps_ns[-1:]))
        return _interpolate(stamps_ns, known_ns, np.concatenate((self._poses, last.poses[-1:])))

    def add_scans(self, block: ScanBlock) -> None:
        """Add the next scans of the log; their poses must have been added before.

        Raises
        ------
        UsageError
            If there is no usable maximum range.
        """
        slots = block.stamps_ns // _SCAN_NS
        chosen = np.diff(slots, prepend=self._last_slot) > 0
        self._last_slot = int(slots[-1]) if slots.size else self._last_slot
        part = ScanBlock(block.stamps_ns[chosen], block.ranges[chosen], block.geometry)
        # the way is too coarse for the heading of a beam
        places = _interpolate(part.stamps_ns, self._recent.stamps_ns, self._recent.poses)
        ranges = returned_ranges(part, self._params, self._range_max)
        angles = places[:, 2:] + beam_bearings(block.geometry, self._forward_rad)
        x = places[:, :1] + ranges * np.cos(angles)
        y = places[:, 1:2] + ranges * np.sin(angles)
        good = np.maximum(np.abs(x), np.abs(y)) < _FARTHEST_M
        self._fresh.append(_coded(np.stack((x[good], y[good]), axis=1) / self._cell_m))
        self._n_fresh += self._fresh[-1].size
        if self._n_fresh > MOST_CELLS:
            self._gather()

    def _gather(self) -> None:
        """Bring the returns together; cells grow if there are too many."""
        self._codes = np.unique(np.concatenate((self._codes, *self._fresh)))
        self._fresh, self._n_fresh = [], 0
        while self._codes.size > MOST_CELLS:
            places = self._decoded()
            self._cell_m *= 2
            self._codes = _coded(places / self._cell_m)

    def _decoded(self) -> Float64Array:
        """Return the places (m, 2) of the cells."""
        x, y = self._codes // _CODE, self._codes % _CODE - _CODE // 2
        return np.stack((x, y), axis=1).astype(np.float64) * self._cell_m


def _coded(cells: Float64Array) -> IntArray:
    """Turn places (m, 2), in cells, into one number for each cell."""
    x, y = np.rint(cells).astype(np.int64).T
    return np.unique(x * _CODE + y + _CODE // 2)


def _interpolate(stamps_ns: IntArray, known_ns: IntArray, poses: Float64Array) -> Float64Array:
    """Return poses (n, 3) at these moments, NaN more than 0.2 s outside of the known ones."""
    if not known_ns.size:
        return np.full((stamps_ns.size, 3), np.nan)
    turning = np.column_stack((poses[:, :2], np.unwrap(poses[:, 2])))
    at, times = stamps_ns - known_ns[0], known_ns - known_ns[0]
    found = np.stack([np.interp(at, times, column) for column in turning.T], axis=1)
    found[(at < -_NEAR_NS) | (at > times[-1] + _NEAR_NS)] = np.nan
    return found
