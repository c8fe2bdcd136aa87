"""Runs of messages that begin alike are read at once: where their fields lie, their stamps."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mpap_cli.logs.fields import CDR_BYTE_ORDERS, FieldError
from mpap_cli.logs.raw import RawRun
from mpap_cli.observations import BoolArray, IntArray

_MAX_COMPARED = 8
_STAMP = slice(4, 12)
_SEQUENCE = slice(4)


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
    from mpap_cli.logs import _kernels  # noqa: PLC0415  # numba is slow to import

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
        left = left[~alike] if not alike.all() else left[:0]
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
    from mpap_cli.logs import _kernels  # noqa: PLC0415  # numba is slow to import

    rows = np.empty((places.size, n_bytes), np.uint8)
    _kernels.gather_into(records, places, rows)
    return rows


def gather_into(records: bytes, places: IntArray, rows: NDArray[np.uint8]) -> None:
    """Copy the bytes at each of n places into rows (n, n_bytes)."""
    from mpap_cli.logs import _kernels  # noqa: PLC0415  # numba is slow to import

    _kernels.gather_into(records, places, rows)


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
    from mpap_cli.logs import _kernels  # noqa: PLC0415  # numba is slow to import

    orders = np.full(256, _kernels.LITTLE, np.uint8)
    if run.topic.encoding == "cdr":
        orders[:] = _kernels.UNKNOWN
        for number, order in CDR_BYTE_ORDERS.items():
            orders[number] = _kernels.BIG if order == "big" else _kernels.LITTLE
    return _kernels.read_stamps(run.records, run.starts, run.sizes, orders)
