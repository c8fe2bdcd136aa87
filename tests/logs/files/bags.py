"""Records of ROS 1 bags, written by hand."""

import struct

ROWS = [("/left" if number % 3 else "/right", 10**18 + number, "x" * 20) for number in range(60)]
STAMP = struct.pack("<II", 5, 7)


def field(name: bytes, value: bytes) -> bytes:
    """Return one header field."""
    text = name + b"=" + value
    return struct.pack("<I", len(text)) + text


def record(fields: bytes, content: bytes) -> bytes:
    """Return one record."""
    return struct.pack("<I", len(fields)) + fields + struct.pack("<I", len(content)) + content


def number(value: int) -> bytes:
    """Return a number as it stands in a header."""
    return struct.pack("<I", value)


def connection(identity: int, topic: bytes, msgtype: bytes = b"std_msgs/String") -> bytes:
    """Return a connection record without a definition."""
    head = field(b"op", b"\x07") + field(b"conn", number(identity)) + field(b"topic", topic)
    return record(head, field(b"type", msgtype) + field(b"md5sum", b"*"))


def message(payload: bytes, order: str = "op conn time") -> bytes:
    """Return a message record of connection 0 with its fields in an order."""
    fields = {
        "op": field(b"op", b"\x02"),
        "conn": field(b"conn", number(0)),
        "time": field(b"time", STAMP),
    }
    return record(b"".join(fields[name] for name in order.split()), payload)
