"""Compiled loops over the pages of a database; what a page says is believed only within the file.

https://www.sqlite.org/fileformat2.html, sections 1.6 and 2.1.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mpap_cli.logs.files.databases.pages import Layout
from mpap_cli.observations import BoolArray, IntArray

U8 = NDArray[np.uint8]
U32 = NDArray[np.uint32]
I64 = IntArray
Int = int | np.int64

ID, TOPIC, STAMP, START, SIZE, LOCAL, OVERFLOW = range(7)
"""Columns of a row: where in the file its payload starts, the bytes of it, how many of them lie
in the leaf, and the page (from 1) where the rest begins, 0 if there is none."""

_N_COLUMNS = 7
_LEAF, _LEAF_HEADER = 0x0D, 8
_MORE, _SEVEN_BITS, _LONGEST = 0x80, 0x7F, 9
_FIRST_BLOB = 12
_NULL, _NO_FLOAT, _ZERO, _ONE = 0, 7, 8, 9
_U32_BYTES = 4
_EXPECTED = 4096
_MOST_HOPS = 16  # times the pages; sound rows share none


@njit(nogil=True, cache=True, error_model="numpy")
def _number(content: U8, place: Int, n_bytes: Int) -> np.int64:
    """Read a big-endian number without sign."""
    value = np.int64(0)
    for i in range(n_bytes):
        value = value << 8 | np.int64(content[place + i])
    return value


@njit(nogil=True, cache=True, error_model="numpy")
def _varint(content: U8, place: Int, stop: Int) -> tuple[np.int64, np.int64]:
    """Read a number of one to nine bytes; it ends at -1 if it does not end before ``stop``."""
    value = np.int64(0)
    for i in range(_LONGEST):
        if place + i >= stop:
            break
        byte = np.int64(content[place + i])
        if i == _LONGEST - 1:
            return value << 8 | byte, np.int64(place + _LONGEST)
        value = value << 7 | byte & _SEVEN_BITS
        if byte < _MORE:
            return value, np.int64(place + i + 1)
    return np.int64(0), np.int64(-1)


@njit(nogil=True, cache=True, error_model="numpy")
def _integer_bytes(kind: np.int64) -> np.int64:
    """Return how many bytes a value of a type takes, -1 if it is no integer."""
    if not _NULL < kind <= _ONE or kind == _NO_FLOAT:
        return np.int64(-1)
    if kind >= _ZERO:
        return np.int64(0)
    return kind if kind < 5 else 2 * kind - 4  # noqa: PLR2004  # type 5 has 6 bytes, 6 has 8


@njit(nogil=True, cache=True, error_model="numpy")
def _integer(content: U8, place: Int, kind: np.int64) -> np.int64:
    """Read the integer of a type."""
    n_bytes = _integer_bytes(kind)
    if n_bytes == 0:
        return kind - _ZERO
    shift = 64 - 8 * n_bytes
    return _number(content, place, n_bytes) << shift >> shift


@njit(nogil=True, cache=True, error_model="numpy")
def _local_bytes(size: np.int64, usable: Int) -> np.int64:
    """Return how many bytes of a record lie in its leaf."""
    largest = np.int64(usable - 35)
    if size <= largest:
        return size
    smallest = np.int64((usable - 12) * 32 // 255 - 23)
    local = smallest + (size - smallest) % (usable - _U32_BYTES)
    return local if local <= largest else smallest


@njit(nogil=True, cache=True, error_model="numpy")
def _parse_message(content: U8, place: Int, stop: Int, usable: Int, most: Int, row: I64) -> bool:
    """Write a cell that is a whole message into a row; its place is that in the content."""
    size, at = _varint(content, place, stop)
    if at < 0 or not 0 < size <= most:
        return False
    row[ID], at = _varint(content, at, stop)
    local = _local_bytes(size, usable)
    end, more = at + local, _U32_BYTES if local < size else 0
    if at < 0 or end + more > stop:
        return False
    row[OVERFLOW] = _number(content, end, more)
    header, kind_at = _varint(content, at, end)
    if not 0 < kind_at < end or content[kind_at] != _NULL:  # the id, which stands before the record
        return False
    topic_kind, kind_at = _varint(content, kind_at + 1, end)
    stamp_kind, kind_at = _varint(content, kind_at, end) if kind_at > 0 else (header, kind_at)
    blob_kind, kind_at = _varint(content, kind_at, end) if kind_at > 0 else (header, kind_at)
    topic_bytes, stamp_bytes = _integer_bytes(topic_kind), _integer_bytes(stamp_kind)
    is_message = topic_bytes >= 0 and stamp_bytes >= 0 and blob_kind >= _FIRST_BLOB
    if kind_at < 0 or kind_at != at + header or not is_message or blob_kind % 2:
        return False
    begin = kind_at + topic_bytes + stamp_bytes
    row[SIZE] = (blob_kind - _FIRST_BLOB) // 2
    if begin > end or begin - at + row[SIZE] != size:
        return False
    row[TOPIC] = _integer(content, kind_at, topic_kind)
    row[STAMP] = _integer(content, kind_at + topic_bytes, stamp_kind)
    row[START] = begin
    row[LOCAL] = end - begin
    return True


@njit(nogil=True, cache=True, error_model="numpy")
def _find_rows(
    content: U8, page_bytes: Int, usable: Int, most: Int, found: I64, nexts: U32, others: BoolArray
) -> int:
    """Write the messages in pages, the next page of each, and which leaves hold anything else."""
    n_found = 0
    row = np.empty(_N_COLUMNS, np.int64)
    for page in range(nexts.size):
        begin = np.int64(page * page_bytes)
        stop = min(begin + usable, np.int64(content.size))
        nexts[page] = _number(content, begin, _U32_BYTES) if begin + _U32_BYTES <= stop else 0
        others[page] = False
        if begin + _LEAF_HEADER > stop or content[begin] != _LEAF:
            continue
        n_cells = _number(content, begin + 3, 2)
        if begin + _LEAF_HEADER + 2 * n_cells > stop:
            continue
        for cell in range(n_cells):
            place = begin + _number(content, begin + _LEAF_HEADER + 2 * cell, 2)
            if not _parse_message(content, place, stop, usable, most, row):
                others[page] = True
                continue
            if n_found < found.shape[1]:
                found[:, n_found] = row
            n_found += 1
    return n_found


@njit(nogil=True, cache=True, error_model="numpy")
def _check_chains(
    rows: I64, nexts: U32, usable: Int, page_bytes: Int, file_bytes: Int, whole: BoolArray
) -> None:
    """Tell which rows have all the pages that their payload flows over to."""
    n_left = _MOST_HOPS * nexts.size
    for i in range(rows.shape[1]):
        missing, page = rows[SIZE, i] - rows[LOCAL, i], rows[OVERFLOW, i]
        while missing > 0 and 1 < page <= nexts.size and n_left > 0:
            here = min(np.int64(usable), file_bytes - (page - 1) * page_bytes) - _U32_BYTES
            if here < min(missing, usable - _U32_BYTES):
                break
            missing -= here
            page = np.int64(nexts[page - 1])
            n_left -= 1
        whole[i] = missing <= 0


@njit(nogil=True, cache=True, error_model="numpy")
def _list_pages(rows: I64, nexts: U32, usable: Int, page_bytes: Int, pages: I64) -> int:
    """Write the pages (from 0) that rows lie in; those without room count."""
    n_pages = 0
    for i in range(rows.shape[1]):
        missing, page = rows[SIZE, i] - rows[LOCAL, i], rows[OVERFLOW, i]
        following = rows[START, i] // page_bytes
        while following >= 0:
            if n_pages < pages.size:
                pages[n_pages] = following
            n_pages += 1
            following = np.int64(-1)
            if missing > 0:
                following = page - 1
                page = np.int64(nexts[page - 1])
                missing -= usable - _U32_BYTES
    return n_pages


@njit(nogil=True, cache=True, error_model="numpy")
def _copy_payloads(
    content: U8, pages: I64, rows: I64, nexts: U32, usable: Int, page_bytes: Int, payloads: U8
) -> None:
    """Copy payloads behind one another out of pages that lie behind one another."""
    at = np.int64(0)
    for i in range(rows.shape[1]):
        missing, n_bytes, following = rows[SIZE, i], rows[LOCAL, i], rows[OVERFLOW, i]
        page, skipped = rows[START, i] // page_bytes, rows[START, i] % page_bytes
        while True:
            begin = np.searchsorted(pages, page) * page_bytes + skipped
            source, target = content[begin : begin + n_bytes], payloads[at : at + n_bytes]
            if source.size != n_bytes or target.size != n_bytes:
                raise ValueError
            target[:] = source
            at += n_bytes
            missing -= n_bytes
            if missing <= 0:
                break
            n_bytes, skipped = min(missing, np.int64(usable - _U32_BYTES)), np.int64(_U32_BYTES)
            page, following = following - 1, np.int64(nexts[following - 1])


def find_rows(content: bytes, layout: Layout) -> tuple[I64, U32, BoolArray]:
    """Find the messages in pages that follow one another.

    They come as the columns `ID` to `OVERFLOW` (7, n), where starts count from the first of these
    pages and only what lies in the leaf is checked; with the first number of each page (n_pages,),
    the page that follows if it is a payload's; and which leaves hold anything else (n_pages,).
    """
    n_pages = -(-len(content) // layout.page_bytes)
    nexts, others = np.empty(n_pages, np.uint32), np.empty(n_pages, np.bool_)
    pages = np.frombuffer(content, np.uint8)
    found = np.empty((_N_COLUMNS, _EXPECTED), np.int64)
    sizes = (layout.page_bytes, layout.usable, layout.file_bytes)
    n_found = _find_rows(pages, *sizes, found, nexts, others)
    if n_found > found.shape[1]:
        found = np.empty((_N_COLUMNS, n_found), np.int64)
        _find_rows(pages, *sizes, found, nexts, others)
    return found[:, :n_found].copy(), nexts, others


def check_chains(rows: I64, nexts: U32, layout: Layout) -> BoolArray:
    """Tell which rows (7, n) have all of their pages in the file, (n,); these share hardly any."""
    whole = np.empty(rows.shape[1], np.bool_)
    _check_chains(rows, nexts, layout.usable, layout.page_bytes, layout.file_bytes, whole)
    return whole


def list_pages(rows: I64, nexts: U32, layout: Layout) -> I64:
    """Return the pages (from 0) of rows (7, n) that are whole, sorted, each once."""
    pages = np.empty(_EXPECTED, np.int64)
    n_pages = _list_pages(rows, nexts, layout.usable, layout.page_bytes, pages)
    if n_pages > pages.size:
        pages = np.empty(n_pages, np.int64)
        _list_pages(rows, nexts, layout.usable, layout.page_bytes, pages)
    return np.unique(pages[:n_pages])


def copy_payloads(content: U8, pages: I64, rows: I64, nexts: U32, layout: Layout) -> bytes:
    """Return the payloads of rows (7, n) behind one another; ``content`` is that of ``pages``."""
    payloads = np.empty(int(rows[SIZE].sum()), np.uint8)
    _copy_payloads(content, pages, rows, nexts, layout.usable, layout.page_bytes, payloads)
    return payloads.tobytes()
