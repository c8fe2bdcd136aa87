"""Camera images out of messages, still encoded."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from mpap_cli.logs.cursor import Cursor
from mpap_cli.logs.fields import LOCATED, FieldError, TimeSource
from mpap_cli.logs.foxglove import (
    FOXGLOVE_ENCODINGS,
    NOT_FOLLOWED,
    foxglove_bytes,
    foxglove_fields,
    foxglove_stamp,
)
from mpap_cli.logs.raw import LogReader, PayloadError, RawMessage, Topic
from mpap_cli.logs.video.packets import FOXGLOVE_VIDEO, VIDEO_READERS, video_encoding
from mpap_cli.observations import Frame

COMPRESSED = "compressed"
_WHAT = "an image"
_MAX_NUMBER = 2**32
_NUMBERS_OF_16_BITS = re.compile(r"^16[US]C|16$")

FrameReader = Callable[[memoryview, Topic, int | None], Frame]


def _raw_image(payload: memoryview, topic: Topic, stamp_ns: int | None) -> Frame:
    """sensor_msgs/Image."""
    at = Cursor(payload, topic.encoding, _WHAT)
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


def _compressed_image(payload: memoryview, topic: Topic, stamp_ns: int | None) -> Frame:
    """sensor_msgs/CompressedImage."""
    at = Cursor(payload, topic.encoding, _WHAT)
    header_ns = at.stamp_ns()
    at.sequence()  # frame_id
    at.sequence()  # format, which drivers fill in as they like
    stamp_ns = header_ns if stamp_ns is None else stamp_ns
    return Frame(stamp_ns, COMPRESSED, 0, 0, 0, bytes(at.sequence()))


def _foxglove_raw(fields: Any) -> tuple[str, int, int, int]:
    """foxglove.RawImage."""
    size = (int(fields["width"]), int(fields["height"]), int(fields["step"]))
    if not all(0 <= number < _MAX_NUMBER for number in size):
        raise ValueError(size)
    return (str(fields["encoding"]), *size)


def _foxglove_compressed(_: Any) -> tuple[str, int, int, int]:
    """foxglove.CompressedImage."""
    return COMPRESSED, 0, 0, 0


def _foxglove_video(fields: Any) -> tuple[str, int, int, int]:
    """foxglove.CompressedVideo."""
    return video_encoding(str(fields["format"])), 0, 0, 0


_FOXGLOVE_FORMS: dict[str, Callable[[Any], tuple[str, int, int, int]]] = {
    "foxglove.RawImage": _foxglove_raw,
    "foxglove.CompressedImage": _foxglove_compressed,
    FOXGLOVE_VIDEO: _foxglove_video,
}


def _foxglove_image(payload: memoryview, topic: Topic, stamp_ns: int | None) -> Frame:
    """Read an image in JSON or protobuf."""
    try:
        fields = foxglove_fields(bytes(payload), topic)
        if stamp_ns is None:
            stamp_ns = foxglove_stamp(fields, topic.encoding)
        form = _FOXGLOVE_FORMS[topic.msgtype](fields)
        content = foxglove_bytes(fields["data"])
    except NOT_FOLLOWED:
        msg = f"{_WHAT} that does not follow {topic.msgtype}"
        raise FieldError(msg) from None
    return Frame(stamp_ns, *form, content)


FRAME_READERS: dict[tuple[str, str], FrameReader] = {
    **{("sensor_msgs/msg/CompressedImage", encoding): _compressed_image for encoding in LOCATED},
    **{("sensor_msgs/msg/Image", encoding): _raw_image for encoding in LOCATED},
    **{(name, form): _foxglove_image for name in _FOXGLOVE_FORMS for form in FOXGLOVE_ENCODINGS},
    **VIDEO_READERS,
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
        A packet of video has no place yet.

    Raises
    ------
    FieldError
        If the payload is cut short or makes no image.
    """
    read = FRAME_READERS.get((topic.msgtype, topic.encoding))
    if read is None:
        msg = f"{_WHAT} in encoding {topic.encoding or 'unknown'}"
        raise FieldError(msg)
    return read(payload, topic, recorded_ns if time_source == "log" else None)


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
