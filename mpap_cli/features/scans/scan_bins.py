"""Where the bins of a scan lie: by angle over the field of view (section 5.2).

The paper has 180 beams in 6 x 30 or 12 x 15. Other scanners have other numbers, look all
round, turn the other way or start anywhere; so bins are cut by angle, which gives the
paper's bins for the paper's scanner.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mpap_cli.observations import (
    BoolArray,
    Float32Array,
    Float64Array,
    IntArray,
    ScanGeometry,
)
from mpap_cli.params import ScanParams

# A beam that misses an edge by less than this share of an increment lies on it: messages
# carry angles as float32.
EDGE_TOLERANCE = 1e-3
WHOLE_SCAN_DEGREES = 200.0
_TURN = 2 * math.pi
_MIN_BEAMS = 2
# No scanner is finer or coarser, or begins some turns off: such a message is broken.
_FINEST, _COARSEST = 1e-6, math.pi / 2
_FARTHEST_ANGLE = 8 * math.pi


@dataclass(frozen=True, slots=True, eq=False)
class BinLayout:
    """Which beams of one geometry lie in which bin.

    ``runs`` (bins + 1, 2) int64: bin j holds the beams runs[j, 0] up to before runs[j, 1]
    in the order of their angles, where beam k + n_turn is beam k again; the last run is
    not a bin but the beams within 90 degrees of forward. An empty run: the bin lies
    outside the field of the scanner. ``n_turn`` beams make the turn; those behind close
    the circle and fall out. ``stretch`` (n_turn,) float32: a range in front counts once,
    one straight behind ``rear_stretch`` times, in between by the cosine. ``clockwise``:
    beams are counted from the last one, since the scanner turns clockwise. ``usable``: no
    bin inside the field has fewer than two beams.
    """

    runs: IntArray
    stretch: Float32Array
    clockwise: bool
    usable: bool

    @property
    def n_turn(self) -> int:
        """Number of beams that make the turn."""
        return self.stretch.size

    @property
    def n_outside(self) -> int:
        """Number of bins that lie outside the field of the scanner."""
        return int(np.sum(self.runs[:-1, 0] == self.runs[:-1, 1]))


@lru_cache(maxsize=256)
def lay_out_bins(geometry: ScanGeometry, forward_rad: float, params: ScanParams) -> BinLayout:
    """Assign the beams of a geometry to bins.

    Parameters
    ----------
    geometry : ScanGeometry
        Angles in the frame of the scanner; a negative increment is allowed.
    forward_rad : float
        Direction of travel in that frame.
    params : ScanParams
        ``bins``, ``fov``, ``feature`` and ``rear_stretch``.

    Returns
    -------
    BinLayout
        ``usable`` is False where a bin that should hold beams has fewer than two.

    Notes
    -----
    Bin j holds the beams with FROM + j W / b <= a < FROM + (j + 1) W / b, where forward is
    turned to 0. Profile fields of view: all round from straight behind for inverse-min,
    so that sector 0 begins at -180 degrees; the paper's features see 180 degrees about
    forward, or the whole scan where that is at most 200 degrees wide.

    A bin that reaches out of the field of the scanner and holds fewer than two beams counts
    as outside: it reads "no return" in every scan, so that the number of dimensions does
    not depend on the scanner. A bin with fewer than two beams anywhere else, or a scanner
    that sees nothing of the field of view, makes the scan unusable.

    Examples
    --------
    >>> geometry = ScanGeometry(181, -math.pi / 2, math.pi / 180, 0.05, 8.0)
    >>> lay_out_bins(geometry, 0.0, ScanParams(feature="global-diff", bins=6)).runs[:2].tolist()
    [[0, 30], [30, 60]]
    """
    increment = abs(geometry.angle_increment)
    clockwise = geometry.angle_increment < 0
    sound = geometry.n_beams >= _MIN_BEAMS and _FINEST <= increment <= _COARSEST
    if not sound or not abs(geometry.angle_min) <= _FARTHEST_ANGLE:
        nothing = np.zeros((params.bins + 1, 2), np.int64)
        return BinLayout(nothing, np.empty(0, np.float32), clockwise, usable=False)
    tolerance = EDGE_TOLERANCE * increment
    angles = _rising_angles(geometry) - forward_rad
    n_turn = int(np.sum(angles - angles[0] < _TURN - tolerance))
    start, width = _field_of_view(angles, increment, params)
    edges = np.arange(params.bins + 1, dtype=np.float64) * (width / params.bins)
    runs = _runs_between(angles[:n_turn] - start, edges - tolerance, tolerance)
    ahead = _runs_between(
        angles[:n_turn] + math.pi / 2,
        np.array([0.0, math.pi + 2 * tolerance]) - tolerance,
        tolerance,
    )
    few = runs[:, 1] - runs[:, 0] < _MIN_BEAMS
    reaching_out = _reach_out(angles[:n_turn] - start, increment, edges)
    runs[few & reaching_out] = 0
    usable = not np.any(few & ~reaching_out) and not np.all(few)
    behind = (1.0 - np.cos(angles[:n_turn])) / 2
    stretch = (1.0 + (params.rear_stretch - 1.0) * behind).astype(np.float32)
    return BinLayout(np.concatenate([runs, ahead]), stretch, clockwise, usable=bool(usable))


def beam_bearings(geometry: ScanGeometry, forward_rad: float) -> Float32Array:
    """Return the direction of every beam (n_beams,) against forward, in [-pi, pi).

    >>> beam_bearings(ScanGeometry(2, 0.0, 1.0, 0.05, 8.0), math.pi).round(2).tolist()
    [-3.140000104904175, -2.140000104904175]
    """
    angles = geometry.angle_min + geometry.angle_increment * np.arange(geometry.n_beams)
    return np.asarray((angles - forward_rad + math.pi) % _TURN - math.pi, np.float32)


def _rising_angles(geometry: ScanGeometry) -> Float64Array:
    """Return the angles of the beams, counted from the last one if the scanner turns clockwise."""
    steps = np.arange(geometry.n_beams, dtype=np.float64)
    angles = geometry.angle_min + geometry.angle_increment * steps
    return angles if geometry.angle_increment > 0 else angles[::-1]


def _field_of_view(
    angles: Float64Array, increment: float, params: ScanParams
) -> tuple[float, float]:
    """Return FROM (radians against forward) and the width W."""
    chosen = params.fov_degrees()
    if chosen is not None:
        return math.radians(chosen[0]), math.radians(chosen[1] - chosen[0])
    if params.feature == "inverse-min":
        return -math.pi, _TURN
    # Scanners with an odd number of beams count both ends of their field: the last falls out.
    whole = increment * (angles.size - angles.size % 2)
    if whole <= math.radians(WHOLE_SCAN_DEGREES) + EDGE_TOLERANCE * increment:
        return float(angles[0]), whole
    return -math.pi / 2, math.pi


def _runs_between(offsets: Float64Array, edges: Float64Array, tolerance: float) -> IntArray:
    """Return the run of beams between each two edges, from angles against the first edge."""
    turned = (offsets + tolerance) % _TURN - tolerance
    first = int(np.argmin(turned))
    borders = first + np.searchsorted(np.roll(turned, -first), edges, side="left")
    return np.stack([borders[:-1], borders[1:]], axis=1).astype(np.int64)


def _reach_out(offsets: Float64Array, increment: float, edges: Float64Array) -> BoolArray:
    """Tell which bins overlap the gap where the scanner does not look."""
    gap = _TURN - increment * offsets.size
    gap_start = (offsets[-1] + increment / 2) % _TURN
    low, high = edges[:-1], edges[1:]
    tolerance = EDGE_TOLERANCE * increment
    overlaps = np.zeros(low.size, np.bool_)
    for turn in (0.0, _TURN):
        begin, end = gap_start - turn, gap_start - turn + gap
        overlaps |= np.minimum(high, end) - np.maximum(low, begin) > tolerance
    return overlaps
