"""A remote file as a stream that fetches what is read, and a little ahead."""

import io
from collections import OrderedDict
from collections.abc import Callable
from threading import Lock

LEAST_BYTES, MOST_BYTES = 1 << 14, 1 << 22
"""So much is fetched ahead: at least, and at most."""

KEPT_BYTES = 1 << 25
"""So much of one file stays in memory: what is looked over first is read once more later."""

_GAP_BYTES = 1 << 16


class NotInPlaceError(Exception):
    """A file has to be read from its beginning to its end; says why."""


class Blocks:
    """What was fetched of one file last, for all streams of it.

    Examples
    --------
    >>> blocks = Blocks()
    >>> blocks.add(10, b"scan")
    >>> bytes(blocks.at(12)), bytes(blocks.at(14)), blocks.next_after(3)
    (b'an', b'', 10)
    """

    def __init__(self) -> None:
        self._held: OrderedDict[int, bytes] = OrderedDict()
        self._lock = Lock()

    def add(self, begin: int, block: bytes) -> None:
        """Keep a block; the oldest ones go."""
        with self._lock:
            self._held[begin] = block
            self._held.move_to_end(begin)
            while len(self._held) > 1 and sum(map(len, self._held.values())) > KEPT_BYTES:
                self._held.popitem(last=False)

    def at(self, position: int) -> memoryview:
        """Return what is held from a position on without a gap; empty if nothing is."""
        with self._lock:
            for begin, block in reversed(self._held.items()):
                if begin <= position < begin + len(block):
                    return memoryview(block)[position - begin :]
        return memoryview(b"")

    def next_after(self, position: int) -> int | None:
        """Return where the next block behind a position begins."""
        with self._lock:
            return min((begin for begin in self._held if begin > position), default=None)


class RangeStream(io.RawIOBase):
    """A file of known size, read by ranges; ``size`` is in bytes.

    Notes
    -----
    Chunks of a log are much alike, so behind a jump as much is fetched at once as was read
    in one go before. Where reading goes on without a jump, the read-ahead doubles.
    """

    def __init__(self, size: int, fetch: Callable[[int, int], bytes], blocks: Blocks) -> None:
        self.size = size
        self._fetch = fetch
        self._blocks = blocks
        self._position = 0
        self._ahead = LEAST_BYTES
        self._last_fetched = 0
        self._burst_begin = self._burst_end = 0

    def readable(self) -> bool:
        """Return True."""
        return True

    def seekable(self) -> bool:
        """Return True."""
        return True

    def tell(self) -> int:
        """Return the position."""
        return self._position

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a position; behind the end nothing is read."""
        start = {io.SEEK_SET: 0, io.SEEK_CUR: self._position, io.SEEK_END: self.size}[whence]
        self._position = max(0, start + offset)
        return self._position

    def read(self, size: int | None = -1) -> bytes:
        """Read that many bytes, fewer at the end of the file.

        Raises
        ------
        OSError
            If they cannot be fetched.
        """
        begin = self._position
        rest = max(0, self.size - begin)
        end = begin + (rest if size is None or size < 0 else min(size, rest))
        self._note_jump(begin)
        parts = []
        while begin < end:
            part = self._blocks.at(begin)[: end - begin]
            if not part:
                self._fetch_from(begin, end)
            parts.append(part)
            begin += len(part)
        self._position = self._burst_end = end
        return b"".join(parts)

    def _note_jump(self, begin: int) -> None:
        """Behind a jump, read ahead as much as the last stretch was long."""
        if self._burst_begin <= begin <= self._burst_end + _GAP_BYTES:
            return
        stretch = self._burst_end - self._burst_begin
        self._ahead = max(LEAST_BYTES, min(stretch + stretch // 8, MOST_BYTES))
        self._burst_begin = self._burst_end = begin

    def _fetch_from(self, begin: int, end: int) -> None:
        """Fetch what is missing, and some more, up to what is held."""
        if begin - self._burst_begin > self._ahead:
            self._ahead = min(max(2 * self._ahead, self._last_fetched), MOST_BYTES)
        until = min(max(end, begin + self._ahead), self.size)
        following = self._blocks.next_after(begin)
        until = until if following is None else min(until, following)
        # footers are small, and what they tell of lies before them
        first = begin if until < self.size else min(begin, max(0, self.size - LEAST_BYTES))
        self._blocks.add(first, self._fetch(first, until))
        self._last_fetched = until - first
