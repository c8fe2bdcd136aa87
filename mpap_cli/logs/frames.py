"""Camera images out of messages, still encoded."""

import base64
import binascii
from collections.abc import Callable
from typing import Any

from mpap_cli.logs.raw import LogReader, PayloadError, RawMessage
from mpap_cli.observations import Frame

COMPRESSED = "compressed"


def _raw_image(fields: Any, stamp_ns: int) -> Frame:
    payload = bytes(memoryview(fields.data))
    return Frame(stamp_ns, fields.encoding, fields.width, fields.height, fields.step, payload)


def _compressed_image(fields: Any, stamp_ns: int) -> Frame:
    return Frame(stamp_ns, COMPRESSED, 0, 0, 0, bytes(memoryview(fields.data)))


def _json_raw_image(fields: Any, stamp_ns: int) -> Frame:
    payload = base64.b64decode(fields["data"], validate=True)
    size = int(fields["width"]), int(fields["height"]), int(fields["step"])
    return Frame(stamp_ns, str(fields["encoding"]), *size, payload)


def _json_compressed_image(fields: Any, stamp_ns: int) -> Frame:
    return Frame(stamp_ns, COMPRESSED, 0, 0, 0, base64.b64decode(fields["data"], validate=True))


FRAME_READERS: dict[str, Callable[[Any, int], Frame]] = {
    "sensor_msgs/msg/Image": _raw_image,
    "sensor_msgs/msg/CompressedImage": _compressed_image,
    "foxglove.RawImage": _json_raw_image,
    "foxglove.CompressedImage": _json_compressed_image,
}


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
    fields = reader.decode(message)
    try:
        return FRAME_READERS[message.topic.msgtype](fields, message.stamp_ns)
    except (AttributeError, KeyError, TypeError, ValueError, binascii.Error) as error:
        msg = f"{message.topic.name}: not a {message.topic.msgtype} ({error!r})"
        raise PayloadError(msg) from error
