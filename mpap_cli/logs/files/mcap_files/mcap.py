"""MCAP files: opened by their summary, or read through where that is missing."""

import struct
import zlib
from dataclasses import dataclass
from typing import BinaryIO, NamedTuple

from mcap.opcode import Opcode

from mpap_cli.logs.files.chunked.chunks import (
    BrokenRecordError,
    ChunkedFile,
    Index,
    Span,
    file_size,
    make_index,
)
from mpap_cli.logs.files.chunked.compression import MAX_CHUNK_BYTES
from mpap_cli.logs.files.mcap_files.mcap_distro import read_distro
from mpap_cli.logs.files.mcap_files.mcap_records import (
    MAGIC,
    McapFormat,
    describe_channels,
    parse_channel,
    parse_schema,
    records_in,
)
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.files.salvaging.salvage_formats import scan_mcap
from mpap_cli.logs.raw import Damage, Reading, Topic
from mpap_cli.logs.remote.paths import LogPath

_FOOTER = struct.Struct("<BQQQI8s")
_FOOTER_LENGTH = 20
_CHECKED_FOOTER_BYTES = 25
_CHUNK_INDEX = struct.Struct("<QQQQI")
_CHANNEL_OFFSET = struct.Struct("<HQ")
_U64 = struct.Struct("<Q")
_STATISTICS = struct.Struct("<QH4I2QI")
_MESSAGE_INDEX_BYTES = 15
_MESSAGE_INDEX_ENTRY_BYTES = 16


class _Statistics(NamedTuple):
    n_messages: int
    by_channel: dict[int, int]


@dataclass(frozen=True, slots=True)
class _Summary:
    """What a summary says; ``index`` is None where it does not say where each message is."""

    channels: dict[int, Topic]
    n_messages: int | None
    index: Index | None
    ros_distro: str = ""


def open_mcap(path: LogPath, reading: Reading) -> ChunkedFile:
    """Open an MCAP file of any profile, chunked or not.

    Parameters
    ----------
    path : Path or RemotePath
        File that begins with the magic of MCAP.
    reading : Reading
        Gets the damage.

    Returns
    -------
    ChunkedFile
        Its messages, in whatever encodings its channels have.

    Raises
    ------
    LogError
        If the file is damaged and read strictly.
    """
    with path.open("rb") as stream:
        problem, told = "", _Summary({}, None, None)
        try:
            told = _read_summary(stream)
        except BrokenRecordError as err:
            problem = str(err)
        index = told.index
        if index is None:
            scanned = scan_mcap(stream)
            # a checksum protects the summary, but not always what stands before it
            known = {**scanned.found.channels, **told.channels}
            index = make_index(known, scanned.found.spans, broken=scanned.found.broken)
            found = sum(topic.n_messages for topic in index.channels.values())
            lost = (told.n_messages or 0) - found
            if not scanned.whole:
                text = f"{path.name}: the file {scanned.problem}"
                reading.add_damage(Damage(path.name, "truncated", found, text))
            elif problem:
                text = f"{path.name}: {problem}; all {found:,} messages found are used"
                reading.add_damage(Damage(path.name, "index", found, text))
            elif lost > 0:
                text = f"{path.name}: {lost:,} messages left out, they cannot be found"
                reading.add_damage(Damage(path.name, "message", lost, text))
    file = ChunkedFile(path, McapFormat(), index, reading)
    file.ros_distro = told.ros_distro
    return file


def _read_summary(stream: BinaryIO) -> _Summary:
    """Read what the file's summary says; without an index if it does not give all of it."""
    summary = summary_bytes(stream)
    schemas, channels, spans, metadata = {}, {}, [], []
    statistics = None
    for opcode, begin, end in records_in(summary):
        content = summary[begin:end]
        if opcode == Opcode.SCHEMA:
            schema = parse_schema(content)
            schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            channel = parse_channel(content)
            channels[channel.id] = channel
        elif opcode == Opcode.CHUNK_INDEX:
            spans.append(_parse_chunk_index(content))
        elif opcode == Opcode.STATISTICS:
            statistics = _parse_statistics(content)
        elif opcode == Opcode.METADATA_INDEX:
            metadata.append(content)
    topics = describe_channels(channels, schemas)
    # the types of the distribution are needed where a definition is not in the file
    is_needed = any(not topic.definition for topic in topics.values())
    distro = read_distro(stream, metadata) if is_needed else ""
    if statistics is None or not statistics.by_channel.keys() <= channels.keys():
        return _Summary(topics, statistics and statistics.n_messages, None, distro)
    # Messages may stand outside chunks, and chunks need not have message indexes.
    if sum(sum((span.n_messages or {}).values()) for span in spans) != statistics.n_messages:
        return _Summary(topics, statistics.n_messages, None, distro)
    index = make_index(topics, spans, statistics.by_channel)
    return _Summary(topics, statistics.n_messages, index, distro)


def summary_bytes(stream: BinaryIO) -> bytes:
    """Return the records of the summary, checked; empty where there is none.

    Raises
    ------
    BrokenRecordError
        If the file does not end as it should, or the summary is not what it was.
    """
    size = file_size(stream)
    stream.seek(max(0, size - _FOOTER.size))
    tail = stream.read(_FOOTER.size)
    if len(tail) < _FOOTER.size:
        msg = "the file has no footer"
        raise BrokenRecordError(msg)
    opcode, length, start, _, checksum, magic = _FOOTER.unpack(tail)
    if opcode != Opcode.FOOTER or length != _FOOTER_LENGTH or magic != MAGIC:
        msg = "the file has no footer"
        raise BrokenRecordError(msg)
    if start == 0:
        return b""
    if not max(len(MAGIC), size - MAX_CHUNK_BYTES) <= start <= size - _FOOTER.size:
        msg = "the position of its summary is wrong"
        raise BrokenRecordError(msg)
    stream.seek(start)
    summary = stream.read(size - _FOOTER.size - start)
    if checksum and zlib.crc32(tail[:_CHECKED_FOOTER_BYTES], zlib.crc32(summary)) != checksum:
        msg = "the checksum of its summary is wrong"
        raise BrokenRecordError(msg)
    return summary


def _parse_chunk_index(content: bytes) -> Span:
    """Return where a chunk is and, from its message indexes, how many messages of each channel."""
    try:
        first, last, offset, length, n_bytes = _CHUNK_INDEX.unpack_from(content)
        end = _CHUNK_INDEX.size + n_bytes
        places = [
            (place, channel)
            for channel, place in _CHANNEL_OFFSET.iter_unpack(content[_CHUNK_INDEX.size : end])
        ]
        (index_bytes,) = _U64.unpack_from(content, end)
    except struct.error as err:
        msg = "its list of chunks is broken"
        raise BrokenRecordError(msg) from err
    places.sort()
    ends = [*(place for place, _ in places), offset + length + index_bytes][1:]
    counts = {}
    for (place, channel), stop in zip(places, ends, strict=True):
        n_messages, rest = divmod(stop - place - _MESSAGE_INDEX_BYTES, _MESSAGE_INDEX_ENTRY_BYTES)
        if rest or n_messages < 0:
            msg = "its list of chunks is broken"
            raise BrokenRecordError(msg)
        if n_messages:
            counts[channel] = n_messages
    return Span(offset, first, min(last, MAX_STAMP_NS), counts)


def _parse_statistics(content: bytes) -> _Statistics:
    """Return how many messages there are, in all and by channel."""
    try:
        n_messages, *_, n_bytes = _STATISTICS.unpack_from(content)
        begin = _STATISTICS.size
        by_channel = dict(_CHANNEL_OFFSET.iter_unpack(content[begin : begin + n_bytes]))
    except struct.error as err:
        msg = "its statistics are broken"
        raise BrokenRecordError(msg) from err
    return _Statistics(n_messages, by_channel)
