"""Messages in protobuf, and logs of them, made by the field's own library."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from google.protobuf import descriptor_pb2, timestamp_pb2
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from mcap.writer import Writer as McapFile
from mcap_protobuf.schema import build_file_descriptor_set
from mcap_protobuf.writer import Writer

from mpap_cli.logs.protobuf import schema_text
from mpap_cli.logs.raw import Topic
from mpap_cli.observations import NS_PER_S

TIMESTAMP = "google.protobuf.Timestamp"
_STAMPED = f"{TIMESTAMP} timestamp, string frame_id, "
TYPES: dict[str, str] = {
    "foxglove.LaserScan": (
        _STAMPED + "double start_angle, double end_angle, repeated double ranges, "
        "repeated double intensities"
    ),
    "foxglove.CompressedImage": _STAMPED + "bytes data, string format",
    "foxglove.CompressedVideo": _STAMPED + "bytes data, string format",
    "foxglove.RawImage": (
        _STAMPED + "fixed32 width, fixed32 height, string encoding, fixed32 step, bytes data"
    ),
    "robot.Bumper": "int64 count, bool pressed",
    "robot.Touch": "string side, bool touched",
    "robot.Sides": "bool left, bool right, repeated int32 forces",
    "robot.Part": "string name, bool hit",
    "robot.Parts": "robot.Part main, repeated robot.Part parts",
    "robot.Node": "robot.Node next, int32 depth",
    "robot.Holder": "bytes content",
}
"""The fields of each type, numbered in this order."""

_KINDS = {
    "bool": descriptor_pb2.FieldDescriptorProto.TYPE_BOOL,
    "bytes": descriptor_pb2.FieldDescriptorProto.TYPE_BYTES,
    "double": descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE,
    "fixed32": descriptor_pb2.FieldDescriptorProto.TYPE_FIXED32,
    "int32": descriptor_pb2.FieldDescriptorProto.TYPE_INT32,
    "int64": descriptor_pb2.FieldDescriptorProto.TYPE_INT64,
    "string": descriptor_pb2.FieldDescriptorProto.TYPE_STRING,
}


def _describe(name: str) -> Any:
    """Return a file that declares one type."""
    package, _, own = name.rpartition(".")
    file = descriptor_pb2.FileDescriptorProto(name=f"{name}.proto", package=package)
    file.syntax = "proto3"
    message = file.message_type.add(name=own)
    for number, words in enumerate(TYPES[name].split(", "), 1):
        *many, kind, field_name = words.split()
        field = message.field.add(name=field_name, number=number, label=3 if many else 1)
        if kind in _KINDS:
            field.type = _KINDS[kind]
            continue
        field.type, field.type_name = descriptor_pb2.FieldDescriptorProto.TYPE_MESSAGE, f".{kind}"
        if kind != name:
            file.dependency.append(timestamp_file().name if kind == TIMESTAMP else f"{kind}.proto")
    return file


def timestamp_file() -> Any:
    """Return the library's own file of time."""
    file = descriptor_pb2.FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(file)
    return file


@cache
def _pool() -> DescriptorPool:
    pool = DescriptorPool()
    pool.Add(timestamp_file())
    for name in TYPES:
        pool.Add(_describe(name))
    return pool


def message_class(name: str) -> Any:
    """Return the class of a type in ``TYPES``."""
    return GetMessageClass(_pool().FindMessageTypeByName(name))


def schema(name: str) -> bytes:
    """Return a type and what it needs as a log holds it."""
    return bytes(build_file_descriptor_set(message_class(name)).SerializeToString())


def message(name: str, stamp_ns: int | None = None, **fields: Any) -> Any:
    """Return a message; the stamp is the one inside it."""
    if stamp_ns is not None:
        seconds, nanos = divmod(stamp_ns, NS_PER_S)
        fields["timestamp"] = {"seconds": seconds, "nanos": nanos}
    return message_class(name)(**fields)


def payload(name: str, stamp_ns: int | None = None, **fields: Any) -> bytes:
    """Return the bytes of a message."""
    return bytes(message(name, stamp_ns, **fields).SerializeToString(deterministic=True))


def topic(name: str, msgtype: str, n_messages: int = 1) -> Topic:
    """Return a topic of a type as a reader describes it."""
    return Topic(name, msgtype, "protobuf", n_messages, schema_text(schema(msgtype)), "protobuf")


def write_protobuf(path: Path, rows: Sequence[tuple[str, str, int, Mapping[str, Any]]]) -> Path:
    """Write a log of rows (topic, type, stamp, fields), as the library's own writer does."""
    with path.open("wb") as stream, Writer(stream) as writer:
        for name, msgtype, stamp_ns, fields in rows:
            stamp = stamp_ns if TIMESTAMP in TYPES[msgtype] else None
            writer.write_message(name, message(msgtype, stamp, **fields), stamp_ns, stamp_ns)
    return path


def write_raw(path: Path, msgtype: str, described: bytes, payloads: Sequence[bytes]) -> Path:
    """Write a log of one topic, /bump, whose schema is any bytes."""
    with path.open("wb") as stream:
        writer = McapFile(stream)
        writer.start()
        number = writer.register_schema(msgtype, "protobuf", described)
        channel = writer.register_channel("/bump", "protobuf", number)
        for stamp_ns, one in enumerate(payloads):
            writer.add_message(channel, stamp_ns, one, stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path
