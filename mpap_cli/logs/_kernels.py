"""Compiled loops over the payloads of many messages: stamps, comparisons, copies of numbers.

Nothing outside the bytes at hand is read, whatever the messages say.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mpap_cli.observations import BoolArray, IntArray

U8 = NDArray[np.uint8]
I64 = IntArray

HEAD_BYTES = 16
"""Encapsulation or sequence number, stamp, length of the frame name."""

_NS_PER_S = np.int64(1_000_000_000)
_U32 = 4


@njit(nogil=True, cache=True, error_model="numpy")
def _gather(records: U8, places: I64, rows: U8) -> None:
    """Copy the bytes at each place into a row; as slices they go many at once."""
    n_bytes = rows.shape[1]
    for i in range(places.size):
        row, content = rows[i], records[places[i] : places[i] + n_bytes]
        if content.size != n_bytes:
            raise ValueError
        for k in range(n_bytes):
            row[k] = content[k]


@njit(nogil=True, cache=True, error_model="numpy")
def _find_alike(records: U8, starts: I64, first: int, mask: U8, alike: BoolArray) -> None:
    """Tell which heads equal the bytes at ``first`` wherever the mask is set."""
    model = records[first : first + mask.size]
    for i in range(starts.size):
        if alike[i]:
            difference = np.uint8(0)
            head = records[starts[i] : starts[i] + mask.size]
            for k in range(mask.size):
                difference |= (head[k] ^ model[k]) & mask[k]
            alike[i] = difference == 0


@njit(nogil=True, cache=True, error_model="numpy")
def _word(head: U8, place: int, is_big: bool) -> np.int64:
    """Read four bytes as a number."""
    value = np.int64(0)
    for k in range(_U32):
        byte = np.int64(head[place + k])
        value |= byte << np.int64(8 * (_U32 - 1 - k if is_big else k))
    return value


@njit(nogil=True, cache=True, error_model="numpy")
def _read_stamps(
    records: U8, starts: I64, sizes: I64, orders: U8, stamps_ns: I64, readable: BoolArray
) -> None:
    """Read the stamps of headers; ``orders`` says by the second byte how a payload lies."""
    for i in range(starts.size):
        head = records[starts[i] : starts[i] + min(sizes[i], HEAD_BYTES)]
        stamps_ns[i], readable[i] = 0, False
        if head.size == HEAD_BYTES:
            order = orders[head[1]]
            seconds = _word(head, _U32, order == BIG)
            stamps_ns[i] = seconds * _NS_PER_S + _word(head, 2 * _U32, order == BIG)
            readable[i] = order != UNKNOWN


@njit(nogil=True, cache=True, error_model="numpy")
def _measure_steps(
    recorded_ns: I64, own_ns: I64, used: BoolArray, last_ns: I64, limits_ns: I64, found: I64
) -> None:
    """Compare each step of two clocks; ``last_ns`` is the message before, -1 for the first."""
    for i in range(recorded_ns.size):
        if not used[i]:
            continue
        if last_ns[0] >= 0:
            step, own_step = recorded_ns[i] - last_ns[1], own_ns[i] - last_ns[2]
            parted = abs(step - own_step)
            if parted > limits_ns[0]:
                found[0, 1] = found[0, 1] if found[0, 0] else recorded_ns[i]
                found[0, 2] = max(found[0, 2], parted)
                found[0, 0] += 1
            if step > limits_ns[1]:
                found[1, 1] = found[1, 1] if found[1, 0] else last_ns[1]
                found[1, 2] = max(found[1, 2], step)
                found[1, 0] += 1
            found[2, 0] += own_step < 0
        last_ns[0], last_ns[1], last_ns[2] = 0, recorded_ns[i], own_ns[i]


UNKNOWN, LITTLE, BIG = 0, 1, 2
"""Byte orders; what is unknown is read as if it were little."""


def gather_into(records: bytes, places: I64, rows: U8) -> None:
    """Copy the bytes at each of n places into rows (n, n_bytes); ValueError past the end."""
    _gather(np.frombuffer(records, np.uint8), places, rows)


def find_alike(records: bytes, starts: I64, sizes: I64, least: int, mask: U8) -> BoolArray:
    """Tell which of n payloads begin like the first, (n,).

    Bytes count where the mask is not zero; ``least`` is the size that a payload must have,
    not less than that of the mask.
    """
    alike = sizes >= least
    _find_alike(np.frombuffer(records, np.uint8), starts, starts[0], mask, alike)
    return alike


def read_stamps(records: bytes, starts: I64, sizes: I64, orders: U8) -> tuple[I64, BoolArray]:
    """Return the stamps in the headers of n payloads (n,), in ns, and which can be read (n,).

    ``orders`` (256,) holds UNKNOWN, LITTLE or BIG for every second byte of a payload. A
    payload too short for a header has stamp 0.
    """
    stamps_ns, readable = np.empty(starts.size, np.int64), np.empty(starts.size, np.bool_)
    content = np.frombuffer(records, np.uint8)
    _read_stamps(content, starts, sizes, orders, stamps_ns, readable)
    return stamps_ns, readable


def measure_steps(
    recorded_ns: I64, own_ns: I64, used: BoolArray, last_ns: I64, limits_ns: I64, found: I64
) -> None:
    """Add up where two clocks part, where they pause and where one of them falls.

    ``recorded_ns`` and ``own_ns`` (n,) are the next messages, of which those ``used`` (n,)
    count; ``last_ns`` (3,) is the message before (-1 and two zeros before the first) and
    becomes the last one. ``found`` (3, 3) holds number, first moment and greatest length of
    steps that differ by more than ``limits_ns[0]``, of steps longer than ``limits_ns[1]``, and
    the number of steps of the second clock below 0.
    """
    _measure_steps(recorded_ns, own_ns, used, last_ns, limits_ns, found)
