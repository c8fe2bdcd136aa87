"""Rows out of the pages of a database, cell by cell: what the kernels must find.

https://www.sqlite.org/fileformat2.html, sections 1.6 and 2.1.
"""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

Row = tuple[int, int, int, bytes]

_LEAF = 0x0D
_LEAF_HEADER_BYTES = 8
_INTEGER_BYTES = {1: 1, 2: 2, 3: 3, 4: 4, 5: 6, 6: 8, 8: 0, 9: 0}
_FIRST_BLOB = 12
_LONGEST_VARINT = 9
_U16 = struct.Struct(">H")
_U32 = struct.Struct(">I")


class Pages(NamedTuple):
    """Sizes of a database: of a page, of its part in use, and how many pages are there whole."""

    size: int
    usable: int
    number: int


def rows_in_pages(path: Path) -> Iterator[Row]:
    """Yield id, topic, stamp and payload of every whole message, in the order of pages."""
    with path.open("rb") as stream:
        header = stream.read(100)
        (size,) = _U16.unpack_from(header, 16)
        size = 65_536 if size == 1 else size
        pages = Pages(size, size - header[20], path.stat().st_size // size)
        for page, place in _cells(stream, pages):
            try:
                row = _parse_cell(stream, pages, page, place)
            except (IndexError, struct.error):
                continue
            if row is not None:
                yield row


def _cells(stream: BinaryIO, pages: Pages) -> Iterator[tuple[bytes, int]]:
    """Yield every leaf of a table, and where in it each of its cells begins."""
    for number in range(2, pages.number + 2):
        page = _read_page(stream, pages, number)
        if len(page) < _LEAF_HEADER_BYTES or page[0] != _LEAF:
            continue
        (n_cells,) = _U16.unpack_from(page, 3)
        if _LEAF_HEADER_BYTES + 2 * n_cells > len(page):
            continue
        for place in struct.unpack_from(f">{n_cells}H", page, _LEAF_HEADER_BYTES):
            yield page, place


def _read_page(stream: BinaryIO, pages: Pages, number: int) -> bytes:
    """Return the part in use of a page, or what is left of it; pages count from 1."""
    stream.seek((number - 1) * pages.size)
    return stream.read(pages.usable)


def _varint(text: bytes, position: int) -> tuple[int, int]:
    """Return the number that begins there, and where it ends."""
    value = 0
    for count in range(1, _LONGEST_VARINT):
        byte = text[position]
        position += 1
        value = value << 7 | byte & 0x7F
        if byte < 0x80:  # the highest bit says that more follows
            return value, position
        if count == _LONGEST_VARINT - 1:
            break
    return value << 8 | text[position], position + 1


def _parse_cell(stream: BinaryIO, pages: Pages, page: bytes, place: int) -> Row | None:
    """Return the message in a cell; None if it is a row of another table."""
    size, place = _varint(page, place)
    number, place = _varint(page, place)
    if not 0 < size <= pages.size * (pages.number + 1):
        return None
    largest = pages.usable - 35
    if size <= largest:
        record = page[place : place + size]
        return _parse_record(record, number) if len(record) == size else None
    smallest = (pages.usable - 12) * 32 // 255 - 23
    local = smallest + (size - smallest) % (pages.usable - 4)
    local = local if local <= largest else smallest
    parts = [page[place : place + local]]
    if _parse_types(parts[0]) is None:
        return None
    (following,) = _U32.unpack_from(page, place + local)
    missing = size - local
    while missing > 0 and 1 < following <= pages.number + 1:
        overflow = _read_page(stream, pages, following)
        (following,) = _U32.unpack_from(overflow)
        parts.append(overflow[4 : 4 + missing])
        missing -= pages.usable - 4
    record = b"".join(parts)
    return _parse_record(record, number) if len(record) == size else None


def _parse_types(record: bytes) -> tuple[int, list[int]] | None:
    """Return where the values begin, and their types; None if they are not a message's."""
    header, position = _varint(record, 0)
    types = []
    while position < header:
        kind, position = _varint(record, position)
        types.append(kind)
    match types:
        case [0, topic, stamp, blob] if (
            topic in _INTEGER_BYTES
            and stamp in _INTEGER_BYTES
            and blob >= _FIRST_BLOB
            and blob % 2 == 0
        ):
            return header, types
    return None


def _parse_record(record: bytes, number: int) -> Row | None:
    """Return the message of a record; None if it is a row of another table."""
    found = _parse_types(record)
    if found is None:
        return None
    position, (_, topic_type, stamp_type, blob_type) = found
    values = []
    for kind in (topic_type, stamp_type):
        n_bytes = _INTEGER_BYTES[kind]
        stored = int.from_bytes(record[position : position + n_bytes], "big", signed=True)
        values.append(stored if n_bytes else kind - 8)
        position += n_bytes
    payload = record[position:]
    if len(payload) != (blob_type - _FIRST_BLOB) // 2:
        return None
    return number, values[0], values[1], payload
