"""Rows of an SQLite database, page by page, for the scan that judges the readers."""

import struct
from collections.abc import Iterator

Row = tuple[int, list[object], tuple[tuple[int, int], ...]]


def rows_in(content: bytes, page: int, page_bytes: int) -> Iterator[Row]:
    """Yield id, values and bytes of each row of the leaf that begins at a byte."""
    head = page + (100 if page == 0 else 0)
    if content[head] != 0x0D:  # noqa: PLR2004  # a leaf of a table
        return
    (n_cells,) = struct.unpack_from(">H", content, head + 3)
    for cell in range(n_cells):
        pointer = head + 8 + 2 * cell
        at = page + struct.unpack_from(">H", content, pointer)[0]
        size, begin = _varint(content, at)
        number, begin = _varint(content, begin)
        local = _local_bytes(size, page_bytes)
        pieces = [
            (head, head + 8),
            (pointer, pointer + 2),
            (at, begin + local + 4 * (local < size)),
        ]
        record = content[begin : begin + local]
        following = struct.unpack_from(">I", content, begin + local)[0] if local < size else 0
        while len(record) < size:
            start = (following - 1) * page_bytes
            n_bytes = min(size - len(record), page_bytes - 4)
            pieces.append((start, start + 4 + n_bytes))
            record += content[start + 4 : start + 4 + n_bytes]
            (following,) = struct.unpack_from(">I", content, start)
        yield number, _values(record), tuple(pieces)


def _local_bytes(size: int, page_bytes: int) -> int:
    """Return how much of a record lies in its leaf."""
    if size <= page_bytes - 35:
        return size
    least = (page_bytes - 12) * 32 // 255 - 23
    local = least + (size - least) % (page_bytes - 4)
    return local if local <= page_bytes - 35 else least


def _varint(content: bytes, at: int) -> tuple[int, int]:
    """Return the number that begins there, and where it ends."""
    value = 0
    for number in range(9):
        byte = content[at + number]
        if number == 8:  # noqa: PLR2004  # the last has eight bits
            return value << 8 | byte, at + 9
        value = value << 7 | byte & 0x7F
        if byte < 0x80:  # noqa: PLR2004  # the highest bit says that more follows
            return value, at + number + 1
    raise AssertionError


def _values(record: bytes) -> list[object]:
    """Return the values of a row."""
    header, at = _varint(record, 0)
    kinds = []
    while at < header:
        kind, at = _varint(record, at)
        kinds.append(kind)
    values: list[object] = []
    for kind in kinds:
        size = (0, 1, 2, 3, 4, 6, 8, 8, 0, 0, 0, 0)[kind] if kind < 12 else (kind - 12) // 2  # noqa: PLR2004
        text = record[at : at + size]
        at += size
        if kind >= 12:  # noqa: PLR2004  # texts are odd
            values.append(text.decode(errors="replace") if kind % 2 else text)
        elif kind == 0:
            values.append(None)
        else:
            values.append(kind - 8 if kind in {8, 9} else int.from_bytes(text, "big", signed=True))
    return values
