"""Where the messages of an undamaged log lie, and which of them a damage leaves whole.

Written apart from the readers of mpap, to judge them: it walks the bytes once, looks at no
index, and knows what stood there before the damage, so that nothing leads it astray.
"""

import bz2
import struct
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from typing import NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from benchmarks.robustness.linear_rows import rows_in

Key = tuple[str, int, int, int]
"""Topic, stamp, and size and CRC of the payload."""


class Place(NamedTuple):
    """Bytes that messages are read from: begin and end of each piece; and if a checksum tells."""

    pieces: tuple[tuple[int, int], ...]
    keys: tuple[Key, ...]
    is_checked: bool


def key_of(topic: str, stamp_ns: int, payload: bytes) -> Key:
    """Return what tells a message from every other."""
    return topic, stamp_ns, len(payload), zlib.crc32(payload)


def places_in(content: bytes) -> list[Place]:
    """Find all messages of an undamaged file, packed as a whole or not."""
    content = unpacked(content)
    if content.startswith(b"#ROSBAG"):
        return list(_bag_places(content))
    if content.startswith(b"\x89MCAP"):
        return list(_mcap_places(content))
    return list(_database_places(content))


def whole_messages(places: list[Place], before: bytes, after: bytes) -> Counter[Key]:
    """Return the messages whose bytes a damage has left as they were."""
    before, after = unpacked(before), unpacked(after)
    found: Counter[Key] = Counter()
    for pieces, keys, _ in places:
        if all(end <= len(after) and after[b:end] == before[b:end] for b, end in pieces):
            found.update(keys)
    return found


def is_packed_checked(content: bytes) -> bool:
    """Tell whether a file that is packed as a whole has a checksum over all of it."""
    return content.startswith(_ZSTD) and bool(content[4] & 4)


_ZSTD = b"\x28\xb5\x2f\xfd"


def unpacked(content: bytes) -> bytes:
    """Unpack a file, as far as that goes, if it is packed as a whole."""
    if not content.startswith(_ZSTD):
        return content
    parts, unpack = [], zstandard.ZstdDecompressor().decompressobj()
    try:
        for begin in range(0, len(content), 256):
            parts.append(unpack.decompress(content[begin : begin + 256]))
            if unpack.eof:
                break
    except zstandard.ZstdError:
        pass
    return b"".join(parts)


def _bag_records(
    content: bytes, begin: int, end: int
) -> Iterator[tuple[int, dict[bytes, bytes], int, int]]:
    """Yield where a record begins, its fields, and where its content begins and ends."""
    while begin < end:
        (n_header,) = struct.unpack_from("<I", content, begin)
        at, fields = begin + 4, {}
        while at < begin + 4 + n_header:
            (size,) = struct.unpack_from("<I", content, at)
            name, _, value = content[at + 4 : at + 4 + size].partition(b"=")
            fields[name] = value
            at += 4 + size
        (size,) = struct.unpack_from("<I", content, at)
        yield begin, fields, at + 4, at + 4 + size
        begin = at + 4 + size


_BAG_UNPACK: dict[bytes, Callable[[bytes], bytes]] = {
    b"lz4": lz4.frame.decompress,
    b"bz2": bz2.decompress,
}


def _bag_places(content: bytes) -> Iterator[Place]:
    """Find messages of a bag: one by one in plain chunks, chunk by chunk in packed ones."""
    topics: dict[bytes, str] = {}
    for begin, fields, inner, end in _bag_records(content, 13, len(content)):
        if fields[b"op"] != b"\x05":
            continue
        compression = fields[b"compression"]
        is_plain = compression == b"none"
        records = content if is_plain else _BAG_UNPACK[compression](content[inner:end])
        bounds = (inner, end) if is_plain else (0, len(records))
        together = []
        for start, header, first, stop in _bag_records(records, *bounds):
            if header[b"op"] == b"\x07":
                topics[header[b"conn"]] = header[b"topic"].decode()
            elif header[b"op"] == b"\x02":
                seconds, nanoseconds = struct.unpack("<II", header[b"time"])
                stamp_ns = seconds * 10**9 + nanoseconds
                key = key_of(topics[header[b"conn"]], stamp_ns, records[first:stop])
                if is_plain:
                    yield Place(((start, stop),), (key,), is_checked=False)
                together.append(key)
        if not is_plain:
            yield Place(((begin, end),), tuple(together), is_checked=compression == b"bz2")


_MCAP_UNPACK: dict[bytes, Callable[[bytes, int], bytes]] = {
    b"": lambda packed, _: packed,
    b"lz4": lambda packed, _: bytes(lz4.frame.decompress(packed)),
    b"zstd": lambda packed, size: zstandard.ZstdDecompressor().decompress(packed, size),
}


def _mcap_records(content: bytes, begin: int, end: int) -> Iterator[tuple[int, int, int, int]]:
    """Yield where a record begins, its kind, and where its content begins and ends."""
    while begin + 9 <= end:
        kind, size = struct.unpack_from("<BQ", content, begin)
        yield begin, kind, begin + 9, begin + 9 + size
        begin += 9 + size


def _mcap_places(content: bytes) -> Iterator[Place]:
    """Find messages of an MCAP file: chunk by chunk where a chunk is packed or has a CRC."""
    topics: dict[int, str] = {}
    for begin, kind, inner, end in _mcap_records(content, 8, len(content)):
        if kind == 15:  # noqa: PLR2004  # the end of the data
            return
        if kind != 6:  # noqa: PLR2004  # no chunk
            yield from _mcap_messages(content, begin, end, topics)
            continue
        size, checksum, n_name = struct.unpack_from("<QII", content, inner + 16)
        name = content[inner + 32 : inner + 32 + n_name]
        packed_at = inner + 40 + n_name
        if not checksum and not name:
            yield from _mcap_messages(content, packed_at, end, topics)
            continue
        records = _MCAP_UNPACK[name](content[packed_at:end], size)
        found = _mcap_messages(records, 0, len(records), topics)
        keys = tuple(key for place in found for key in place.keys)
        yield Place(((begin, end),), keys, is_checked=checksum != 0)


def _mcap_messages(content: bytes, begin: int, end: int, topics: dict[int, str]) -> Iterator[Place]:
    """Find messages one by one, and take down the names of channels."""
    for start, kind, at, stop in _mcap_records(content, begin, end):
        if kind == 4:  # noqa: PLR2004  # a channel
            number, _, size = struct.unpack_from("<HHI", content, at)
            topics[number] = content[at + 8 : at + 8 + size].decode()
        elif kind == 5:  # noqa: PLR2004  # a message
            number, _, stamp_ns = struct.unpack_from("<HIQ", content, at)
            key = key_of(topics[number], stamp_ns, content[at + 22 : stop])
            yield Place(((start, stop),), (key,), is_checked=False)


def _database_places(content: bytes) -> Iterator[Place]:
    """Find the rows of a rosbag2 database: in leaves, and what flows over to other pages."""
    page_bytes = struct.unpack_from(">H", content, 16)[0] % 65535
    rows = [
        row
        for page in range(0, len(content), page_bytes)
        for row in rows_in(content, page, page_bytes)
    ]
    topics: dict[int, tuple[str, tuple[tuple[int, int], ...]]] = {}
    for number, values, pieces in rows:
        match values:
            case [None, str(name), str(_), "cdr", *_]:
                topics[number] = name, pieces
    for _, values, pieces in rows:
        match values:
            case [None, int(topic), int(stamp_ns), bytes(payload)]:
                name, before = topics[topic]
                key = key_of(name, stamp_ns, _plain(payload))
                yield Place((*before, *pieces), (key,), is_checked=False)


def _plain(payload: bytes) -> bytes:
    """Unpack a message that is packed alone."""
    is_packed = payload.startswith(_ZSTD)
    return zstandard.ZstdDecompressor().stream_reader(payload).read() if is_packed else payload
