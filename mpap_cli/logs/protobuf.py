"""Protobuf messages, read by the schema that the log holds (extra ``protobuf``)."""

import base64
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from functools import lru_cache
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from google.protobuf.message import Message

PROTOBUF = "protobuf"
PROTOBUF_EXTRA = 'pip install "mpap[protobuf]" to read it'
NO_SCHEMA = "its protobuf schema is missing or cannot be used"

_MOST_SCHEMAS = 256


class ProtobufFields(Mapping[str, Any]):
    """The fields of one message by name; one that is left out has its default.

    Lists are lists, maps are dicts, messages inside are ``ProtobufFields`` again.
    """

    def __init__(self, message: "Message") -> None:
        self._message = message
        self._names = type(message).DESCRIPTOR.fields_by_name

    def __getitem__(self, name: str) -> Any:
        if name not in self._names:
            raise KeyError(name)
        return _plain(getattr(self._message, name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _plain(value: Any) -> Any:
    """Return a value without the types of the library."""
    from google.protobuf.message import Message  # noqa: PLC0415  # only protobuf needs it

    if isinstance(value, str | bytes | bool | int | float):
        return value
    if isinstance(value, Message):
        return ProtobufFields(value)
    if isinstance(value, MutableMapping):
        return {str(key): _plain(value[key]) for key in value}
    elements = list(value)
    return list(map(_plain, elements)) if isinstance(next(iter(elements), 0), Message) else elements


def protobuf_is_read() -> bool:
    """Tell whether the extra is installed."""
    return find_spec("mcap_protobuf") is not None


def schema_text(schema: bytes) -> str:
    """Return a FileDescriptorSet as the definition of a topic, which is text."""
    return base64.b64encode(schema).decode()


def read_protobuf(payload: bytes, definition: str, msgtype: str) -> ProtobufFields:
    """Read one message.

    Parameters
    ----------
    payload : bytes
        The message.
    definition : str
        What `schema_text` makes of its schema.
    msgtype : str
        The full name of the message in it.

    Raises
    ------
    ValueError
        If it is no message of that type, or its schema cannot be used.
    """
    from google.protobuf.message import DecodeError  # noqa: PLC0415  # only protobuf needs it

    read = _message_reader(definition, msgtype)
    if read is None:
        raise ValueError(NO_SCHEMA)
    try:
        return ProtobufFields(read(payload))
    except DecodeError as err:
        raise ValueError(*err.args) from err


def boolean_fields(definition: str, msgtype: str) -> tuple[str, ...]:
    """Return the names of the boolean fields of a type; none if its schema cannot be used."""
    read = _message_reader(definition, msgtype)
    if read is None:
        return ()
    fields = type(read(b"")).DESCRIPTOR.fields
    return tuple(field.name for field in fields if field.type == field.TYPE_BOOL)


def has_schema(definition: str, msgtype: str) -> bool:
    """Tell whether messages can be read by a schema."""
    return _message_reader(definition, msgtype) is not None


@lru_cache(maxsize=_MOST_SCHEMAS)
def _message_reader(definition: str, msgtype: str) -> "Callable[[bytes], Message] | None":
    """Return what reads a type; None if its schema cannot be used, whatever is in it."""
    from google.protobuf.message import DecodeError  # noqa: PLC0415  # only protobuf needs it
    from mcap.exceptions import McapError  # noqa: PLC0415
    from mcap.records import Schema  # noqa: PLC0415
    from mcap_protobuf.decoder import DecoderFactory  # noqa: PLC0415

    schema = Schema(id=1, data=base64.b64decode(definition), encoding=PROTOBUF, name=msgtype)
    try:
        read = DecoderFactory().decoder_for(PROTOBUF, schema)
        if read is not None:
            read(b"")  # the class is made when it is first used
    except (DecodeError, McapError, TypeError, ValueError, LookupError, RecursionError):
        return None
    return read
