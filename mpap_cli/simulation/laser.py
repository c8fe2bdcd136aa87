"""A scanner that sweeps half a circle: rays against shapes, then what a real one makes of it."""

import math
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import BoolArray, Float32Array, Float64Array, IntArray
from mpap_cli.simulation.shapes import Shapes
from mpap_cli.simulation.world import World

NO_RETURN_CODES: dict[str, float] = {"above-max": 81.83, "zero": 0.0, "inf": math.inf}
"""What drivers write for a beam without return; 81.83 m is the SICK's 8183."""

_KEY_BITS = 16
_KEY_UNITS_PER_M = 1e9


@dataclass(frozen=True, slots=True, kw_only=True)
class Scanner:
    """A laser scanner and its place on the robot (base_link: x ahead, y left).

    It sweeps from 90 degrees right of straight ahead to 90 degrees left; angles in its
    messages are those of its frame, in which straight ahead is ``forward_rad``.
    """

    n_beams: int = 180
    increment_rad: float = math.pi / 180
    period_ns: int = 100_000_000
    range_min_m: float = 0.02
    range_max_m: float = 8.0
    blind_m: float = 0.35
    noise_m: float = 0.006
    decimals: int = 2
    x_m: float = -0.16
    y_m: float = 0.02
    z_m: float = 0.2
    forward_rad: float = 0.0
    no_return: str = "above-max"

    @property
    def angle_min(self) -> float:
        """Angle of the first beam in the frame of the scanner, radians."""
        return self.forward_rad - self.n_beams * self.increment_rad / 2

    def poses(self, robot_poses: Float64Array) -> Float64Array:
        """Return x, y and bearing of the first beam (n, 3) for poses of the robot (n, 3)."""
        heading = robot_poses[:, 2]
        x = robot_poses[:, 0] + self.x_m * np.cos(heading) - self.y_m * np.sin(heading)
        y = robot_poses[:, 1] + self.x_m * np.sin(heading) + self.y_m * np.cos(heading)
        first = heading - self.n_beams * self.increment_rad / 2
        return np.stack((x, y, first), axis=1)


class Laser:
    """Takes scans of a world; two generators, so that the size of a block does not matter.

    Parameters
    ----------
    world : World
        What there is to see.
    scanner : Scanner
        What sees it.
    seed : int
        Of noise and lost returns.
    """

    def __init__(self, world: World, scanner: Scanner, seed: int) -> None:
        self.world = world
        self.scanner = scanner
        self._noise = np.random.default_rng((seed, 1))
        self._luck = np.random.default_rng((seed, 2))

    def scan(self, robot_poses: Float64Array) -> Float32Array:
        """Return the ranges of one scan per pose.

        Parameters
        ----------
        robot_poses : ndarray of shape (n, 3)
            x, y, heading of the robot; metres and radians.

        Returns
        -------
        ndarray of shape (n, n_beams)
            float32, metres in steps of 1 cm (as the SICK's), or the code for no return.
        """
        scanner, world = self.scanner, self.world
        true_m, hit = cast_rays(world.shapes, scanner.poses(robot_poses), scanner)
        seen = hit >= 0
        spread = np.where(seen, world.spread_m[hit], 0.0)
        noise = self._noise.normal(size=true_m.shape)
        luck = self._luck.random(true_m.shape)
        lost = ~seen | (luck < world.dropout[hit]) | (true_m > world.reach_m[hit])
        ranges = np.where(seen, true_m, 0.0) + noise * (scanner.noise_m + spread)
        lost |= (ranges < scanner.blind_m) | (ranges > scanner.range_max_m)
        coded = np.where(
            lost, NO_RETURN_CODES[scanner.no_return], np.round(ranges, scanner.decimals)
        )
        return coded.astype(np.float32)


def cast_rays(
    shapes: Shapes, poses: Float64Array, scanner: Scanner
) -> tuple[Float64Array, IntArray]:
    """Return range and number of the first shape on each beam.

    Instead of every beam against every shape, each shape is asked once per pose which
    beams can meet it, and only those pairs are computed.

    Parameters
    ----------
    shapes : Shapes
        Fewer than 65,536 of them.
    poses : ndarray of shape (n, 3)
        x, y of the scanner and bearing of its first beam.
    scanner : Scanner
        Number and spacing of the beams; the longest range.

    Returns
    -------
    ranges : ndarray of shape (n, n_beams)
        Metres; infinite where nothing is within the longest range.
    hit : ndarray of shape (n, n_beams)
        Number of the shape; -1 where there is none.
    """
    # one integer per beam orders by range, then by shape: (range in nm) * 65536 + shape
    nothing = np.iinfo(np.int64).max
    keys = np.full(len(poses) * scanner.n_beams, nothing, np.int64)
    n_segments = len(shapes.segments)
    for first, spans, ranges_of in (
        (0, _segment_spans(shapes.segments, poses, scanner), _segment_ranges),
        (n_segments, _circle_spans(shapes.circles, poses, scanner), _circle_ranges),
    ):
        pose, shape, beam = _expand(*spans, scanner)
        bearing = poses[pose, 2] + beam * scanner.increment_rad
        table = shapes.segments if first == 0 else shapes.circles
        ranges = ranges_of(table[shape], poses[pose, :2], bearing)
        good = (ranges >= 0) & (ranges <= scanner.range_max_m)
        grid = (ranges[good] * _KEY_UNITS_PER_M).astype(np.int64) << _KEY_BITS
        np.minimum.at(keys, (pose * scanner.n_beams + beam)[good], grid | (shape[good] + first))
    shape_of_scans = (len(poses), scanner.n_beams)
    hit = np.where(keys == nothing, -1, keys & ((1 << _KEY_BITS) - 1))
    nearest = np.where(keys == nothing, math.inf, (keys >> _KEY_BITS) / _KEY_UNITS_PER_M)
    return nearest.reshape(shape_of_scans), hit.reshape(shape_of_scans)


_Spans = tuple[BoolArray, Float64Array, Float64Array]


def _segment_spans(segments: Float64Array, poses: Float64Array, scanner: Scanner) -> _Spans:
    """Return which (pose, segment) pairs are near, where their arc starts and how wide it is."""
    to_a = segments[None, :, :2] - poses[:, None, :2]
    to_b = segments[None, :, 2:] - poses[:, None, :2]
    along = segments[:, 2:] - segments[:, :2]
    share = -(to_a * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12)
    closest = to_a + np.clip(share, 0.0, 1.0)[:, :, None] * along
    near = np.hypot(closest[:, :, 0], closest[:, :, 1]) <= scanner.range_max_m
    bearing_a = np.arctan2(to_a[:, :, 1], to_a[:, :, 0])
    bearing_b = np.arctan2(to_b[:, :, 1], to_b[:, :, 0])
    turn = np.mod(bearing_b - bearing_a + math.pi, 2 * math.pi) - math.pi
    start = np.where(turn >= 0, bearing_a, bearing_b) - poses[:, None, 2]
    return near, start, np.abs(turn)


def _circle_spans(circles: Float64Array, poses: Float64Array, scanner: Scanner) -> _Spans:
    """Do the same for circles."""
    to_center = circles[None, :, :2] - poses[:, None, :2]
    gap = np.hypot(to_center[:, :, 0], to_center[:, :, 1])
    radius = circles[None, :, 2]
    half = np.arcsin(np.minimum(radius / np.maximum(gap, 1e-9), 1.0))
    bearing = np.arctan2(to_center[:, :, 1], to_center[:, :, 0])
    return gap - radius <= scanner.range_max_m, bearing - half - poses[:, None, 2], 2 * half


def _expand(
    near: BoolArray, start: Float64Array, width: Float64Array, scanner: Scanner
) -> tuple[IntArray, IntArray, IntArray]:
    """Return pose, shape and beam of every pair that may meet."""
    pose, shape = np.nonzero(near)
    begin = np.mod(start[near], 2 * math.pi) / scanner.increment_rad
    first = np.ceil(begin - 1e-9).astype(np.int64)
    last = np.floor(begin + width[near] / scanner.increment_rad + 1e-9).astype(np.int64)
    counts = np.maximum(last - first + 1, 0)
    offset = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    n_around = round(2 * math.pi / scanner.increment_rad)
    beam = (np.repeat(first, counts) + offset) % n_around
    kept = beam < scanner.n_beams
    return np.repeat(pose, counts)[kept], np.repeat(shape, counts)[kept], beam[kept]


def _segment_ranges(
    segments: Float64Array, origins: Float64Array, bearing: Float64Array
) -> Float64Array:
    """Return where beams cross the lines of segments, metres along the beam."""
    to_a = segments[:, :2] - origins
    along = segments[:, 2:] - segments[:, :2]
    across = np.cos(bearing) * along[:, 1] - np.sin(bearing) * along[:, 0]
    across = np.where(np.abs(across) < 1e-12, math.nan, across)  # noqa: PLR2004  # beam along it
    return np.asarray((to_a[:, 0] * along[:, 1] - to_a[:, 1] * along[:, 0]) / across)


def _circle_ranges(
    circles: Float64Array, origins: Float64Array, bearing: Float64Array
) -> Float64Array:
    """Return where beams enter circles, metres along the beam."""
    to_center = circles[:, :2] - origins
    ahead = to_center[:, 0] * np.cos(bearing) + to_center[:, 1] * np.sin(bearing)
    aside = to_center[:, 0] * np.sin(bearing) - to_center[:, 1] * np.cos(bearing)
    return np.asarray(ahead - np.sqrt(np.maximum(circles[:, 2] ** 2 - aside**2, 0.0)))
