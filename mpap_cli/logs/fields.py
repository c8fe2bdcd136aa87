"""Laser scans out of raw payloads, without building the whole message.

The few fields that a scan needs lie at offsets that follow from the length of the frame
name, so they are read where they are: in CDR of either byte order and in ROS 1 messages.
``foxglove.LaserScan`` is read as a whole.
"""

import math
import struct
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from mpap_cli.logs.foxglove import (
    FOXGLOVE_ENCODINGS,
    NOT_FOLLOWED,
    foxglove_fields,
    foxglove_stamp,
)
from mpap_cli.logs.raw import RawMessage, Topic
from mpap_cli.observations import NS_PER_S, Float32Array, FloatArray, ScanGeometry

TimeSource = Literal["log", "header"]
ScanFields = tuple[int, FloatArray, ScanGeometry]

# angle_min, angle_max, angle_increment, time_increment, scan_time, range_min, range_max, count
_TAIL_LITTLE = struct.Struct("<7fI")
_TAIL_BIG = struct.Struct(">7fI")
_HEAD_LITTLE = struct.Struct("<4xIII")
_HEAD_BIG = struct.Struct(">4xIII")
_FLOAT_LITTLE = np.dtype("<f4")
_FLOAT_BIG = np.dtype(">f4")
_CUT_SHORT = "a scan cut short"
CDR_BYTE_ORDERS = {0: "big", 1: "little", 6: "big", 7: "little"}


class FieldError(ValueError):
    """A payload does not hold what its type promises; the message is left out and counted."""


class ScanLayout(NamedTuple):
    """Where the ranges of a scan lie in its payload, and what stands before them."""

    place: int
    dtype: np.dtype[np.float32]
    header_ns: int
    geometry: ScanGeometry

    @property
    def n_bytes(self) -> int:
        """Size of the ranges."""
        return self.dtype.itemsize * self.geometry.n_beams


def scan_view(message: RawMessage, time_source: TimeSource = "log") -> ScanFields:
    """Read stamp, ranges and geometry of one laser scan.

    Parameters
    ----------
    message : RawMessage
        A sensor_msgs/LaserScan (``cdr`` or ``ros1``) or foxglove.LaserScan (``json``,
        ``protobuf``).
    time_source : {"log", "header"}
        Which stamp is wanted: when the message was recorded, or the one inside it.

    Returns
    -------
    stamp_ns : int
        Nanoseconds.
    ranges : ndarray of shape (n_beams,)
        Metres as recorded, in 32 bits of any byte order; where it can be, a view into the
        payload that is meant to be copied at once.
    geometry : ScanGeometry
        The same object for scans of the same geometry. foxglove.LaserScan knows neither
        range_min nor range_max: both are 0 there.

    Raises
    ------
    FieldError
        If the payload is cut short or makes no scan.
    """
    encoding, payload = message.topic.encoding, message.payload
    if encoding in LOCATED:
        place, dtype, header_ns, geometry = locate_ranges(payload, encoding)
        ranges: FloatArray = np.frombuffer(payload, dtype, geometry.n_beams, place)
    elif encoding in FOXGLOVE_ENCODINGS:
        header_ns, ranges, geometry = _scan_foxglove(payload, message.topic)
    else:
        msg = f"a scan in encoding {encoding or 'unknown'}"
        raise FieldError(msg)
    return (header_ns if time_source == "header" else message.stamp_ns), ranges, geometry


def locate_ranges(payload: bytes, encoding: str) -> ScanLayout:
    """Tell where the ranges of a sensor_msgs/LaserScan lie.

    Raises
    ------
    FieldError
        If the payload is cut short or makes no scan.
    """
    return _LOCATORS[encoding](payload)


def _locate_cdr(payload: bytes) -> ScanLayout:
    """CDR: 4 bytes of encapsulation, then fields aligned to 4 bytes; texts end with NUL."""
    order = CDR_BYTE_ORDERS.get(payload[1]) if len(payload) > 1 else None
    if order is None:
        msg = "a message that is no plain CDR"
        raise FieldError(msg)
    little = order == "little"
    head, tail = (_HEAD_LITTLE, _TAIL_LITTLE) if little else (_HEAD_BIG, _TAIL_BIG)
    header_ns, length = _unpack_head(head, payload)
    frame = payload[16 : 16 + max(length - 1, 0)]
    return _layout(payload, 16 + (length + 3 & ~3), tail, frame, header_ns)


def _locate_ros1(payload: bytes) -> ScanLayout:
    """ROS 1: a sequence number first, little endian, nothing aligned, texts without NUL."""
    header_ns, length = _unpack_head(_HEAD_LITTLE, payload)
    frame = payload[16 : 16 + length]
    return _layout(payload, 16 + length, _TAIL_LITTLE, frame, header_ns)


_LOCATORS = {"cdr": _locate_cdr, "ros1": _locate_ros1}
LOCATED = frozenset(_LOCATORS)
SCAN_ENCODINGS = LOCATED.union(FOXGLOVE_ENCODINGS)


def _unpack_head(head: struct.Struct, payload: bytes) -> tuple[int, int]:
    """Read the stamp and the length of the frame name (4 bytes are skipped)."""
    try:
        sec, nanosec, length = head.unpack_from(payload)
    except struct.error:
        msg = "a message shorter than its header"
        raise FieldError(msg) from None
    return sec * NS_PER_S + nanosec, length


def _layout(
    payload: bytes, place: int, tail: struct.Struct, frame: bytes, header_ns: int
) -> ScanLayout:
    """Read what follows the header of a sensor_msgs/LaserScan, up to the ranges."""
    try:
        angle_min, angle_max, increment, _, _, range_min, range_max, n_beams = tail.unpack_from(
            payload, place
        )
    except struct.error:
        raise FieldError(_CUT_SHORT) from None
    begin = place + tail.size
    if begin + n_beams * _FLOAT_LITTLE.itemsize > len(payload):
        raise FieldError(_CUT_SHORT)
    geometry = _geometry(n_beams, angle_min, angle_max, increment, range_min, range_max, frame)
    dtype = _FLOAT_LITTLE if tail is _TAIL_LITTLE else _FLOAT_BIG
    return ScanLayout(begin, dtype, header_ns, geometry)


@lru_cache(maxsize=256)
def _geometry(  # noqa: PLR0913, PLR0917  # the fields of the message, hashed as they come
    n_beams: int,
    angle_min: float,
    angle_max: float,
    increment: float,
    range_min: float,
    range_max: float,
    frame: bytes,
) -> ScanGeometry:
    """Build the geometry once for all scans that share it."""
    if n_beams == 0:
        msg = "a scan without beams"
        raise FieldError(msg)
    if increment == 0 and n_beams > 1:  # some drivers leave it empty
        increment = (angle_max - angle_min) / (n_beams - 1)
    if not (math.isfinite(angle_min) and math.isfinite(increment)):
        msg = "a scan whose angles are no numbers"
        raise FieldError(msg)
    if increment == 0 and n_beams > 1:
        msg = "a scan whose beams have all one angle"
        raise FieldError(msg)
    near, far = (0.0 if math.isnan(limit) else limit for limit in (range_min, range_max))
    name = frame.decode("utf-8", errors="replace")
    return ScanGeometry(n_beams, angle_min, increment, near, far, name)


def _scan_foxglove(payload: bytes, topic: Topic) -> ScanFields:
    """foxglove.LaserScan."""
    try:
        message = foxglove_fields(payload, topic)
        header_ns = foxglove_stamp(message, topic.encoding)
        ranges = _numbers(message["ranges"])
        first, last = float(message["start_angle"]), float(message["end_angle"])
        frame = str(message.get("frame_id", "")).encode()
    except NOT_FOLLOWED:
        msg = "a scan that does not follow foxglove.LaserScan"
        raise FieldError(msg) from None
    return header_ns, ranges, _geometry(len(ranges), first, last, 0.0, 0.0, 0.0, frame)


def _numbers(values: Any) -> Float32Array:
    """Return a list as numbers; in JSON null stands for a beam without return."""
    with np.errstate(over="ignore"):  # farther than 32 bits can tell is infinitely far
        numbers = np.array([math.nan if value is None else value for value in values], np.float32)
    if numbers.ndim != 1:
        raise ValueError(numbers.shape)
    return numbers
