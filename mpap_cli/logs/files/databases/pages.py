"""Pages of a database: how large they are, and reading one."""

import struct
from typing import BinaryIO, NamedTuple

from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, file_size

LEAF = 0x0D
"""First byte of a page that holds rows of a table."""

LEAF_HEADER_BYTES = 8

_HEADER_BYTES = 100
_LARGEST_PAGE = 65_536
_SMALLEST_PAGE = 512
_MOST_RESERVED = 32
_U16 = struct.Struct(">H")


class Layout(NamedTuple):
    """Sizes of a database in bytes: of a page, of the part of it in use, of the whole file."""

    page_bytes: int
    usable: int
    file_bytes: int


def read_layout(stream: BinaryIO) -> Layout:
    """Read the sizes from the header of a database.

    Raises
    ------
    BrokenRecordError
        If there is no whole header, or it is nonsense.
    """
    stream.seek(0)
    header = stream.read(_HEADER_BYTES)
    if len(header) == _HEADER_BYTES:
        (size,) = _U16.unpack_from(header, 16)
        size = _LARGEST_PAGE if size == 1 else size
        usable = size - header[20]
        least = _SMALLEST_PAGE - _MOST_RESERVED
        if size >= _SMALLEST_PAGE and size & (size - 1) == 0 and usable >= least:
            return Layout(size, usable, file_size(stream))
    msg = "the header of the database is broken"
    raise BrokenRecordError(msg)


def read_page(stream: BinaryIO, layout: Layout, number: int) -> bytes:
    """Return the part in use of a page, or what is left of it; pages count from 1."""
    stream.seek((number - 1) * layout.page_bytes)
    return stream.read(layout.usable)
