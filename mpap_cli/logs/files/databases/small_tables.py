"""The small tables of a broken rosbag2 database: topics, definitions, distribution."""

import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO

from mpap_cli.logs.files.databases.pages import LEAF, LEAF_HEADER_BYTES, Layout, read_page

_LONGEST_VARINT = 9
_FIRST_TEXT = 13
_MOST_TEXTS = 4
_MOST_BYTES = 1 << 24  # larger is no definition
_U16 = struct.Struct(">H")
_U32 = struct.Struct(">I")


@dataclass(frozen=True, slots=True)
class SmallTables:
    """Topics (name, type, encoding) by id, definitions (form, text) by type; the distribution."""

    topics: dict[int, tuple[str, str, str]] = field(default_factory=dict)
    definitions: dict[str, tuple[str, str]] = field(default_factory=dict)
    ros_distro: str = ""


def read_small_tables(path: Path, layout: Layout, pages: Iterable[int]) -> SmallTables:
    """Read what the rows of some pages say, the first of several that say the same.

    Parameters
    ----------
    path : Path
        The database, cut off or broken in whatever way.
    layout : Layout
        Its sizes.
    pages : iterable of int
        Leaves of tables, from 1.
    """
    topics: dict[int, tuple[str, str, str]] = {}
    definitions: dict[str, tuple[str, str]] = {}
    distros = []
    with path.open("rb") as stream:
        for number, texts in _rows(stream, layout, pages):
            match texts:
                case [name, msgtype, ("cdr" | "ros1" | "json") as encoding, *_]:
                    topics.setdefault(number, (name, msgtype, encoding))
                case [msgtype, ("ros2msg" | "ros2idl") as form, text, *_]:
                    definitions.setdefault(msgtype, (form, text))
                case [distro]:
                    distros.append(distro)
    return SmallTables(topics, definitions, distros[0] if distros else "")


def _rows(
    stream: BinaryIO, layout: Layout, pages: Iterable[int]
) -> Iterator[tuple[int, list[str]]]:
    """Yield id and texts of every row that has nothing but texts behind its id."""
    for number in pages:
        page = read_page(stream, layout, number)
        if len(page) < LEAF_HEADER_BYTES or page[0] != LEAF:
            continue
        (n_cells,) = _U16.unpack_from(page, 3)
        if LEAF_HEADER_BYTES + 2 * n_cells > len(page):
            continue
        for place in struct.unpack_from(f">{n_cells}H", page, LEAF_HEADER_BYTES):
            try:
                size, begin = _varint(page, place)
                row_id, begin = _varint(page, begin)
                texts = _texts(_record(stream, layout, page, begin, size))
            except (IndexError, struct.error):
                continue
            if texts:
                yield row_id, texts


def _varint(text: bytes, position: int) -> tuple[int, int]:
    """Return the number that begins there, and where it ends."""
    value = 0
    for count in range(1, _LONGEST_VARINT):
        byte = text[position]
        position += 1
        value = value << 7 | byte & 0x7F
        if byte < 0x80:  # noqa: PLR2004  # the highest bit says that more follows
            return value, position
        if count == _LONGEST_VARINT - 1:
            break
    return value << 8 | text[position], position + 1


def _record(stream: BinaryIO, layout: Layout, page: bytes, begin: int, size: int) -> bytes:
    """Return a record with what flows over to other pages, as far as these are there."""
    largest, following_bytes = layout.usable - 35, layout.usable - 4
    if size <= largest or size > _MOST_BYTES:
        return page[begin : begin + size]
    smallest = (layout.usable - 12) * 32 // 255 - 23
    local = smallest + (size - smallest) % following_bytes
    local = local if local <= largest else smallest
    parts, missing = [page[begin : begin + local]], size - local
    (following,) = _U32.unpack_from(page, begin + local)
    while missing > 0 and following > 1:
        overflow = read_page(stream, layout, following)
        if len(overflow) <= _U32.size:
            break
        (following,) = _U32.unpack_from(overflow)
        parts.append(overflow[4 : 4 + missing])
        missing -= following_bytes
    return b"".join(parts)


def _texts(record: bytes) -> list[str]:
    """Return the first texts behind the id; none if anything else stands before them."""
    header, position = _varint(record, 0)
    kind, position = _varint(record, position)
    if kind != 0:
        return []
    ends = [header]
    while position < header and len(ends) <= _MOST_TEXTS:
        kind, position = _varint(record, position)
        if kind < _FIRST_TEXT or kind % 2 == 0:
            break
        ends.append(ends[-1] + (kind - _FIRST_TEXT) // 2)
    whole = [(begin, end) for begin, end in pairwise(ends) if end <= len(record)]
    return [record[begin:end].decode(errors="replace") for begin, end in whole]
