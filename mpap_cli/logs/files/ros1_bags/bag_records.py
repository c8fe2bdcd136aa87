"""Records of ROS 1 bags (format 2.0), out of the file and out of chunks.

They are walked here, not with rosbags: its reader makes an object for every message of the
bag at opening, takes three times as long per message, and reads no bag without an index.
"""

import re
import struct
from collections.abc import Mapping
from contextlib import suppress
from typing import BinaryIO

from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, Span, read_up_to, seek_to
from mpap_cli.logs.files.chunked.compression import DECOMPRESSORS, decompress
from mpap_cli.logs.files.salvaging.resync import walk_on
from mpap_cli.logs.raw import Topic, ros2_name
from mpap_cli.observations import NS_PER_S, IntArray

MAGIC = b"#ROSBAG V"
FIRST_RECORD = len(b"#ROSBAG V2.0\n")
MESSAGE, BAG_HEADER, INDEX_DATA, CHUNK, CHUNK_INFO, CONNECTION = 2, 3, 4, 5, 6, 7

Fields = Mapping[bytes, bytes]

RECORD_START = re.compile(rb"(?=[\x08-\xff]\0\0\0[\x04-\x40]\0\0\0[a-z])")
"""Size of a header, size of its first field, and the first letter of that."""

_MAX_HEADER_BYTES = 1 << 24
_U32 = struct.Struct("<I")
_TIME = struct.Struct("<II")


def parse_fields(header: bytes) -> dict[bytes, bytes]:
    r"""Split a record's header into its fields.

    >>> parse_fields(b"\x04\0\0\0op=\x02")
    {b'op': b'\x02'}
    """
    fields = {}
    position = 0
    while position < len(header):
        size = read_u32(header, position)
        text = header[position + 4 : position + 4 + size]
        name, equals, value = text.partition(b"=")
        if len(text) < size or not equals:
            msg = "a header field is broken"
            raise BrokenRecordError(msg)
        fields[name] = value
        position += 4 + size
    return fields


def read_u32(text: bytes, position: int = 0) -> int:
    """Return the number at a position.

    Raises
    ------
    BrokenRecordError
        If the bytes end before.
    """
    try:
        return int(_U32.unpack_from(text, position)[0])
    except struct.error as err:
        msg = "a number is cut off"
        raise BrokenRecordError(msg) from err


def read_time(field: bytes) -> int:
    """Return a stamp in nanoseconds.

    Raises
    ------
    BrokenRecordError
        If the field has another length.
    """
    try:
        seconds, nanoseconds = _TIME.unpack(field)
    except struct.error as err:
        msg = "a stamp is cut off"
        raise BrokenRecordError(msg) from err
    return int(seconds * NS_PER_S + nanoseconds)


def read_header(stream: BinaryIO) -> tuple[dict[bytes, bytes], int]:
    """Return the fields of the record that begins here and the size of its content.

    Raises
    ------
    BrokenRecordError
        If there is no whole header.
    """
    size = read_u32(stream.read(4))
    header = stream.read(size) if size <= _MAX_HEADER_BYTES else b""
    if len(header) < size:
        msg = "a header is cut off or too long"
        raise BrokenRecordError(msg)
    return parse_fields(header), read_u32(stream.read(4))


def read_record(stream: BinaryIO, opcode: int) -> tuple[dict[bytes, bytes], bytes]:
    """Return the fields and the content of the record that begins here.

    Raises
    ------
    BrokenRecordError
        If it is not whole, or of another kind.
    """
    fields, size = read_header(stream)
    if opcode_of(fields) != opcode:
        msg = f"a record of kind {opcode_of(fields)} stands where {opcode} should"
        raise BrokenRecordError(msg)
    content = read_up_to(stream, size)
    if len(content) < size:
        msg = "a record is cut off"
        raise BrokenRecordError(msg)
    return fields, content


def opcode_of(fields: Fields) -> int:
    """Return the kind of a record, 0 if it has none."""
    field = fields.get(b"op", b"")
    return field[0] if len(field) == 1 else 0


def parse_connection(fields: Fields, content: bytes) -> tuple[int, Topic]:
    """Return a connection's id and its topic, without a count."""
    inner = parse_fields(content)
    name = fields.get(b"topic", b"").decode(errors="replace")
    topic = ("/" if name.startswith("/") else "") + "/".join(filter(None, name.split("/")))
    msgtype = inner.get(b"type", b"").decode(errors="replace")
    text = inner.get(b"message_definition", b"").decode(errors="replace")
    number = read_u32(fields.get(b"conn", b""))
    return number, Topic(topic, ros2_name(msgtype), "ros1", 0, text, "ros1msg" if text else "")


def record_at(records: bytes, position: int) -> tuple[dict[bytes, bytes], int, int]:
    """Return the fields of a record in memory, and where its content begins and ends."""
    size = read_u32(records, position)
    begin = position + 4 + size
    header = records[position + 4 : begin]
    end = begin + 4 + read_u32(records, begin)
    if end > len(records):
        msg = "a record is cut off"
        raise BrokenRecordError(msg)
    return parse_fields(header), begin + 4, end


class BagFormat:
    """How a bag stores records."""

    def load(self, stream: BinaryIO, span: Span) -> tuple[bytes, str]:
        """Return the records of a span, unpacked, and what is wrong with them ("": nothing)."""
        try:
            seek_to(stream, span.offset)
            if span.loose_bytes:
                return read_up_to(stream, span.loose_bytes), ""
            fields, packed_size = read_header(stream)
            size = read_u32(fields.get(b"size", b""))
        except BrokenRecordError as err:
            return b"", str(err)
        packed = read_up_to(stream, packed_size)
        compression = fields.get(b"compression", b"").decode(errors="replace")
        records, problem = decompress(compression, packed, size)
        return b"" if problem and len(packed) == packed_size else records, problem

    def walk(self, records: bytes, wanted: IntArray) -> tuple[IntArray, bool]:
        """Find messages in unpacked records, as `ChunkFormat.walk` says."""
        from mpap_cli.logs.files import _kernels  # noqa: PLC0415  # numba is slow to import

        return walk_on(_kernels.walk_bag, RECORD_START, _goes_on, records, wanted)


def _goes_on(records: bytes, place: int) -> bool:
    """Tell whether messages and connections begin at a place in unpacked records."""
    try:
        fields, _, _ = record_at(records, place)
        opcode, _ = opcode_of(fields), read_u32(fields.get(b"conn", b""))
        if opcode == MESSAGE:
            read_time(fields.get(b"time", b""))
    except BrokenRecordError:
        return False
    return opcode in {MESSAGE, CONNECTION}


def is_chunk(fields: Fields, packed_size: int) -> bool:
    """Tell whether the sizes of a chunk fit one another; of a packed one any may."""
    compression, size = fields.get(b"compression", b"").decode(errors="replace"), 0
    with suppress(BrokenRecordError):
        size = read_u32(fields.get(b"size", b""))
    plain = compression == "none"
    return compression in DECOMPRESSORS and (size == packed_size if plain else size > 0)
