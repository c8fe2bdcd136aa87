"""Runs of messages that begin alike are read at once: where their fields lie, their stamps."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mpap_cli.logs.fields import CDR_BYTE_ORDERS, FieldError
from mpap_cli.logs.raw import RawRun
from mpap_cli.observations import NS_PER_S, BoolArray, IntArray

_MAX_COMPARED = 8
_HEAD_BYTES = 16  # encapsulation or sequence number, stamp, length of the frame name
_STAMP = slice(4, 12)
_SEQUENCE = slice(4)
_BIG = [number for number, order in CDR_BYTE_ORDERS.items() if order == "big"]


class Layout(Protocol):
    """Where the numbers of a message lie in its payload."""

    @property
    def place(self) -> int:
        """Where the first begins."""
        ...

    @property
    def n_bytes(self) -> int:
        """Size of all."""
        ...


L = TypeVar("L", bound=Layout)


def locate_alike(
    run: RawRun, locate: Callable[[bytes, str], L], ignored: Sequence[slice] = ()
) -> tuple[IntArray, list[L], Counter[str]]:
    """Return which layout each message has, -1 for none, the layouts, and why there is none.

    One message is read, and those that begin like it, up to its numbers, have its layout.
    Where new layouts keep coming, each message is read.

    Parameters
    ----------
    run : RawRun
        Messages that begin with std_msgs/Header, ``cdr`` or ``ros1``.
    locate : callable
        Finds the layout of a payload in an encoding; FieldError where it has none.
    ignored : sequence of slice
        Bytes before the numbers that may differ, beside the stamp.
    """
    from mpap_cli.logs.files import _kernels  # noqa: PLC0415  # numba is slow to import

    skipped: Counter[str] = Counter()
    layouts: list[L] = []
    kinds = np.full(len(run), -1)
    left = np.arange(len(run))
    while left.size:
        try:
            layout = locate(run.payload(left[0]), run.topic.encoding)
        except FieldError as err:
            skipped[str(err)] += 1
            left = left[1:]
            continue
        kinds[left[0]] = len(layouts)
        layouts.append(layout)
        if len(layouts) > _MAX_COMPARED:
            left = left[1:]
            continue
        least = layout.place + layout.n_bytes
        mask = _mask(layout.place, run.topic.encoding, ignored)
        alike = _kernels.find_alike(run.records, run.starts[left], run.sizes[left], least, mask)
        kinds[left[alike]] = len(layouts) - 1
        left = left[~alike]
    return kinds, layouts, skipped


def _mask(size: int, encoding: str, ignored: Sequence[slice]) -> NDArray[np.uint8]:
    """Mark the bytes that must be equal for the same layout."""
    mask = np.full(size, 255, np.uint8)
    for free in (_STAMP, *ignored):
        mask[free] = 0
    if encoding == "ros1":
        mask[_SEQUENCE] = 0
    return mask


def gather(records: bytes, places: IntArray, n_bytes: int) -> NDArray[np.uint8]:
    """Return the ``n_bytes`` at each of n places as rows (n, n_bytes)."""
    from mpap_cli.logs.files import _kernels  # noqa: PLC0415  # numba is slow to import

    return _kernels.gather(records, places, n_bytes)


def header_stamps(run: RawRun) -> tuple[IntArray, BoolArray]:
    """Return the stamps inside messages that begin with std_msgs/Header.

    Parameters
    ----------
    run : RawRun
        Of encoding ``cdr`` or ``ros1``.

    Returns
    -------
    stamps_ns : ndarray of shape (n,)
        Nanoseconds.
    readable : ndarray of shape (n,)
        False where the payload is shorter than a header, or no plain CDR.
    """
    readable = run.sizes >= _HEAD_BYTES
    stamps_ns = np.zeros(len(run), np.int64)
    heads = gather(run.records, run.starts[readable], _STAMP.stop)
    words = heads[:, _STAMP].copy().view("<u4")
    if run.topic.encoding == "cdr":
        big = np.isin(heads[:, 1], _BIG)
        words[big] = words[big].byteswap()
        readable[readable] = np.isin(heads[:, 1], list(CDR_BYTE_ORDERS))
    seconds, nanoseconds = words.astype(np.int64).T
    stamps_ns[run.sizes >= _HEAD_BYTES] = seconds * NS_PER_S + nanoseconds
    return stamps_ns, readable
