"""The stretch of a log that is being gathered into the next batch."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from operator import attrgetter

import numpy as np

from mpap_cli.logs.bumps.bumpers import BumpPiece
from mpap_cli.logs.files.runs import END_NS
from mpap_cli.logs.scan_runs import ScanPiece
from mpap_cli.observations import NS_PER_S, Batch, BoolArray, Bump, ScanBlock

_MAX_SPAN_NS = 120 * NS_PER_S


class Arrivals:
    """Tells what is stamped long before something that was recorded earlier.

    Parameters
    ----------
    margin_ns : int
        An event may be stamped so long before the latest one recorded up to its own log
        time.

    Attributes
    ----------
    settled_ns : int
        What is yet to come and is not too late is not stamped before this.
    """

    def __init__(self, margin_ns: int) -> None:
        self._margin_ns = margin_ns
        self.settled_ns = -END_NS

    def in_time(self, pieces: Sequence[ScanPiece | BumpPiece]) -> list[BoolArray]:
        """Tell of each event of the next stretch of a log whether it is not too late."""
        if not pieces:
            return []
        recorded_ns = np.concatenate([piece.recorded_ns for piece in pieces])
        stamps_ns = np.concatenate([piece.stamps_ns for piece in pieces])
        order = np.argsort(recorded_ns, kind="stable")
        before = np.array([self.settled_ns + self._margin_ns])
        latest = np.maximum.accumulate(np.concatenate([before, stamps_ns[order]]))
        n_recorded = np.searchsorted(recorded_ns[order], recorded_ns, side="right")
        in_time: BoolArray = stamps_ns >= latest[n_recorded] - self._margin_ns
        self.settled_ns = int(latest[-1]) - self._margin_ns
        return np.split(in_time, np.cumsum([len(piece.stamps_ns) for piece in pieces])[:-1])


class Window:
    """Gathers scans and bumps until a batch is due.

    Parameters
    ----------
    block_scans : int
        Scans that make a batch.
    sensors : mapping of str to int
        The numbers that the codes of bumps speak of; may grow.
    changes_only : bool
        Whether a bump that repeats the state of its sensor is left out.
    """

    def __init__(self, block_scans: int, sensors: Mapping[str, int], *, changes_only: bool) -> None:
        self._block_scans = block_scans
        self._sensors = sensors
        self._changes_only = changes_only
        self._scans: list[ScanPiece] = []
        self._bumps = BumpPiece(*np.empty((3, 0), dtype=np.int64))
        self._pressed: dict[int, int] = {}

    def add(self, scans: Sequence[ScanPiece], bumps: Sequence[BumpPiece]) -> None:
        """Take events in; none may lie in a batch that is gone."""
        self._scans = _in_order([*self._scans, *(piece for piece in scans if len(piece.stamps_ns))])
        merged = BumpPiece(*np.concatenate([np.array(piece) for piece in (self._bumps, *bumps)], 1))
        self._bumps = merged.rows(np.lexsort((merged.recorded_ns, merged.stamps_ns)))

    def batches(self, settled_ns: int) -> Iterator[Batch]:
        """Take out the batches that are complete if nothing comes stamped before a moment.

        Bumps with one stamp are in the order of their log time; where that is one too,
        in the order in which they were added.
        """
        while self._scans or len(self._bumps.codes):
            last_ns = self._last_moment()
            if last_ns >= settled_ns:
                break
            scans = self._take_scans(last_ns)
            n_bumps = np.searchsorted(self._bumps.stamps_ns, last_ns, side="right")
            bumps = self._bumps.rows(slice(n_bumps))
            self._bumps = self._bumps.rows(slice(n_bumps, None))
            stamps_ns = [piece.stamps_ns[-1] for piece in scans] + [*bumps.stamps_ns[-1:]]
            yield Batch(int(max(stamps_ns)), _blocks(scans), tuple(self._changes(bumps)))

    def _last_moment(self) -> int:
        """Return the last moment of the next batch."""
        first = [piece.stamps_ns[0] for piece in self._scans] + [*self._bumps.stamps_ns[:1]]
        last_ns = int(min(first)) + _MAX_SPAN_NS
        n_due = self._block_scans
        for piece in self._scans:
            if n_due <= len(piece.stamps_ns):
                return min(last_ns, int(piece.stamps_ns[n_due - 1]))
            n_due -= len(piece.stamps_ns)
        return last_ns

    def _take_scans(self, last_ns: int) -> list[ScanPiece]:
        """Take out the scans up to a moment."""
        taken: list[ScanPiece] = []
        while self._scans and self._scans[0].stamps_ns[0] <= last_ns:
            piece = self._scans.pop(0)
            n_taken = int(np.searchsorted(piece.stamps_ns, last_ns, side="right"))
            taken.append(piece.rows(slice(n_taken)))
            if n_taken < len(piece.stamps_ns):
                self._scans.insert(0, piece.rows(slice(n_taken, None)))
        return taken

    def _changes(self, bumps: BumpPiece) -> Iterator[Bump]:
        """Leave out bumps that say nothing new."""
        names = list(self._sensors)
        if self._changes_only:
            bumps = bumps.rows(np.flatnonzero(np.diff(bumps.codes, prepend=-1)))
        for stamp_ns, code in zip(bumps.stamps_ns.tolist(), bumps.codes.tolist(), strict=True):
            sensor, pressed = divmod(code, 2)
            if not self._changes_only or self._pressed.get(sensor) != pressed:
                self._pressed[sensor] = pressed
                yield Bump(stamp_ns, names[sensor], pressed=pressed == 1)


def _in_order(pieces: list[ScanPiece]) -> list[ScanPiece]:
    """Sort scans by stamp, where they are not; equal stamps stay as they came."""
    if len(pieces) == 0:
        return pieces
    stamps_ns = np.concatenate([piece.stamps_ns for piece in pieces])
    if (np.diff(stamps_ns) >= 0).all():
        return pieces
    order = np.argsort(stamps_ns, kind="stable")
    lengths = [len(piece.stamps_ns) for piece in pieces]
    which = np.repeat(np.arange(len(pieces)), lengths)[order]
    rows = np.concatenate([np.arange(length) for length in lengths])[order]
    cuts = np.flatnonzero(np.diff(which)) + 1
    return [
        pieces[which[begin]].rows(rows[begin:end])
        for begin, end in zip([0, *cuts], [*cuts, len(order)], strict=True)
    ]


def _blocks(pieces: Sequence[ScanPiece]) -> tuple[ScanBlock, ...]:
    """Join scans that follow one another with one geometry."""
    blocks = []
    for geometry, group in groupby(pieces, attrgetter("geometry")):
        same = list(group)
        stamps_ns, ranges = same[0].stamps_ns, same[0].ranges
        if len(same) > 1:
            stamps_ns = np.concatenate([piece.stamps_ns for piece in same])
            ranges = np.concatenate([piece.ranges for piece in same])
        blocks.append(ScanBlock(stamps_ns, ranges, geometry))
    return tuple(blocks)
