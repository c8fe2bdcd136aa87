"""What the index records behind one chunk say: stamps and places of its messages by channel."""

import struct
from typing import BinaryIO, NamedTuple

import numpy as np
from mcap.opcode import Opcode

from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, Span, read_up_to, seek_to
from mpap_cli.logs.files.mcap_files import mcap_records
from mpap_cli.logs.files.ros1_bags import bag_records
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.observations import NS_PER_S, IntArray

_INDEX_HEAD = struct.Struct("<BQHI")
_CHUNK_START = struct.Struct("<BQQQQ")
_BAG_HEAD_BYTES = 46  # sizes and header of a message, as every recorder writes them
_MCAP_HEAD_BYTES = 31


class _Entries(NamedTuple):
    """One index record: the messages of a channel, (n,) stamps and places in the chunk."""

    channel: int
    stamps_ns: IntArray
    places: IntArray


class ChunkIndex(NamedTuple):
    """The index of a chunk: what the chunk holds, and where its index ends."""

    span: Span
    end: int
    entries: list[_Entries]
    n_bytes: int
    head_bytes: int

    def sizes(self) -> dict[int, int]:
        """Return the bytes of payloads by channel.

        Only where records begin is known, so what describes a channel inside the chunk counts
        to the message before it.
        """
        places = np.concatenate([entries.places for entries in self.entries])
        order = np.argsort(places)
        sizes = np.diff(places[order], append=self.n_bytes) - self.head_bytes
        n_entries = [entries.places.size for entries in self.entries]
        which = np.repeat(np.arange(len(n_entries)), n_entries)[order]
        sums = np.bincount(which, np.maximum(sizes, 0), len(n_entries))
        channels = [entries.channel for entries in self.entries]
        return dict(zip(channels, sums.astype(np.int64).tolist(), strict=True))


def read_bag_index(stream: BinaryIO, offset: int) -> ChunkIndex | None:
    """Read the index records behind a chunk of a bag.

    Nothing else says the same, so stamps that fall are not believed.

    Parameters
    ----------
    stream : BinaryIO
        The file.
    offset : int
        Where the chunk begins.

    Returns
    -------
    ChunkIndex or None
        None if the records are not all there or do not agree.
    """
    found: list[_Entries] = []
    try:
        seek_to(stream, offset)
        fields, size = bag_records.read_header(stream)
        n_bytes = bag_records.read_u32(fields.get(b"size", b""))
        end = stream.tell() + size
        seek_to(stream, end)
        fields, size = bag_records.read_header(stream)
        while bag_records.opcode_of(fields) == bag_records.INDEX_DATA:
            number = bag_records.read_u32(fields.get(b"conn", b""))
            entries = np.frombuffer(read_up_to(stream, size), "<u4").astype(np.int64)
            if 4 * entries.size != size or not size or size % 12:
                return None
            stamps_ns = entries[0::3] * NS_PER_S + entries[1::3]
            if (stamps_ns[1:] < stamps_ns[:-1]).any():
                return None
            found.append(_Entries(number, stamps_ns, entries[2::3]))
            end = stream.tell()
            fields, size = bag_records.read_header(stream)
    except (BrokenRecordError, ValueError):
        return None
    # else some of the index may be missing
    is_last = bag_records.opcode_of(fields) == bag_records.CONNECTION and b"topic" in fields
    if not (is_last or bag_records.is_chunk(fields, size)):
        return None
    return _made(offset, found, n_bytes, _BAG_HEAD_BYTES, end)


def read_mcap_index(stream: BinaryIO, offset: int) -> ChunkIndex | None:
    """Read the index records behind a chunk of an MCAP file.

    The chunk itself says the first and the last stamp, too, which must be the same. Parameters
    and results are those of `read_bag_index`.
    """
    seek_to(stream, offset)
    start = stream.read(_CHUNK_START.size)
    if len(start) < _CHUNK_START.size:
        return None
    _, size, first_ns, last_ns, n_bytes = _CHUNK_START.unpack(start)
    end = offset + mcap_records.RECORD.size + size
    found: list[_Entries] = []
    stream.seek(end)
    while len(head := stream.read(_INDEX_HEAD.size)) == _INDEX_HEAD.size:
        opcode, size, number, size_of_entries = _INDEX_HEAD.unpack(head)
        if opcode != Opcode.MESSAGE_INDEX:
            break
        if size != size_of_entries + _INDEX_HEAD.size - mcap_records.RECORD.size:
            return None
        entries = np.frombuffer(read_up_to(stream, size_of_entries), np.uint8)
        if entries.size != size_of_entries or not entries.size or entries.size % 16:
            return None
        numbers = entries.view("<i8")
        found.append(_Entries(number, numbers[0::2], numbers[1::2]))
        end = stream.tell()
    stream.seek(end)
    # else some of the index may be missing
    if head[:1] != bytes([Opcode.DATA_END]) and not mcap_records.is_chunk(stream):
        return None
    made = _made(offset, found, n_bytes, _MCAP_HEAD_BYTES, end)
    if made is None or (made.span.start_ns, made.span.end_ns) != (first_ns, last_ns):
        return None
    return made


def _made(
    offset: int, found: list[_Entries], n_bytes: int, head_bytes: int, end: int
) -> ChunkIndex | None:
    """Put the index of a chunk together; None if it cannot be right."""
    counts = {entries.channel: entries.stamps_ns.size for entries in found}
    if not found or len(counts) < len(found):
        return None
    first_ns = min(int(entries.stamps_ns.min()) for entries in found)
    last_ns = max(int(entries.stamps_ns.max()) for entries in found)
    if first_ns < 0 or last_ns > MAX_STAMP_NS:
        return None
    return ChunkIndex(Span(offset, first_ns, last_ns, counts), end, found, n_bytes, head_bytes)
