"""The stretch of a log that is being gathered into the next batch."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from mpap_cli.logs.bumps.bumpers import BumpPiece
from mpap_cli.logs.files.runs import END_NS
from mpap_cli.logs.image_runs import FramePiece
from mpap_cli.logs.odometry import PosePiece
from mpap_cli.logs.scan_runs import ScanPiece
from mpap_cli.logs.waiting import Piece, Waiting, WaitingFrames
from mpap_cli.observations import NS_PER_S, Batch, BoolArray, Bump, PoseBlock, ScanBlock

_MAX_SPAN_NS = 120 * NS_PER_S


class Events(NamedTuple):
    """What the messages of a stretch of a log tell, by kind."""

    scans: list[ScanPiece]
    bumps: list[BumpPiece]
    frames: list[FramePiece]
    poses: list[PosePiece]


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

    def in_time(self, pieces: Sequence[Piece]) -> list[BoolArray]:
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
    """Gathers scans, bumps, images and poses until a batch is due.

    Parameters
    ----------
    block_scans : int
        Scans that make a batch.
    sensors : mapping of str to int
        The numbers that the codes of bumps speak of; may grow.
    changes_only : bool
        Whether a bump that repeats the state of its sensor is left out.
    with_poses : bool
        Whether batches have poses, even if there are none.

    Notes
    -----
    The image with which 512 or 32 MB are reached makes a batch too, so that memory does not
    grow with their size.
    """

    def __init__(
        self,
        block_scans: int,
        sensors: Mapping[str, int],
        *,
        changes_only: bool,
        with_poses: bool = False,
    ) -> None:
        self._block_scans = block_scans
        self._sensors = sensors
        self._changes_only = changes_only
        self._with_poses = with_poses
        self._scans: Waiting[ScanPiece] = Waiting()
        self._frames = WaitingFrames()
        self._poses: Waiting[PosePiece] = Waiting()
        self._bumps = BumpPiece(*np.empty((3, 0), dtype=np.int64))
        self._pressed: dict[int, int] = {}

    def add(
        self,
        scans: Sequence[ScanPiece],
        bumps: Sequence[BumpPiece],
        frames: Sequence[FramePiece] = (),
        poses: Sequence[PosePiece] = (),
    ) -> None:
        """Take events in; none may lie in a batch that is gone."""
        self._scans.add(scans)
        self._frames.add(frames)
        self._poses.add(poses)
        if bumps:
            together = np.concatenate([np.array(piece) for piece in (self._bumps, *bumps)], 1)
            merged = BumpPiece(*together)
            self._bumps = merged.rows(np.lexsort((merged.recorded_ns, merged.stamps_ns)))

    def batches(self, settled_ns: int) -> Iterator[Batch]:
        """Take out the batches that are complete if nothing comes stamped before a moment.

        Bumps with one stamp are in the order of their log time; where that is one too,
        in the order in which they were added.
        """
        while (last_ns := self._last_moment()) is not None and last_ns < settled_ns:
            scans, frames = self._scans.take(last_ns), self._frames.take(last_ns)
            poses = self._poses.take(last_ns)
            n_bumps = np.searchsorted(self._bumps.stamps_ns, last_ns, side="right")
            bumps = self._bumps.rows(slice(n_bumps))
            self._bumps = self._bumps.rows(slice(n_bumps, None))
            pieces: tuple[Piece, ...] = (*scans, *frames, *poses, bumps)
            yield Batch(
                max(int(piece.stamps_ns[-1]) for piece in pieces if len(piece.stamps_ns)),
                _blocks(scans),
                tuple(self._changes(bumps)),
                tuple(frame for piece in frames for frame in piece.frames),
                _joined(poses) if self._with_poses else None,
            )

    def _last_moment(self) -> int | None:
        """Return the last moment of the next batch; None if there is nothing for one."""
        first = [self._scans.first_ns, self._frames.first_ns, self._poses.first_ns]
        waiting = [moment for moment in first if moment is not None]
        waiting += self._bumps.stamps_ns[:1].tolist()
        if not waiting:
            return None
        full = (self._scans.moment_of(self._block_scans), self._frames.full_ns())
        due = [moment for moment in full if moment is not None]
        return min([min(waiting) + _MAX_SPAN_NS, *due])

    def _changes(self, bumps: BumpPiece) -> Iterator[Bump]:
        """Leave out bumps that say nothing new."""
        if not bumps.codes.size:
            return
        names = list(self._sensors)
        if self._changes_only:
            bumps = bumps.rows(np.flatnonzero(np.diff(bumps.codes, prepend=-1)))
        for stamp_ns, code in zip(bumps.stamps_ns.tolist(), bumps.codes.tolist(), strict=True):
            sensor, pressed = divmod(code, 2)
            if not self._changes_only or self._pressed.get(sensor) != pressed:
                self._pressed[sensor] = pressed
                yield Bump(stamp_ns, names[sensor], pressed=pressed == 1)


def _blocks(pieces: Sequence[ScanPiece]) -> tuple[ScanBlock, ...]:
    """Join scans that follow one another with one geometry."""
    blocks = []
    for geometry, group in groupby(pieces, attrgetter("geometry")):
        same = list(group)
        stamps_ns, ranges = same[0].stamps_ns, same[0].held
        if len(same) > 1 or not isinstance(ranges, np.ndarray):
            stamps_ns = np.concatenate([piece.stamps_ns for piece in same])
            ranges = np.empty((stamps_ns.size, geometry.n_beams), np.float32)
            ends = np.cumsum([len(piece.stamps_ns) for piece in same]).tolist()
            for piece, begin, end in zip(same, [0, *ends], ends, strict=False):
                piece.write(ranges[begin:end])
        blocks.append(ScanBlock(stamps_ns, ranges, geometry))
    return tuple(blocks)


def _joined(pieces: Sequence[PosePiece]) -> PoseBlock:
    """Join poses that follow one another."""
    stamps_ns = [np.empty(0, dtype=np.int64), *(piece.stamps_ns for piece in pieces)]
    poses = [np.empty((0, 3)), *(piece.poses for piece in pieces)]
    return PoseBlock(np.concatenate(stamps_ns), np.concatenate(poses))
