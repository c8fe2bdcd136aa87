"""ROS 1 bags: opened by their index, or read through where that is missing."""

import struct
from typing import BinaryIO

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunked.chunks import (
    BrokenRecordError,
    ChunkedFile,
    Index,
    Span,
    make_index,
    seek_to,
)
from mpap_cli.logs.files.ros1_bags.bag_records import (
    BAG_HEADER,
    CHUNK,
    CHUNK_INFO,
    CONNECTION,
    FIRST_RECORD,
    MAGIC,
    BagFormat,
    Fields,
    is_chunk,
    opcode_of,
    parse_connection,
    read_header,
    read_record,
    read_time,
    read_u32,
)
from mpap_cli.logs.files.salvaging.salvage import Scanned
from mpap_cli.logs.files.salvaging.salvage_formats import scan_bag
from mpap_cli.logs.raw import Damage, Reading
from mpap_cli.logs.remote.paths import LogPath
from mpap_cli.logs.remote.range_stream import RangeStream

_U64 = struct.Struct("<Q")
_COUNT = struct.Struct("<II")
_LOOKED_AT = 1000  # chunks, which takes some milliseconds
_LOOKED_AT_FAR = 4  # each takes a request


def open_bag(path: LogPath, reading: Reading) -> ChunkedFile:
    """Open a .bag file.

    Parameters
    ----------
    path : Path or RemotePath
        File that begins with the magic of bags.
    reading : Reading
        Gets the damage.

    Returns
    -------
    ChunkedFile
        Its messages, encoding ``ros1``.

    Raises
    ------
    LogError
        If the version is not 2.0, the bag is encrypted, or, read strictly, damaged.
    """
    with path.open("rb") as stream:
        version = stream.readline(FIRST_RECORD)[len(MAGIC) :].strip().decode(errors="replace")
        if version != "2.0":
            msg = f"{path.name}: bag version {version!r}, expected '2.0'; use 'rosbag fix'"
            raise LogError(msg)
        try:
            header, _ = read_record(stream, BAG_HEADER)
            if header.get(b"encryptor"):
                msg = f"{path.name}: the bag is encrypted; decrypt it with 'rosbag decrypt'"
                raise LogError(msg)
            index = _read_index(stream, header)
        except BrokenRecordError:
            scanned = scan_bag(stream)
            reading.add_damage(_describe_damage(path.name, scanned))
            index = scanned.found
    return ChunkedFile(path, BagFormat(), index, reading)


def _read_index(stream: BinaryIO, header: Fields) -> Index:
    """Read the connections and the list of chunks at the end of the bag."""
    try:
        (position,) = _U64.unpack(header.get(b"index_pos", b""))
    except struct.error as err:
        msg = "the position of the index is broken"
        raise BrokenRecordError(msg) from err
    if position == 0:
        msg = "there is no index"
        raise BrokenRecordError(msg)
    seek_to(stream, position)
    n_connections = read_u32(header.get(b"conn_count", b""))
    n_chunks = read_u32(header.get(b"chunk_count", b""))
    records = (read_record(stream, CONNECTION) for _ in range(n_connections))
    channels = dict(parse_connection(fields, content) for fields, content in records)
    spans = [_read_chunk_info(*read_record(stream, CHUNK_INFO)) for _ in range(n_chunks)]
    for span in spans[: _LOOKED_AT_FAR if isinstance(stream, RangeStream) else _LOOKED_AT]:
        _require_chunk(stream, span)
    return make_index(channels, spans)


def _require_chunk(stream: BinaryIO, span: Span) -> None:
    """Refuse an index that leads to something else than a chunk; no checksum protects it."""
    seek_to(stream, span.offset)
    fields, size = read_header(stream)
    if opcode_of(fields) != CHUNK or not is_chunk(fields, size) or span.start_ns > span.end_ns:
        msg = "the list of chunks is broken"
        raise BrokenRecordError(msg)


def _read_chunk_info(fields: Fields, content: bytes) -> Span:
    """Return where a chunk is and what it holds."""
    try:
        (offset,) = _U64.unpack(fields.get(b"chunk_pos", b""))
        counts = dict(_COUNT.iter_unpack(content))
    except struct.error as err:
        msg = "the list of chunks is broken"
        raise BrokenRecordError(msg) from err
    first, last = read_time(fields.get(b"start_time", b"")), read_time(fields.get(b"end_time", b""))
    return Span(offset, first, last, {number: n for number, n in counts.items() if n})


def _describe_damage(name: str, scanned: Scanned) -> Damage:
    """Say what is wrong with a bag that was read through."""
    found = scanned.n_messages
    if scanned.whole:
        text = f"{name}: the bag has no usable index; all {found:,} messages found are used"
        return Damage(name, "unindexed", found, text)
    return Damage(name, "truncated", found, f"{name}: the bag {scanned.problem}")
