"""Events of one kind that wait for their batch."""

from collections import deque
from collections.abc import Sequence
from typing import Generic, Protocol, Self, TypeVar

import numpy as np

from mpap_cli.logs.image_runs import FramePiece
from mpap_cli.observations import BoolArray, IntArray

MAX_FRAMES = 512
MAX_FRAME_BYTES = 32 << 20


class Piece(Protocol):
    """Events of one kind that follow one another in log time."""

    @property
    def recorded_ns(self) -> IntArray:
        """Log time, (n,)."""
        ...

    @property
    def stamps_ns(self) -> IntArray:
        """The time wanted, (n,)."""
        ...

    def rows(self, rows: IntArray | BoolArray | slice) -> Self:
        """Return some of the events."""
        ...


P = TypeVar("P", bound=Piece)


class Waiting(Generic[P]):
    """Pieces of one kind, in time order."""

    def __init__(self) -> None:
        self._pieces: deque[P] = deque()
        self._n_events = 0

    @property
    def first_ns(self) -> int | None:
        """Stamp of the first event; None where none waits."""
        return int(self._pieces[0].stamps_ns[0]) if self._pieces else None

    def add(self, pieces: Sequence[P]) -> None:
        """Take events in, and sort them where need be; equal stamps stay as they came."""
        more = [piece for piece in pieces if len(piece.stamps_ns)]
        if not more:
            return
        ends_ns = [self._pieces[-1].stamps_ns[-1]] if self._pieces else []
        in_order = True
        for piece in more:
            stamps_ns = piece.stamps_ns
            in_order &= not ends_ns or bool(ends_ns[-1] <= stamps_ns[0])
            in_order &= not (stamps_ns[1:] < stamps_ns[:-1]).any()
            ends_ns.append(stamps_ns[-1])
            self._n_events += len(stamps_ns)
        self._pieces.extend(more)
        if not in_order:
            self._pieces = _in_order(self._pieces)

    def moment_of(self, number: int) -> int | None:
        """Return the stamp of an event, counted from 1; None where not so many wait."""
        if number > self._n_events:
            return None
        pieces = iter(self._pieces)
        stamps_ns = next(pieces).stamps_ns
        while number > len(stamps_ns):
            number -= len(stamps_ns)
            stamps_ns = next(pieces).stamps_ns
        return int(stamps_ns[number - 1])

    def take(self, last_ns: int) -> list[P]:
        """Take out the events up to a moment."""
        taken: list[P] = []
        while self._pieces and self._pieces[0].stamps_ns[0] <= last_ns:
            piece = self._pieces.popleft()
            n_taken = int(np.searchsorted(piece.stamps_ns, last_ns, side="right"))
            self._n_events -= n_taken
            taken.append(piece.rows(slice(n_taken)))
            if n_taken < len(piece.stamps_ns):
                self._pieces.appendleft(piece.rows(slice(n_taken, None)))
        return taken


class WaitingFrames(Waiting[FramePiece]):
    """Images in time order; they are large, so that they make a batch due."""

    def __init__(self) -> None:
        super().__init__()
        self._n_bytes = 0

    def add(self, pieces: Sequence[FramePiece]) -> None:
        """Take images in."""
        super().add(pieces)
        self._n_bytes += sum(piece.n_bytes for piece in pieces)

    def take(self, last_ns: int) -> list[FramePiece]:
        """Take out the images up to a moment."""
        taken = super().take(last_ns)
        self._n_bytes -= sum(piece.n_bytes for piece in taken)
        return taken

    def full_ns(self) -> int | None:
        """Return the stamp of the image that makes a batch full; None if none does."""
        if self._n_events < MAX_FRAMES and self._n_bytes < MAX_FRAME_BYTES:
            return None
        frames = [frame for piece in self._pieces for frame in piece.frames[:MAX_FRAMES]]
        gathered = np.cumsum([len(frame.payload) for frame in frames[:MAX_FRAMES]])
        number = min(int(np.searchsorted(gathered, MAX_FRAME_BYTES)), len(gathered) - 1)
        return frames[number].stamp_ns


def _in_order(pieces: deque[P]) -> deque[P]:
    """Sort events by stamp; equal stamps stay as they came."""
    stamps_ns = np.concatenate([piece.stamps_ns for piece in pieces])
    order = np.argsort(stamps_ns, kind="stable")
    lengths = [len(piece.stamps_ns) for piece in pieces]
    which = np.repeat(np.arange(len(pieces)), lengths)[order]
    rows = np.concatenate([np.arange(length) for length in lengths])[order]
    cuts = np.flatnonzero(np.diff(which)) + 1
    return deque(
        pieces[which[begin]].rows(rows[begin:end])
        for begin, end in zip([0, *cuts], [*cuts, len(order)], strict=True)
    )
