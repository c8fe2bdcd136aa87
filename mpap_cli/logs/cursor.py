"""Fields of a message read one after the other, where they lie in its payload."""

import struct

import numpy as np

from mpap_cli.logs.fields import CDR_BYTE_ORDERS, FieldError
from mpap_cli.observations import NS_PER_S

_HEAD_BYTES = 4  # encapsulation or sequence number
_U32 = {"little": struct.Struct("<I"), "big": struct.Struct(">I")}
_FLOAT64 = {"little": np.dtype("<f8"), "big": np.dtype(">f8")}
_LAST_OF_XCDR1 = 1  # later encapsulations align numbers of 8 bytes to 4


class Cursor:
    """Reads a message that begins with std_msgs/Header, in CDR or as ROS 1 writes it.

    CDR aligns numbers to their size, behind 4 bytes of encapsulation, and ends texts with
    NUL; ROS 1 aligns nothing and is little endian. Nothing is copied.

    Parameters
    ----------
    payload : memoryview
        The message.
    encoding : {"cdr", "ros1"}
        How it is written.
    what : str
        What it is, for errors: ``an image``.
    headed : bool
        False: the message begins with a stamp; in ROS 1 a header has a number before it.

    Raises
    ------
    FieldError
        If it is no plain CDR; by each method: if the payload is cut short.

    Examples
    --------
    >>> at = Cursor(memoryview(bytes([0, 1, 0, 0, 2, 0, 0, 0, 5, 0, 0, 0])), "cdr", "a message")
    >>> at.stamp_ns()
    2000000005
    """

    def __init__(
        self, payload: memoryview, encoding: str, what: str, *, headed: bool = True
    ) -> None:
        self._payload = payload
        self._what = what
        self._place = _HEAD_BYTES if headed or encoding == "cdr" else 0
        self._order, self._most_aligned = "little", 1
        if encoding == "cdr":
            order = CDR_BYTE_ORDERS.get(payload[1]) if len(payload) >= _HEAD_BYTES else None
            if order is None:
                msg = f"{what} that is no plain CDR"
                raise FieldError(msg)
            self._order = order
            self._most_aligned = 8 if payload[1] <= _LAST_OF_XCDR1 else 4

    def stamp_ns(self) -> int:
        """Read seconds and nanoseconds."""
        return self.number() * NS_PER_S + self.number()

    def number(self) -> int:
        """Read four bytes."""
        begin = self._take(4, alignment=4)
        number: int = _U32[self._order].unpack_from(self._payload, begin)[0]
        return number

    def byte(self) -> int:
        """Read one byte."""
        return self._payload[self._take(1, alignment=1)]

    def sequence(self) -> memoryview:
        """Read the bytes that follow their number."""
        n_bytes = self.number()
        begin = self._take(n_bytes, alignment=1)
        return self._payload[begin : begin + n_bytes]

    def text(self) -> str:
        """Read a text; what is no UTF-8 is marked."""
        return bytes(self.sequence()).rstrip(b"\0").decode("utf-8", errors="replace")

    def doubles(self, n: int) -> tuple[int, "np.dtype[np.float64]"]:
        """Pass over numbers of 8 bytes; return the place of the first, and how they lie there."""
        return self._take(8 * n, alignment=8), _FLOAT64[self._order]

    def _take(self, n_bytes: int, alignment: int) -> int:
        """Pass over a field; return where it begins."""
        alignment = min(alignment, self._most_aligned)
        begin = self._place + (_HEAD_BYTES - self._place) % alignment
        self._place = begin + n_bytes
        if self._place > len(self._payload):
            msg = f"{self._what} cut short"
            raise FieldError(msg)
        return begin
