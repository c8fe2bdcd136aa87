"""Files of chunks without an index: read through once, so that all that is whole is used."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import BinaryIO, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from mpap_cli.logs.files import bag_records, mcap_records
from mpap_cli.logs.files.chunks import (
    BrokenRecordError,
    ChunkFormat,
    Index,
    Span,
    file_size,
    make_index,
)
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.raw import Topic

RUN_BYTES = 1 << 20
"""Records outside chunks are taken together up to about that size."""


class Scanned(NamedTuple):
    """What was found in a file; ``whole`` tells if the file goes on as it should to its end.

    ``stop`` is the byte where reading ended.
    """

    found: Index
    whole: bool
    stop: int


class _Piece(NamedTuple):
    """One record of a file: chunk, loose, other, or end; ``end`` may lie behind the file."""

    kind: str
    offset: int
    end: int


@dataclass(slots=True)
class _Tally:
    """What is known of a file so far."""

    spans: list[Span] = field(default_factory=list)
    broken: dict[int, str] = field(default_factory=dict)
    counts: Counter[int] = field(default_factory=Counter)
    stamps: list[int] = field(default_factory=list)
    whole: bool = False
    stop: int = 0

    def count(self, channel: int, stamp_ns: int) -> None:
        """Count one message of the span that is read."""
        if stamp_ns <= MAX_STAMP_NS:
            self.counts[channel] += 1
            self.stamps.append(stamp_ns)

    def finish_span(self, span: Span) -> None:
        """Keep the span that was read, with its counts and stamps."""
        if self.stamps:
            first, last = min(self.stamps), max(self.stamps)
            made = Span(span.offset, first, last, dict(self.counts), span.loose_bytes, span.cut)
            self.spans.append(made)
        self.counts.clear()
        self.stamps.clear()

    def spans_of(self, pieces: Iterator[_Piece], file_size: int) -> Iterator[Span]:
        """Join records outside chunks into runs; chunks stay alone."""
        begin = end = 0
        for piece in pieces:
            cut = piece.end > file_size
            joins = piece.kind == "loose" and not cut
            if begin < end and not (joins and piece.offset == end and end - begin < RUN_BYTES):
                yield Span(begin, 0, 0, None, end - begin)
                begin = end
            if joins:
                begin, end = (begin if begin < end else piece.offset), piece.end
            elif piece.kind == "chunk":
                yield Span(piece.offset, 0, 0, None, cut=cut)
            self.whole = piece.kind == "end"
            self.stop = piece.offset if cut else piece.end
        if begin < end:
            yield Span(begin, 0, 0, None, end - begin)


def _scan(
    stream: BinaryIO,
    layout: ChunkFormat,
    pieces: Iterator[_Piece],
    read_span: Callable[[bytes, _Tally], None],
) -> _Tally:
    """Read every piece of a file once."""
    tally = _Tally()
    for span in tally.spans_of(pieces, file_size(stream)):
        records, problem = layout.load(stream, span)
        try:
            read_span(records, tally)
        except BrokenRecordError as err:
            problem = problem or str(err)
        if problem and not span.cut:
            tally.broken[span.offset] = problem
        tally.finish_span(span)
    return tally


def scan_bag(stream: BinaryIO) -> Scanned:
    """Read a bag through and make the index that it lacks."""
    connections: dict[int, Topic] = {}

    def read_span(records: bytes, tally: _Tally) -> None:
        for fields, begin, end in bag_records.records_in(records):
            opcode = bag_records.opcode_of(fields)
            if opcode == bag_records.CONNECTION:
                number, topic = bag_records.parse_connection(fields, records[begin:end])
                connections[number] = topic
            elif opcode == bag_records.MESSAGE:
                number = bag_records.read_u32(fields.get(b"conn", b""))
                tally.count(number, bag_records.read_time(fields.get(b"time", b"")))

    tally = _scan(stream, bag_records.BagFormat(), _bag_pieces(stream), read_span)
    index = make_index(connections, tally.spans, broken=tally.broken)
    return Scanned(index, tally.whole, tally.stop)


def _bag_pieces(stream: BinaryIO) -> Iterator[_Piece]:
    """Yield the records of a bag up to the first that is broken."""
    kinds = {
        bag_records.CHUNK: "chunk",
        bag_records.MESSAGE: "loose",
        bag_records.CONNECTION: "loose",
        bag_records.INDEX_DATA: "other",
        bag_records.CHUNK_INFO: "other",
        bag_records.BAG_HEADER: "other",
    }
    offset = bag_records.FIRST_RECORD
    while offset < file_size(stream):
        stream.seek(offset)
        try:
            fields, size = bag_records.read_header(stream)
        except BrokenRecordError:
            return
        kind = kinds.get(bag_records.opcode_of(fields))
        if kind is None:
            return
        end = stream.tell() + size
        yield _Piece(kind, offset, end)
        offset = end
    if offset == file_size(stream):
        yield _Piece("end", offset, offset)


def scan_mcap(stream: BinaryIO) -> Scanned:
    """Read the data section of an MCAP file through and make the index that it lacks."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}

    def read_span(records: bytes, tally: _Tally) -> None:
        for opcode, begin, end in mcap_records.records_in(records):
            if opcode == Opcode.SCHEMA:
                schema = mcap_records.parse_schema(records[begin:end])
                schemas[schema.id] = schema
            elif opcode == Opcode.CHANNEL:
                channel = mcap_records.parse_channel(records[begin:end])
                channels[channel.id] = channel
            elif opcode == Opcode.MESSAGE:
                tally.count(*mcap_records.parse_message(records, begin))

    pieces = _mcap_pieces(stream)
    tally = _scan(stream, mcap_records.McapFormat(), pieces, read_span)
    topics = mcap_records.describe_channels(channels, schemas)
    return Scanned(make_index(topics, tally.spans, broken=tally.broken), tally.whole, tally.stop)


def _mcap_pieces(stream: BinaryIO) -> Iterator[_Piece]:
    """Yield the records of the data section up to its end, or to the first that is cut."""
    loose = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE)
    offset = len(mcap_records.MAGIC)
    while offset < file_size(stream):
        stream.seek(offset)
        head = stream.read(mcap_records.RECORD.size)
        if len(head) < mcap_records.RECORD.size:
            return
        opcode, size = mcap_records.RECORD.unpack(head)
        if opcode in {Opcode.DATA_END, Opcode.FOOTER}:
            yield _Piece("end", offset, offset)
            return
        end = offset + len(head) + size
        kind = "chunk" if opcode == Opcode.CHUNK else "loose" if opcode in loose else "other"
        yield _Piece(kind, offset, end)
        offset = end
