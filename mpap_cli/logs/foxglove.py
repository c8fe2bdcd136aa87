"""Messages that follow Foxglove's schemas, in JSON or protobuf: the fields have the same names."""

import base64
import json
from typing import Any

from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.protobuf import PROTOBUF, read_protobuf
from mpap_cli.logs.raw import Topic
from mpap_cli.observations import NS_PER_S

FOXGLOVE_ENCODINGS = ("json", PROTOBUF)
NOT_FOLLOWED = (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError)
"""What reading a message that does not follow its schema may raise, here and by its fields."""

_STAMP_PARTS = {"json": ("sec", "nsec"), PROTOBUF: ("seconds", "nanos")}


def foxglove_fields(payload: bytes, topic: Topic) -> Any:
    """Return the fields of a message by name, as a mapping if it follows its schema."""
    if topic.encoding == PROTOBUF:
        return read_protobuf(payload, topic.definition, topic.msgtype)
    return json.loads(payload)


def foxglove_stamp(fields: Any, encoding: str) -> int:
    """Return the stamp inside a message, nanoseconds.

    Raises
    ------
    ValueError
        If no clock has it; one of `NOT_FOLLOWED` if there is none.

    Examples
    --------
    >>> foxglove_stamp({"timestamp": {"sec": 2, "nsec": 5}}, "json")
    2000000005
    """
    seconds, nanoseconds = (int(fields["timestamp"][part]) for part in _STAMP_PARTS[encoding])
    stamp_ns = seconds * NS_PER_S + nanoseconds
    if abs(stamp_ns) > MAX_STAMP_NS:
        raise ValueError(stamp_ns)
    return stamp_ns


def foxglove_bytes(content: Any) -> bytes:
    """Return bytes, which in JSON are base64."""
    return content if isinstance(content, bytes) else base64.b64decode(content, validate=True)
