"""Records of MCAP files, out of the file and out of chunks."""

import re
import struct
import zlib
from collections.abc import Iterator, Mapping
from io import BytesIO
from typing import BinaryIO, TypeVar

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, Span, read_up_to, seek_to
from mpap_cli.logs.files.chunked.compression import decompress
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.files.salvaging.resync import CHAIN, walk_on
from mpap_cli.logs.protobuf import PROTOBUF, schema_text
from mpap_cli.logs.raw import Topic, ros2_name
from mpap_cli.observations import NS_PER_S, IntArray

Record = TypeVar("Record", Schema, Channel)

MAGIC = b"\x89MCAP0\r\n"
RECORD = struct.Struct("<BQ")
RECORD_START = re.compile(rb"(?=[\x03-\x0f].{4}\0{4})", re.DOTALL)
"""Kind and size of a record of less than 4 GiB."""

LOOSE = frozenset({Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE})
"""What stands in chunks, or outside."""

MESSAGE_HEAD_BYTES = 22

_CHUNK = struct.Struct("<BQQQQII")
_U64 = struct.Struct("<Q")
_STAMPS = struct.Struct("<6xQQ")
_DAY_NS = 86_400 * NS_PER_S
_MAX_NAME_BYTES = 32
_ROS_ENCODINGS = ("ros1", "cdr")
_DEFINITION_FORMATS = {
    "ros1msg": "ros1msg",
    "ros2msg": "ros2msg",
    "ros2idl": "ros2idl",
    "omgidl": "ros2idl",
    "jsonschema": "jsonschema",
    PROTOBUF: PROTOBUF,
}


def records_in(records: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield kind, begin and end of the content of every record.

    Raises
    ------
    BrokenRecordError
        After the last whole record, if more bytes follow.
    """
    end = 0
    while end < len(records):
        begin = end + RECORD.size
        if begin > len(records):
            msg = "a record is cut off"
            raise BrokenRecordError(msg)
        opcode, size = RECORD.unpack_from(records, end)
        end = begin + size
        if end > len(records):
            msg = "a record is cut off"
            raise BrokenRecordError(msg)
        yield opcode, begin, end


def parse_schema(content: bytes) -> Schema:
    """Return a schema record.

    Raises
    ------
    BrokenRecordError
        If it does not follow the format.
    """
    return _parse(Schema, content, "a schema is broken")


def parse_channel(content: bytes) -> Channel:
    """Return a channel record.

    Raises
    ------
    BrokenRecordError
        If it does not follow the format.
    """
    return _parse(Channel, content, "a channel is broken")


def _parse(kind: type[Record], content: bytes, problem: str) -> Record:
    """Return a record as the library reads it; its errors become ours."""
    try:
        record: Record = kind.read(ReadDataStream(BytesIO(content)))
    except (McapError, struct.error, ValueError) as err:
        raise BrokenRecordError(problem) from err
    return record


def describe_channels(
    channels: Mapping[int, Channel], schemas: Mapping[int, Schema]
) -> dict[int, Topic]:
    """Return the topic of every channel, without its count."""
    topics = {}
    for number, channel in channels.items():
        schema = schemas.get(channel.schema_id)
        name = schema.name if schema else ""
        encoding = channel.message_encoding
        form = _DEFINITION_FORMATS.get(schema.encoding, "") if schema else ""
        text = _definition(schema, form) if schema and form else ""
        msgtype = ros2_name(name) if encoding in _ROS_ENCODINGS else name
        topics[number] = Topic(channel.topic, msgtype, encoding, 0, text, form if text else "")
    return topics


def _definition(schema: Schema, form: str) -> str:
    """Return a schema as text; protobuf has it in bytes."""
    return schema_text(schema.data) if form == PROTOBUF else schema.data.decode(errors="replace")


class McapFormat:
    """How an MCAP file stores records."""

    def load(self, stream: BinaryIO, span: Span) -> tuple[bytes, str]:
        """Return the records of a span, unpacked, and what is wrong with them ("": nothing)."""
        try:
            seek_to(stream, span.offset)
            if span.loose_bytes:
                return read_up_to(stream, span.loose_bytes), ""
            compression, size, checksum, packed_size = _read_chunk_head(stream)
        except BrokenRecordError as err:
            return b"", str(err)
        packed = read_up_to(stream, packed_size)
        records, problem = decompress(compression, packed, size)
        if len(packed) < packed_size:
            return records, problem or "it is cut off"
        if not problem and checksum and zlib.crc32(records) != checksum:
            problem = "its checksum is wrong"
        return b"" if problem else records, problem

    def walk(self, records: bytes, wanted: IntArray) -> tuple[IntArray, bool]:
        """Find messages in unpacked records, as `ChunkFormat.walk` says."""
        from mpap_cli.logs.files import _kernels  # noqa: PLC0415  # numba is slow to import

        return walk_on(_kernels.walk_mcap, RECORD_START, _goes_on, records, wanted)


def _goes_on(records: bytes, place: int) -> bool:
    """Tell whether messages and what describes them begin at a place in unpacked records."""
    for _ in range(CHAIN):
        if place + RECORD.size > len(records):
            return False
        opcode, size = RECORD.unpack_from(records, place)
        place += RECORD.size + size
        if opcode not in LOOSE or place > len(records):
            return False
        if opcode == Opcode.MESSAGE and size < MESSAGE_HEAD_BYTES:
            return False
        if place == len(records) or (opcode == Opcode.MESSAGE and _agree(records, place - size)):
            break
    return True


def _agree(records: bytes, begin: int) -> bool:
    """Tell whether both stamps of a message are about the same, as hardly any other bytes are."""
    stamps_ns: tuple[int, int] = _STAMPS.unpack_from(records, begin)
    recorded_ns, published_ns = stamps_ns
    return 0 < recorded_ns < MAX_STAMP_NS and abs(recorded_ns - published_ns) < _DAY_NS


def is_chunk(stream: BinaryIO) -> bool:
    """Tell whether the sizes of the chunk that begins here fit one another."""
    try:
        _read_chunk_head(stream)
    except BrokenRecordError:
        return False
    return True


def _read_chunk_head(stream: BinaryIO) -> tuple[str, int, int, int]:
    """Return compression, size, checksum and packed size of the chunk that begins here."""
    head = stream.read(_CHUNK.size)
    if len(head) < _CHUNK.size:
        msg = "its head is cut off"
        raise BrokenRecordError(msg)
    opcode, length, _, _, size, checksum, n_name = _CHUNK.unpack(head)
    rest = stream.read(min(n_name, _MAX_NAME_BYTES) + _U64.size)
    if opcode != Opcode.CHUNK or len(rest) != n_name + _U64.size:
        msg = "its head is broken"
        raise BrokenRecordError(msg)
    (packed_size,) = _U64.unpack_from(rest, n_name)
    if RECORD.size + length != _CHUNK.size + len(rest) + packed_size:
        msg = "its head is broken"
        raise BrokenRecordError(msg)
    return rest[:n_name].decode(errors="replace"), size, checksum, packed_size


def chunk_compression(stream: BinaryIO) -> str:
    """Return the compression of the chunk that begins here, empty for none.

    Raises
    ------
    BrokenRecordError
        If no chunk begins here.
    """
    return _read_chunk_head(stream)[0]
