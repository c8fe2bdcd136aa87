"""Bags written record by record: connections as they were described, messages as they are.

rosbags' writer refuses connections without a checksum, keeps only the fields that it knows, and
remembers every message until the end.
"""

import bz2
import struct
from collections import Counter
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

from mpap_cli.logs.files.ros1_bags.bag_records import (
    BAG_HEADER,
    CHUNK,
    CHUNK_INFO,
    CONNECTION,
    INDEX_DATA,
    MESSAGE,
)
from mpap_cli.logs.passthrough.records import BagChannel, Record
from mpap_cli.observations import NS_PER_S

_MAGIC = b"#ROSBAG V2.0\n"
_HEADER_BYTES = 4096
_CHUNK_BYTES = 768 * 1024  # rosbag's own default
_U32, _U64, _TIME = struct.Struct("<I"), struct.Struct("<Q"), struct.Struct("<II")


def _lz4(content: bytes) -> bytes:
    from lz4.frame import compress  # type: ignore[import-untyped]  # noqa: PLC0415  # few need it

    return bytes(compress(content))


_COMPRESSORS: Mapping[str, Callable[[bytes], bytes]] = {
    "none": bytes,
    "bz2": bz2.compress,
    "lz4": _lz4,
}


class RawBagWriter:
    """Writes a bag; memory grows with its chunks, not with its messages.

    Parameters
    ----------
    path : Path
        File that is not there yet.
    compression : str
        none, bz2 or lz4.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self._compression = compression
        self._stream: BinaryIO = path.open("xb")
        self._connections: list[tuple[BagChannel, bool]] = []
        self._infos: list[tuple[int, int, int, Counter[int]]] = []
        self._chunk = BytesIO()
        self._entries: dict[int, list[tuple[bytes, int]]] = {}
        self._bounds_ns: tuple[int, int] | None = None
        self._stream.write(_MAGIC)
        self._write_bag_header(0)

    def add_channel(self, stored: BagChannel) -> int:
        """Announce a connection; return its number."""
        self._connections.append((stored, False))
        return len(self._connections) - 1

    def write(self, number: int, record: Record) -> None:
        """Append a message to the open chunk."""
        stored, is_written = self._connections[number]
        if not is_written:
            _write_connection(self._chunk, number, stored)
            self._connections[number] = stored, True
        time = _time(record.stamp_ns)
        self._entries.setdefault(number, []).append((time, self._chunk.tell()))
        fields = {b"op": bytes([MESSAGE]), b"conn": _U32.pack(number), b"time": time}
        _write_record(self._chunk, fields, record.payload)
        first_ns, last_ns = self._bounds_ns or (record.stamp_ns, record.stamp_ns)
        self._bounds_ns = min(first_ns, record.stamp_ns), max(last_ns, record.stamp_ns)
        if self._chunk.tell() >= _CHUNK_BYTES:
            self._end_chunk()

    def close(self) -> None:
        """Write the index, and the place of it at the head of the file."""
        self._end_chunk()
        place = self._stream.tell()
        for number, (stored, _) in enumerate(self._connections):
            _write_connection(self._stream, number, stored)
        for offset, first_ns, last_ns, counts in self._infos:
            fields = {
                b"op": bytes([CHUNK_INFO]),
                b"ver": _U32.pack(1),
                b"chunk_pos": _U64.pack(offset),
                b"start_time": _time(first_ns),
                b"end_time": _time(last_ns),
                b"count": _U32.pack(len(counts)),
            }
            content = b"".join(_U32.pack(n) + _U32.pack(counts[n]) for n in counts)
            _write_record(self._stream, fields, content)
        self._stream.seek(len(_MAGIC))
        self._write_bag_header(place)
        self._stream.close()

    def abort(self) -> None:
        """Let go of the file."""
        self._stream.close()

    def _end_chunk(self) -> None:
        """Write the open chunk and where its messages are, if there are any."""
        if self._bounds_ns is None:
            return
        offset, content = self._stream.tell(), self._chunk.getvalue()
        fields = {
            b"op": bytes([CHUNK]),
            b"compression": self._compression.encode(),
            b"size": _U32.pack(len(content)),
        }
        _write_record(self._stream, fields, _COMPRESSORS[self._compression](content))
        for number, entries in self._entries.items():
            fields = {
                b"op": bytes([INDEX_DATA]),
                b"ver": _U32.pack(1),
                b"conn": _U32.pack(number),
                b"count": _U32.pack(len(entries)),
            }
            places = b"".join(time + _U32.pack(place) for time, place in entries)
            _write_record(self._stream, fields, places)
        counts = Counter({number: len(entries) for number, entries in self._entries.items()})
        self._infos.append((offset, *self._bounds_ns, counts))
        self._chunk, self._entries, self._bounds_ns = BytesIO(), {}, None

    def _write_bag_header(self, index_place: int) -> None:
        """Write the record at the head of the file, which always has the same size."""
        fields = {
            b"op": bytes([BAG_HEADER]),
            b"index_pos": _U64.pack(index_place),
            b"conn_count": _U32.pack(len(self._connections)),
            b"chunk_count": _U32.pack(len(self._infos)),
        }
        n_bytes = sum(_U32.size + len(name) + 1 + len(value) for name, value in fields.items())
        _write_record(self._stream, fields, b" " * (_HEADER_BYTES - 2 * _U32.size - n_bytes))


def _write_connection(stream: BinaryIO, number: int, stored: BagChannel) -> None:
    """Write the record of a connection."""
    fields = {
        b"op": bytes([CONNECTION]),
        b"conn": _U32.pack(number),
        b"topic": stored.topic,
    }
    _write_record(stream, fields, _packed(stored.fields))


def _write_record(stream: BinaryIO, fields: Mapping[bytes, bytes], content: bytes) -> None:
    """Write header and content of a record."""
    header = _packed(fields)
    stream.write(_U32.pack(len(header)) + header + _U32.pack(len(content)))
    stream.write(content)


def _packed(fields: Mapping[bytes, bytes]) -> bytes:
    """Return the fields of a header."""
    texts = (name + b"=" + value for name, value in fields.items())
    return b"".join(_U32.pack(len(text)) + text for text in texts)


def _time(stamp_ns: int) -> bytes:
    """Return a stamp as bags have it."""
    return _TIME.pack(*divmod(stamp_ns, NS_PER_S))
