"""Where the robot was, out of nav_msgs/Odometry."""

from collections import Counter
from typing import NamedTuple

import numpy as np

from mpap_cli.logs.cursor import Cursor
from mpap_cli.logs.fields import LOCATED, TimeSource
from mpap_cli.logs.layouts import gather, header_stamps, locate_alike
from mpap_cli.logs.raw import RawRun
from mpap_cli.observations import BoolArray, Float64Array, IntArray

ODOMETRY_TYPE = "nav_msgs/msg/Odometry"
_WHAT = "a pose"
_NO_POSE = "a pose that is not finite or has no direction"
_N_NUMBERS = 7  # x, y, z of the position; x, y, z, w of the rotation


class PosePiece(NamedTuple):
    """Poses in log time order.

    ``recorded_ns`` (n,) is log time, ``stamps_ns`` (n,) the time wanted; ``poses`` (n, 3) are
    x and y in metres and the heading in radians.
    """

    recorded_ns: IntArray
    stamps_ns: IntArray
    poses: Float64Array

    def rows(self, rows: IntArray | BoolArray | slice) -> "PosePiece":
        """Return some of the poses."""
        return PosePiece(self.recorded_ns[rows], self.stamps_ns[rows], self.poses[rows])


class PoseLayout(NamedTuple):
    """Where position and rotation lie in the payload, and in which byte order."""

    place: int
    dtype: np.dtype[np.float64]
    header_ns: int

    @property
    def n_bytes(self) -> int:
        """Size of position and rotation."""
        return _N_NUMBERS * self.dtype.itemsize


def locate_pose(payload: bytes, encoding: str) -> PoseLayout:
    """Tell where the pose of a nav_msgs/Odometry lies.

    Raises
    ------
    FieldError
        If the payload is cut short or no plain CDR.
    """
    at = Cursor(memoryview(payload), encoding, _WHAT)
    header_ns = at.stamp_ns()
    at.sequence()  # frame_id
    at.sequence()  # child_frame_id
    return PoseLayout(*at.doubles(_N_NUMBERS), header_ns)


def read_poses(run: RawRun, time_source: TimeSource = "log") -> tuple[PosePiece, Counter[str]]:
    """Read stamps, places and headings of odometry.

    Parameters
    ----------
    run : RawRun
        Of nav_msgs/Odometry, ``cdr`` or ``ros1``.
    time_source : {"log", "header"}
        Which stamps are wanted.

    Returns
    -------
    PosePiece
        In log time order.
    Counter of str
        Messages left out, by reason: malformed, not finite, a rotation of length 0.

    Notes
    -----
    The heading is that of the x axis in the plane; the length of the quaternion does not
    matter.
    """
    if run.topic.encoding not in LOCATED:
        none = np.empty(0, np.int64)
        reason = f"{_WHAT} in encoding {run.topic.encoding or 'unknown'}"
        return PosePiece(none, none, np.empty((0, 3))), Counter({reason: len(run)})
    kinds, layouts, skipped = locate_alike(run, locate_pose)
    run, kinds = run.rows(np.flatnonzero(kinds >= 0)), kinds[kinds >= 0]
    stamps_ns = header_stamps(run)[0] if time_source == "header" else run.stamps_ns
    numbers = np.empty((len(run), _N_NUMBERS))
    for kind, layout in enumerate(layouts):
        places = run.starts[kinds == kind] + layout.place
        numbers[kinds == kind] = gather(run.records, places, layout.n_bytes).view(layout.dtype)
    poses, whole = _poses(numbers)
    if n_left_out := int(np.count_nonzero(~whole)):
        skipped[_NO_POSE] += n_left_out
    return PosePiece(run.stamps_ns, stamps_ns, poses).rows(whole), skipped


def _poses(numbers: Float64Array) -> tuple[Float64Array, BoolArray]:
    """Turn positions and quaternions into places and headings; tell which are whole."""
    x, y, z, w = numbers[:, 3:].T
    with np.errstate(over="ignore", invalid="ignore"):
        sine, cosine = 2 * (w * z + x * y), w * w + x * x - y * y - z * z
        headings = np.arctan2(sine, cosine)
    finite = np.isfinite([*numbers[:, :2].T, sine, cosine]).all(axis=0)
    whole: BoolArray = finite & ((sine != 0) | (cosine != 0))
    return np.column_stack([numbers[:, :2], headings]), whole
