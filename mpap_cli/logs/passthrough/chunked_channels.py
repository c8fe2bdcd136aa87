"""How bags and MCAP files describe their channels, read as it stands."""

import struct
from collections.abc import Iterator, Mapping
from io import BytesIO
from typing import BinaryIO

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Header, Schema

from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, ChunkedFile, seek_to
from mpap_cli.logs.files.mcap_files import mcap_records
from mpap_cli.logs.files.mcap_files.mcap import summary_bytes
from mpap_cli.logs.files.ros1_bags import bag_records
from mpap_cli.logs.passthrough.records import BagChannel, McapChannel
from mpap_cli.logs.raw import Topic
from mpap_cli.logs.remote.paths import LogPath

_U64 = struct.Struct("<Q")
_MOST_HEADER_BYTES = 1 << 16


def _descriptions(file: ChunkedFile) -> Iterator[tuple[bytes, int]]:
    """Yield memory and place of each record in it that is no message, chunk by chunk."""
    with file.path.open("rb") as stream:
        for span in file.spans:
            records, _ = file.layout.load(stream, span)
            found, _ = file.layout.walk(records, np.empty(0, dtype=np.int64))
            yield from ((records, place) for place in found[1, found[0] < 0].tolist())


def bag_channels(file: ChunkedFile) -> dict[int, BagChannel]:
    """Return the connections of a bag, from its index or else from its chunks."""
    try:
        with file.path.open("rb") as stream:
            found = dict(_indexed_connections(stream))
    except BrokenRecordError:
        found = {}
    for records, place in () if file.channels.keys() <= found.keys() else _descriptions(file):
        try:
            fields, begin, end = bag_records.record_at(records, place)
            if bag_records.opcode_of(fields) == bag_records.CONNECTION:
                number, channel = _connection(fields, records[begin:end])
                found.setdefault(number, channel)
        except BrokenRecordError:
            continue
        if file.channels.keys() <= found.keys():
            break
    return {n: found.get(n) or _bag_channel_of(topic) for n, topic in file.channels.items()}


def _indexed_connections(stream: BinaryIO) -> Iterator[tuple[int, BagChannel]]:
    """Yield the connections that the index of a bag lists."""
    seek_to(stream, bag_records.FIRST_RECORD)
    header, _ = bag_records.read_record(stream, bag_records.BAG_HEADER)
    place = header.get(b"index_pos", b"")
    if len(place) != _U64.size or not any(place):
        return
    seek_to(stream, _U64.unpack(place)[0])
    for _ in range(bag_records.read_u32(header.get(b"conn_count", b""))):
        yield _connection(*bag_records.read_record(stream, bag_records.CONNECTION))


def _connection(fields: bag_records.Fields, content: bytes) -> tuple[int, BagChannel]:
    """Return the number of a connection, and its description."""
    number = bag_records.read_u32(fields.get(b"conn", b""))
    return number, BagChannel(fields.get(b"topic", b""), bag_records.parse_fields(content))


def _bag_channel_of(topic: Topic) -> BagChannel:
    """Describe a connection of which only the topic is left."""
    name, msgtype = topic.name.encode(), topic.msgtype.replace("/msg/", "/").encode()
    text = topic.definition.encode()
    fields = {b"topic": name, b"type": msgtype, b"md5sum": b"*", b"message_definition": text}
    return BagChannel(name, fields)


def mcap_channels(file: ChunkedFile) -> dict[int, McapChannel]:
    """Return the channels of an MCAP file, from its summary or else from its chunks."""
    channels: dict[int, Channel] = {}
    schemas: dict[int, Schema] = {}
    try:
        with file.path.open("rb") as stream:
            summary = summary_bytes(stream)
        for opcode, begin, end in mcap_records.records_in(summary):
            _take(opcode, summary[begin:end], channels, schemas)
    except BrokenRecordError:
        channels.clear()
    for records, place in () if _known(file.channels, channels, schemas) else _descriptions(file):
        opcode, size = mcap_records.RECORD.unpack_from(records, place)
        begin = place + mcap_records.RECORD.size
        try:
            _take(opcode, records[begin : begin + size], channels, schemas)
        except BrokenRecordError:
            continue
        if _known(file.channels, channels, schemas):
            break
    return {
        number: McapChannel(channels[number], schemas.get(channels[number].schema_id))
        if number in channels
        else _mcap_channel_of(number, topic)
        for number, topic in file.channels.items()
    }


def _take(
    opcode: int, content: bytes, channels: dict[int, Channel], schemas: dict[int, Schema]
) -> None:
    """Keep a record that describes a channel or a schema."""
    if opcode == Opcode.SCHEMA:
        schema = mcap_records.parse_schema(content)
        schemas.setdefault(schema.id, schema)
    elif opcode == Opcode.CHANNEL:
        channel = mcap_records.parse_channel(content)
        channels.setdefault(channel.id, channel)


def _known(
    wanted: Mapping[int, Topic], channels: Mapping[int, Channel], schemas: Mapping[int, Schema]
) -> bool:
    """Tell whether every channel is described, and its schema."""
    if not wanted.keys() <= channels.keys():
        return False
    needed = {channels[number].schema_id for number in wanted} - {0}
    return needed <= schemas.keys()


def _mcap_channel_of(number: int, topic: Topic) -> McapChannel:
    """Describe a channel of which only the topic is left."""
    channel = Channel(
        id=number,
        topic=topic.name,
        message_encoding=topic.encoding,
        metadata={},
        schema_id=number if topic.definition else 0,
    )
    schema = Schema(
        id=number,
        name=topic.msgtype,
        encoding=topic.definition_format,
        data=topic.definition.encode(),
    )
    return McapChannel(channel, schema if topic.definition else None)


def mcap_header(path: LogPath) -> tuple[str, str]:
    """Return profile and library of an MCAP file, both empty if its header is broken."""
    with path.open("rb") as stream:
        stream.seek(len(mcap_records.MAGIC))
        head = stream.read(mcap_records.RECORD.size)
        if len(head) < mcap_records.RECORD.size:
            return "", ""
        opcode, size = mcap_records.RECORD.unpack(head)
        if opcode != Opcode.HEADER or size > _MOST_HEADER_BYTES:
            return "", ""
        content = stream.read(size)
    try:
        header = Header.read(ReadDataStream(BytesIO(content)))
    except (McapError, struct.error, ValueError):
        return "", ""
    return header.profile, header.library


def chunk_compression(file: ChunkedFile) -> str:
    """Return how the first chunk is packed: none, bz2, lz4 or zstd; none without a chunk."""
    span = next((span for span in file.spans if not span.loose_bytes), None)
    if span is None:
        return "none"
    try:
        with file.path.open("rb") as stream:
            seek_to(stream, span.offset)
            if isinstance(file.layout, bag_records.BagFormat):
                fields, _ = bag_records.read_header(stream)
                found = fields.get(b"compression", b"").decode(errors="replace")
            else:
                found = mcap_records.chunk_compression(stream)
    except BrokenRecordError:
        found = ""
    return found or "none"
