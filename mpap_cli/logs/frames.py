"""Camera images out of messages, still encoded."""

import base64
import json
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from mpap_cli.logs.cursor import Cursor
from mpap_cli.logs.fields import LOCATED, FieldError, TimeSource
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.raw import LogReader, PayloadError, RawMessage, Topic
from mpap_cli.observations import NS_PER_S, Frame

COMPRESSED = "compressed"
_WHAT = "an image"
_MAX_NUMBER = 2**32
_NUMBERS_OF_16_BITS = re.compile(r"^16[US]C|16$")

FrameReader = Callable[[memoryview, str, int | None], Frame]


def _raw_image(payload: memoryview, encoding: str, stamp_ns: int | None) -> Frame:
    """sensor_msgs/Image."""
    at = Cursor(payload, encoding, _WHAT)
    header_ns = at.stamp_ns()
    at.sequence()  # frame_id
    height, width, pixels = at.number(), at.number(), at.text()
    is_bigendian, step, content = at.byte() != 0, at.number(), at.sequence()
    if is_bigendian and _NUMBERS_OF_16_BITS.search(pixels):
        content = _swapped(content, step)
    stamp_ns = header_ns if stamp_ns is None else stamp_ns
    return Frame(stamp_ns, pixels, width, height, step, bytes(content))


def _swapped(content: memoryview, step: int) -> memoryview:
    """Turn numbers of 16 bits from big into little endian."""
    if step % 2 or len(content) % 2:
        msg = f"{_WHAT} of 16 bits a pixel whose rows have an odd number of bytes"
        raise FieldError(msg)
    return np.frombuffer(content, ">u2").astype("<u2").data


def _compressed_image(payload: memoryview, encoding: str, stamp_ns: int | None) -> Frame:
    """sensor_msgs/CompressedImage."""
    at = Cursor(payload, encoding, _WHAT)
    header_ns = at.stamp_ns()
    at.sequence()  # frame_id
    at.sequence()  # format, which drivers fill in as they like
    stamp_ns = header_ns if stamp_ns is None else stamp_ns
    return Frame(stamp_ns, COMPRESSED, 0, 0, 0, bytes(at.sequence()))


def _json_raw_image(fields: Any) -> tuple[str, int, int, int]:
    """foxglove.RawImage."""
    size = (int(fields["width"]), int(fields["height"]), int(fields["step"]))
    if not all(0 <= number < _MAX_NUMBER for number in size):
        raise ValueError(size)
    return (str(fields["encoding"]), *size)


def _json_compressed_image(_: Any) -> tuple[str, int, int, int]:
    """foxglove.CompressedImage."""
    return COMPRESSED, 0, 0, 0


def _json_reader(msgtype: str, form_of: Callable[[Any], tuple[str, int, int, int]]) -> FrameReader:
    """Make the reader of images in JSON, whose bytes are base64."""

    def read(payload: memoryview, _: str, stamp_ns: int | None) -> Frame:
        try:
            fields = json.loads(bytes(payload))
            if stamp_ns is None:
                stamp = fields["timestamp"]
                stamp_ns = int(stamp["sec"]) * NS_PER_S + int(stamp["nsec"])
            content = base64.b64decode(fields["data"], validate=True)
            form = form_of(fields)
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            stamp_ns = None
        if stamp_ns is None or abs(stamp_ns) > MAX_STAMP_NS:
            msg = f"{_WHAT} that does not follow {msgtype}"
            raise FieldError(msg)
        return Frame(stamp_ns, *form, content)

    return read


FRAME_READERS: dict[tuple[str, str], FrameReader] = {
    **{("sensor_msgs/msg/CompressedImage", encoding): _compressed_image for encoding in LOCATED},
    **{("sensor_msgs/msg/Image", encoding): _raw_image for encoding in LOCATED},
    ("foxglove.CompressedImage", "json"): _json_reader(
        "foxglove.CompressedImage", _json_compressed_image
    ),
    ("foxglove.RawImage", "json"): _json_reader("foxglove.RawImage", _json_raw_image),
}
"""By type and encoding of the message; a reader takes its own stamp where none is given."""


def frame_view(
    topic: Topic, payload: memoryview, recorded_ns: int, time_source: TimeSource = "log"
) -> Frame:
    """Read one image; its bytes are copied once.

    Parameters
    ----------
    topic : Topic
        Of a type and encoding in ``FRAME_READERS``.
    payload : memoryview
        The message.
    recorded_ns : int
        Its log time.
    time_source : {"log", "header"}
        Which stamp is wanted: when the message was recorded, or the one inside it.

    Returns
    -------
    Frame
        Not decoded. Numbers of 16 bits a pixel are little endian, whatever the message has.

    Raises
    ------
    FieldError
        If the payload is cut short or makes no image.
    """
    read = FRAME_READERS.get((topic.msgtype, topic.encoding))
    if read is None:
        msg = f"{_WHAT} in encoding {topic.encoding or 'unknown'}"
        raise FieldError(msg)
    return read(payload, topic.encoding, recorded_ns if time_source == "log" else None)


def read_frame(reader: LogReader, message: RawMessage) -> Frame:
    """Return the image of a message, not decoded.

    Parameters
    ----------
    reader : LogReader
        The log that the message comes from.
    message : RawMessage
        Of a type in ``FRAME_READERS``.

    Raises
    ------
    PayloadError
        If the message does not fit its type.
    """
    try:
        return frame_view(message.topic, memoryview(message.payload), message.stamp_ns)
    except FieldError as error:
        msg = f"{reader.path.name}: {message.topic.name}: {error}"
        raise PayloadError(msg) from error
