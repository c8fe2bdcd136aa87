"""Straight ahead in the frame of the scanner, from the transforms in the log."""

import logging
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

from mpap_cli.logs.raw import LogReader, PayloadError

_LOG = logging.getLogger(__name__)

TF_TYPES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
BASE_FRAMES = ("base_link", "base_footprint")
WORLD_FRAMES = ("odom", "map", "world", "earth")
_MOST_MESSAGES = 2000
_ENOUGH_MESSAGES = 100
_SAME_DIRECTION_RAD = math.radians(1.0)
_LEVEL = 0.5  # a scanner tilted so far that ahead lies 60 degrees off its plane has no ahead

Rotation = tuple[float, float, float, float]
Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class _Transform:
    """How a frame is turned against its parent."""

    parent: str
    rotation: Rotation  # x, y, z, w


def find_forward(reader: LogReader, frame_id: str) -> float | None:
    """Find the direction of the robot's x axis in the frame of the scanner.

    Parameters
    ----------
    reader : LogReader
        An open log; the first transforms of its tf topics are read.
    frame_id : str
        Frame of the scans.

    Returns
    -------
    float or None
        Angle of a beam that looks straight ahead, in radians within (-pi, pi]; None if no
        chain of transforms leads from the scanner to base_link, base_footprint or the
        last frame below odom, map or world.

    Notes
    -----
    The first rotation found for a frame holds. Where later static ones turn it another
    way, one warning says so.
    """
    frame = _plain(frame_id)
    if is_base(frame):
        return 0.0
    first: dict[str, _Transform] = {}
    last: dict[str, _Transform] = {}
    for count, found in enumerate(_read_transforms(reader), start=1):
        last.update(found)
        first.update({child: found[child] for child in found.keys() - first.keys()})
        chain = _chain(first, frame)
        if count >= _ENOUGH_MESSAGES and chain and is_base(chain[-1].parent):
            break
    forward = _forward(_chain(first, frame))
    later = _forward(_chain(last, frame))
    if forward is not None and later is not None and _apart(forward, later) > _SAME_DIRECTION_RAD:
        _LOG.warning(
            "%s: the transforms turn %s in several ways; the first is taken, %.0f degrees",
            reader.path.name,
            frame,
            math.degrees(forward),
        )
    return forward


def is_base(frame: str) -> bool:
    """Tell whether a frame is the robot's own, whose x axis looks straight ahead."""
    return _base_name(frame) in BASE_FRAMES


def _read_transforms(reader: LogReader) -> Iterator[dict[str, _Transform]]:
    """Yield the transforms of each of the first messages, by child frame."""
    topics = {
        topic.name: topic.n_messages
        for topic in reader.topics
        if topic.msgtype in TF_TYPES and topic.encoding in {"cdr", "ros1"}
    }
    total = min(sum(topics.values()), _MOST_MESSAGES)
    if not total:
        return
    for message in islice(reader.messages(topics.keys()), total):
        try:
            found = _transforms_in(reader.decode(message))
        except (PayloadError, AttributeError, TypeError, ValueError):
            continue  # cut short, or defined by the log in another way
        yield found


def _transforms_in(decoded: Any) -> dict[str, _Transform]:
    """Return the transforms of a message by child frame."""
    return {
        _plain(item.child_frame_id): _Transform(_plain(item.header.frame_id), rotation)
        for item in decoded.transforms
        if (rotation := _unit(item.transform.rotation)) is not None
    }


def _chain(known: Mapping[str, _Transform], frame: str) -> list[_Transform]:
    """Collect the transforms from a frame up to the base of the robot."""
    chain: list[_Transform] = []
    seen = {frame}
    while frame in known and not is_base(frame):
        transform = known[frame]
        if _base_name(transform.parent) in WORLD_FRAMES or transform.parent in seen:
            break
        chain.append(transform)
        frame = transform.parent
        seen.add(frame)
    return chain


def _forward(chain: list[_Transform]) -> float | None:
    """Turn the robot's x axis down the chain into an angle in the plane of the scanner."""
    if not chain:
        return None
    ahead: Vector = (1.0, 0.0, 0.0)
    for transform in reversed(chain):
        ahead = _turned_back(transform.rotation, ahead)
    if math.hypot(ahead[0], ahead[1]) < _LEVEL:
        return None
    forward = math.atan2(ahead[1], ahead[0])
    return math.pi if forward <= -math.pi else forward


def _turned_back(rotation: Rotation, vector: Vector) -> Vector:
    """Apply the inverse of a rotation: v + 2 q x (q x v - w v)."""
    x, y, z, w = rotation
    inner = _minus(_cross((x, y, z), vector), (w * vector[0], w * vector[1], w * vector[2]))
    outer = _cross((x, y, z), inner)
    return (vector[0] + 2 * outer[0], vector[1] + 2 * outer[1], vector[2] + 2 * outer[2])


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _unit(quaternion: Any) -> Rotation | None:
    """Return a quaternion of length 1; None if it has no direction."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if not length > 0 or not math.isfinite(length):
        return None
    return (x / length, y / length, z / length, w / length)


def _apart(a: float, b: float) -> float:
    """Return the smaller angle between two directions."""
    return abs(math.remainder(a - b, math.tau))


def _plain(frame_id: str) -> str:
    """Drop the slash that old drivers put before a frame."""
    return frame_id.lstrip("/")


def _base_name(frame: str) -> str:
    """Drop the name of the robot before a frame."""
    return frame.rpartition("/")[2]
