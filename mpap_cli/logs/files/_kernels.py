"""Compiled loops over the bytes of a log; lengths are believed only within the bytes at hand."""

from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mpap_cli.observations import BoolArray, IntArray

U8 = NDArray[np.uint8]
I64 = IntArray
Int = int | np.int64
Header = tuple[np.int64, np.int64, np.int64]
Walked = tuple[int, np.int64, np.int64]

MCAP_SCHEMA, MCAP_MESSAGE = 3, 5
BAG_MESSAGE = 2
LATEST_NS = np.iinfo(np.int64).max

_RECORD = 9  # opcode and length
_MCAP_HEAD = 22  # channel, sequence, log time, publish time
_U32 = 4
_TIME = 8
_NS_PER_S = 1_000_000_000
_EXPECTED = 4096
_NONE = np.int64(-1)
_O, _P, _EQUALS = ord("o"), ord("p"), ord("=")
_CONN = int.from_bytes(b"conn", "little")
_TIME_NAME = int.from_bytes(b"time", "little")


@njit(nogil=True, cache=True, error_model="numpy")
def _number(records: U8, place: Int, n_bytes: int) -> np.uint64:
    """Read a little-endian number."""
    value = np.uint64(0)
    for i in range(n_bytes):
        value |= np.uint64(records[place + i]) << np.uint64(8 * i)
    return value


@njit(nogil=True, cache=True, error_model="numpy")
def _u32(records: U8, place: Int) -> np.int64:
    """Read four bytes as a number."""
    return np.int64(_number(records, place, _U32))


@njit(nogil=True, cache=True, error_model="numpy")
def _place_in(wanted: I64, number: np.int64) -> int:
    """Return where a channel stands among the wanted ones, -1 if it does not."""
    for i in range(wanted.size):
        if wanted[i] == number:
            return i
    return -1


@njit(nogil=True, cache=True, error_model="numpy")
def _walk_mcap(records: U8, wanted: I64, start: Int, found: I64) -> Walked:
    """Write which, stamp, start and size of each wanted message; those without room count."""
    last = position = np.int64(start)
    end, n_found = records.size, 0
    while position + _RECORD <= end:
        begin = position + _RECORD
        size, kind = _number(records, position + 1, 8), np.int64(records[position])
        if size > np.uint64(end - begin) or not MCAP_SCHEMA <= kind <= MCAP_MESSAGE:
            return n_found, position, last
        stop = begin + np.int64(size)
        which, stamp = -1 - kind, np.uint64(position)
        if kind == MCAP_MESSAGE:
            if stop - begin < _MCAP_HEAD:
                return n_found, position, last
            channel, stamp = np.int64(_number(records, begin, 2)), _number(records, begin + 6, 8)
            which = np.int64(_place_in(wanted, channel)) if wanted.size else channel
            begin += _MCAP_HEAD
        if which >= 0 or wanted.size == 0:
            if n_found < found.shape[1]:
                found[0, n_found] = which
                late = stamp > np.uint64(LATEST_NS)
                found[1, n_found] = LATEST_NS if late else np.int64(stamp)
                found[2, n_found] = begin
                found[3, n_found] = stop - begin
            n_found += 1
        last, position = position, stop
    return n_found, position, last


@njit(nogil=True, cache=True, error_model="numpy")
def _read_bag_header(records: U8, begin: np.int64, end: np.int64) -> Header:
    """Return opcode, connection and stamp; -1 for what is missing, opcode -1 if broken."""
    opcode, connection, stamp = np.int64(0), _NONE, _NONE
    position = np.int64(begin)
    while position < end:
        if position + _U32 > end:
            return _NONE, _NONE, _NONE
        name = position + _U32
        stop = name + _u32(records, position)
        if stop > end:
            return _NONE, _NONE, _NONE
        equals = name
        while equals < stop and records[equals] != _EQUALS:
            equals += 1
        if equals == stop:
            return _NONE, _NONE, _NONE
        value, n_name = equals + 1, equals - name
        n_value = stop - value
        if n_name == 2 and records[name] == _O and records[name + 1] == _P:  # noqa: PLR2004  # op
            opcode = np.int64(records[value]) if n_value == 1 else np.int64(0)
        elif n_name == _U32 and _u32(records, name) == _CONN:
            connection = _u32(records, value) if n_value >= _U32 else _NONE
        elif n_name == _U32 and _u32(records, name) == _TIME_NAME:
            stamp = _NONE
            if n_value == _TIME:
                stamp = _u32(records, value) * _NS_PER_S + _u32(records, value + _U32)
        position = stop
    return opcode, connection, stamp


@njit(nogil=True, cache=True, error_model="numpy")
def _walk_bag(records: U8, wanted: I64, start: Int, found: I64) -> Walked:
    """Write which, stamp, start and size of each wanted message; those without room count."""
    last = position = np.int64(start)
    end, n_found = records.size, 0
    while position < end:
        header = position + _U32
        if header > end:
            return n_found, position, last
        after = header + _u32(records, position)
        begin = after + _U32
        if begin > end:
            return n_found, position, last
        stop = begin + _u32(records, after)
        opcode, connection, stamp = _read_bag_header(records, header, after)
        if stop > end or opcode < 0:
            return n_found, position, last
        which = -1 - opcode
        if opcode == BAG_MESSAGE:
            which = np.int64(_place_in(wanted, connection)) if wanted.size else connection
            if connection < 0 or (which >= 0 and stamp < 0):
                return n_found, position, last
        if which >= 0 or wanted.size == 0:
            if n_found < found.shape[1]:
                found[0, n_found] = which
                found[1, n_found] = stamp if opcode == BAG_MESSAGE else position
                found[2, n_found] = begin
                found[3, n_found] = stop - begin
            n_found += 1
        last, position = position, stop
    return n_found, position, last


@njit(nogil=True, cache=True, error_model="numpy")
def _find_changes(records: U8, starts: I64, sizes: I64, skip: int, changes: BoolArray) -> None:
    """Tell which payloads differ from that before, their first ``skip`` bytes left aside."""
    for i in range(starts.size):
        differs = i == 0 or sizes[i] != sizes[i - 1]
        k = skip
        while not differs and k < sizes[i]:
            differs = records[starts[i] + k] != records[starts[i - 1] + k]
            k += 1
        changes[i] = differs


def walk_mcap(records: bytes, wanted: I64, start: int = 0) -> tuple[I64, int, int]:
    """Find the messages of some channels among the records of an MCAP chunk.

    Walks from ``start``, where a record begins. Returns

    - (4, n): place of the channel in ``wanted``, log time, start and size of the payload.
      A stamp that int64 cannot hold becomes the latest that it can. Where no channel is
      wanted: the channel itself; of other records -1 - kind, and where they begin for a stamp;
    - where walking stopped: at the end, or where a broken record begins;
    - where the last whole record begins.
    """
    return _walk(_walk_mcap, records, wanted, start)


def walk_bag(records: bytes, wanted: I64, start: int = 0) -> tuple[I64, int, int]:
    """Find the messages of some connections among the records of a bag's chunk.

    Parameters and results are those of `walk_mcap`, of connections.
    """
    return _walk(_walk_bag, records, wanted, start)


def _walk(
    kernel: Callable[[U8, I64, Int, I64], Walked], records: bytes, wanted: I64, start: int
) -> tuple[I64, int, int]:
    """Run a kernel, once more if there are more messages than expected."""
    found = np.empty((4, _EXPECTED), np.int64)
    content = np.frombuffer(records, np.uint8)
    n_found, stop, last = kernel(content, wanted, start, found)
    if n_found > found.shape[1]:
        found = np.empty((4, n_found), np.int64)
        kernel(content, wanted, start, found)
    return found[:, :n_found], int(stop), int(last)


def find_changes(records: bytes, starts: I64, sizes: I64, skip: int) -> BoolArray:
    """Tell which of n payloads differ from that before, (n,); the first does.

    Their first ``skip`` bytes may differ.
    """
    changes = np.empty(starts.size, np.bool_)
    _find_changes(np.frombuffer(records, np.uint8), starts, sizes, skip, changes)
    return changes
