"""Messages in protobuf, by the schema that the log holds."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.protobuf import (
    ProtobufFields,
    boolean_fields,
    has_schema,
    read_protobuf,
    schema_text,
)
from tests.protobufs import message_class, payload, schema


def read(msgtype: str, **fields: Any) -> ProtobufFields:
    """Write a message and read it again."""
    return read_protobuf(payload(msgtype, **fields), schema_text(schema(msgtype)), msgtype)


def plain(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields as dicts, those inside too."""
    return {
        name: plain(one) if isinstance(one, ProtobufFields) else one for name, one in fields.items()
    }


def test_fields_come_by_name() -> None:
    """Numbers of 64 bits stay numbers, bytes stay bytes."""
    bumper = read("robot.Bumper", count=1 << 62, pressed=True)
    image = read("foxglove.CompressedImage", data=b"\xff\0", format="jpeg")

    assert dict(bumper) == {"count": 1 << 62, "pressed": True}
    assert (image["data"], image["format"]) == (b"\xff\0", "jpeg")


def test_what_is_left_out_has_its_default() -> None:
    """Also a message inside, which is there without having been sent."""
    fields = read("robot.Parts")

    assert fields["parts"] == []
    assert plain(fields["main"]) == {"name": "", "hit": False}
    assert len(fields) == 2


def test_lists_of_messages_are_lists_of_fields() -> None:
    """So that a path may go through them."""
    fields = read("robot.Parts", parts=[{"name": "left"}, {"name": "right", "hit": True}])

    assert [plain(one) for one in fields["parts"]] == [
        {"name": "left", "hit": False},
        {"name": "right", "hit": True},
    ]


def test_maps_are_dicts() -> None:
    """A descriptor is itself a message; one with a map is made of it."""
    files = FileDescriptorSet()
    file = files.file.add(name="m.proto", package="robot", syntax="proto3")
    message = file.message_type.add(name="Switches")
    field = message.field.add(name="on", number=1, type=11, label=3)
    field.type_name = ".robot.Switches.OnEntry"
    entry = message.nested_type.add(name="OnEntry")
    entry.options.map_entry = True
    entry.field.add(name="key", number=1, type=9, label=1)
    entry.field.add(name="value", number=2, type=8, label=1)
    on = b"\x0a\x08\x0a\x04left\x10\x01"

    fields = read_protobuf(on, schema_text(files.SerializeToString()), "robot.Switches")

    assert dict(fields) == {"on": {"left": True}}


def test_type_that_holds_itself_has_no_end() -> None:
    """Only what is asked for is looked at."""
    fields = read("robot.Node", next={"next": {"depth": 2}})

    assert fields["next"]["next"]["depth"] == 2
    assert fields["next"]["next"]["next"]["next"]["depth"] == 0


def test_unknown_field_is_a_key_error() -> None:
    """As of any mapping."""
    with pytest.raises(KeyError, match="nothing"):
        read("robot.Bumper")["nothing"]


def test_boolean_fields_are_found_without_a_message() -> None:
    """By the schema; those of messages inside do not count."""
    assert boolean_fields(schema_text(schema("robot.Sides")), "robot.Sides") == ("left", "right")
    assert boolean_fields(schema_text(schema("robot.Parts")), "robot.Parts") == ()
    assert boolean_fields(schema_text(b"\xff"), "robot.Parts") == ()


def twice() -> bytes:
    """Return a schema with one file in it twice."""
    files = FileDescriptorSet.FromString(schema("robot.Bumper"))
    files.file.append(files.file[0])
    return bytes(files.SerializeToString())


def in_a_ring() -> bytes:
    """Return a schema of two files that need each other."""
    files = FileDescriptorSet()
    files.file.add(name="a", dependency=["b"], package="robot").message_type.add(name="Bumper")
    files.file.add(name="b", dependency=["a"], package="robot")
    return bytes(files.SerializeToString())


def in_a_long_row() -> bytes:
    """Return a schema of files each of which needs the next."""
    files = FileDescriptorSet()
    files.file.add(name="5000", package="robot").message_type.add(name="Bumper")
    for number in reversed(range(5000)):
        files.file.add(name=str(number), dependency=[str(number + 1)])
    return bytes(files.SerializeToString())


def nested(depth: int) -> bytes:
    """Return a schema whose types lie in one another."""
    files = FileDescriptorSet()
    file = files.file.add(name="a", package="robot")
    message = file.message_type.add(name="Bumper")
    for _ in range(depth):
        message = message.nested_type.add(name="Bumper")
    return bytes(files.SerializeToString())


@pytest.mark.parametrize(
    "described",
    [
        b"",
        b"\xff\xfe",
        b"not a schema",
        schema("robot.Touch"),
        schema("robot.Parts")[:-20],
        FileDescriptorSet(file=[{"name": "a", "dependency": ["gone"]}]).SerializeToString(),
        twice(),
        in_a_ring(),
        in_a_long_row(),
        nested(200),
    ],
    ids=["empty", "noise", "text", "other", "cut", "lost", "twice", "ring", "row", "nested"],
)
def test_schema_that_cannot_be_used_is_a_value_error(described: bytes) -> None:
    """Whatever the library says of it, and without end."""
    text = schema_text(described)

    assert not has_schema(text, "robot.Bumper")
    with pytest.raises(ValueError, match=r"^its protobuf schema is missing or cannot be used$"):
        read_protobuf(b"", text, "robot.Bumper")


@given(place=st.integers(0, 400), noise=st.binary(max_size=8))
def test_any_schema_makes_fields_or_a_value_error(place: int, noise: bytes) -> None:
    """No other exception leaves the reader."""
    whole = schema("foxglove.RawImage")
    text = schema_text(whole[:place] + noise + whole[place + len(noise) :])

    with suppress(ValueError):
        read_protobuf(b"", text, "foxglove.RawImage")


@given(content=st.binary(max_size=60))
def test_any_bytes_make_fields_or_a_value_error(content: bytes) -> None:
    """No other exception leaves the reader."""
    with suppress(ValueError):
        dict(read_protobuf(content, schema_text(schema("robot.Parts")), "robot.Parts"))


def test_deep_message_is_a_value_error() -> None:
    """The library stops at a depth of a hundred."""
    text = schema_text(schema("robot.Node"))
    content = payload("robot.Node", depth=1)
    for _ in range(120):
        content = message_class("robot.Holder")(content=content).SerializeToString()

    with pytest.raises(ValueError, match="Error parsing"):
        read_protobuf(content, text, "robot.Node")
