"""How bags and MCAP files are read through where they have no index."""

from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from mpap_cli.logs.files.chunked.chunk_indexes import read_bag_index, read_mcap_index
from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, file_size
from mpap_cli.logs.files.mcap_files import mcap_records
from mpap_cli.logs.files.ros1_bags import bag_records
from mpap_cli.logs.files.salvaging.salvage import FileFormat, Piece, Scanned, scan
from mpap_cli.logs.raw import Topic

_BAG_KINDS = {
    bag_records.CHUNK: "chunk",
    bag_records.MESSAGE: "loose",
    bag_records.CONNECTION: "loose",
    bag_records.INDEX_DATA: "other",
    bag_records.CHUNK_INFO: "other",
    bag_records.BAG_HEADER: "other",
}
_MCAP_END_SIZES = {Opcode.DATA_END: 4, Opcode.FOOTER: 20}
_MCAP_LAST_KIND, _MCAP_PRIVATE = 0x0F, 0x80


def scan_bag(stream: BinaryIO) -> Scanned:
    """Read a bag through and make the index that it lacks."""
    connections: dict[int, Topic] = {}

    def describe(opcode: int, records: bytes, place: int) -> None:
        if opcode == bag_records.CONNECTION:
            fields, begin, end = bag_records.record_at(records, place)
            number, topic = bag_records.parse_connection(fields, records[begin:end])
            connections[number] = topic

    return scan(
        stream,
        FileFormat(
            bag_records.BagFormat(),
            bag_records.FIRST_RECORD,
            bag_records.RECORD_START,
            _bag_piece,
            describe,
            connections,
            lambda: connections,
        ),
    )


def _bag_piece(stream: BinaryIO, offset: int) -> Piece | None:
    """Return the record of a bag that begins at a place; None if none does."""
    if offset == file_size(stream):
        return Piece("end", offset, offset)
    stream.seek(offset)
    try:
        fields, size = bag_records.read_header(stream)
    except BrokenRecordError:
        return None
    kind = _BAG_KINDS.get(bag_records.opcode_of(fields))
    if kind is None or (kind == "chunk" and not bag_records.is_chunk(fields, size)):
        return None
    end = stream.tell() + size
    index = read_bag_index(stream, offset) if kind == "chunk" else None
    if index is not None:
        return Piece(kind, offset, index.end, sure=True, told=index.span)
    is_plain = kind == "chunk" and fields.get(b"compression") == b"none"
    return Piece(kind, offset, end, sure=is_plain)


def scan_mcap(stream: BinaryIO) -> Scanned:
    """Read the data section of an MCAP file through and make the index that it lacks."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}

    def describe(opcode: int, records: bytes, place: int) -> None:
        _, size = mcap_records.RECORD.unpack_from(records, place)
        begin = place + mcap_records.RECORD.size
        if opcode == Opcode.SCHEMA:
            schema = mcap_records.parse_schema(records[begin : begin + size])
            schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            channel = mcap_records.parse_channel(records[begin : begin + size])
            channels[channel.id] = channel

    return scan(
        stream,
        FileFormat(
            mcap_records.McapFormat(),
            len(mcap_records.MAGIC),
            mcap_records.RECORD_START,
            _mcap_piece,
            describe,
            channels,
            lambda: mcap_records.describe_channels(channels, schemas),
        ),
    )


def _mcap_piece(stream: BinaryIO, offset: int) -> Piece | None:
    """Return the record of an MCAP file that begins at a place; None if none does."""
    stream.seek(offset)
    head = stream.read(mcap_records.RECORD.size)
    if len(head) < mcap_records.RECORD.size:
        return None
    opcode, size = mcap_records.RECORD.unpack(head)
    end = offset + len(head) + size
    if opcode in _MCAP_END_SIZES:
        return Piece("end", offset, offset) if size == _MCAP_END_SIZES[opcode] else None
    if opcode == Opcode.CHUNK:
        return _mcap_chunk(stream, offset, end)
    if opcode == Opcode.MESSAGE and size < mcap_records.MESSAGE_HEAD_BYTES:
        return None
    if not 0 < opcode <= _MCAP_LAST_KIND:
        # records of others may stand between, where a record follows
        stream.seek(end if end < file_size(stream) else 0)
        following = stream.read(1)
        if opcode < _MCAP_PRIVATE or not b"\0" < following <= bytes([_MCAP_LAST_KIND]):
            return None
    return Piece("loose" if opcode in mcap_records.LOOSE else "other", offset, end)


def _mcap_chunk(stream: BinaryIO, offset: int, end: int) -> Piece | None:
    """Return the chunk that begins at a place; None if none does."""
    stream.seek(offset)
    if not mcap_records.is_chunk(stream):
        return None
    index = read_mcap_index(stream, offset)
    if index is None:
        return Piece("chunk", offset, end, sure=True)
    return Piece("chunk", offset, index.end, sure=True, told=index.span)
