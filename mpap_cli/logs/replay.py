"""A log played back: blocks of scans and bumps, in time order (Figure 1)."""

import logging
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from mpap_cli.errors import SettingError
from mpap_cli.logs.bumps.bumpers import BumpDecoder, BumpKind, BumpPiece
from mpap_cli.logs.fields import FieldError, TimeSource, scan_view
from mpap_cli.logs.files.runs import END_NS
from mpap_cli.logs.listing import messages_of
from mpap_cli.logs.raw import LogReader, RawRun, RunGroup
from mpap_cli.logs.scan_runs import ScanPiece, read_scans
from mpap_cli.logs.survey import is_broken, survey_beams
from mpap_cli.logs.times import parse_time
from mpap_cli.logs.topics import Roles
from mpap_cli.logs.windows import Arrivals, Window
from mpap_cli.observations import NS_PER_S, Batch
from mpap_cli.params import BumperParams

__all__ = ["Replay", "ReplayOptions", "parse_time"]

_LOG = logging.getLogger(__name__)

_HEADER_MARGIN_NS = 2 * NS_PER_S
_LATE = "stamped before what came earlier"
_BROKEN = "a scan with fewer than half the usual beams"
_BAD_BUMP = "a bump message that does not fit its definition"


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOptions:
    """Which part of a log is played back, by which clock, in blocks of what size.

    ``start`` and ``end`` are as `parse_time` reads them and cut by log time, start <= t <
    end; ``time_source`` is the clock of the stamps that come out.
    """

    start: str | None = None
    end: str | None = None
    time_source: TimeSource = "log"
    block_scans: int = 1024


class Replay:
    """Iterates over the batches of a log; each iteration reads the log anew.

    Parameters
    ----------
    reader : LogReader
        An open log.
    roles : Roles
        The topics to play back; bumps alone or scans alone will do.
    bumper : BumperParams
        How long a touch lasts, and which simulated contacts do not count.
    options : ReplayOptions, optional
        By default the whole log by log time.

    Attributes
    ----------
    start_ns, end_ns : int
        First and last moment, by the clock of the stamps: of the whole log, or of the cut.
    bump_kind : {"level", "edge", "pulse"} or None
        How the bumps are to be read; None without a bumper. Several topics are joined,
        one sensor (or more) a topic; topics of different kinds count as edges.
    hold_s : float
        Seconds that a touch lasts, if the bumps are pulses.
    skipped : Counter of str
        After an iteration: messages left out, by reason.

    Raises
    ------
    SettingError
        If `start` or `end` is no time, or the start is not before the end.

    Notes
    -----
    A batch ends after ``block_scans`` scans or two minutes, whatever comes first; a block in it
    ends where the geometry changes. Only the first message of a sensor and its changes
    become bumps; of pulses every touch. A cut that misses the log gives no batch, and one
    warning. With ``header`` stamps messages may come out of order: they are sorted within
    2 s, and left out where they are later than that.
    """

    def __init__(
        self,
        reader: LogReader,
        roles: Roles,
        bumper: BumperParams,
        options: ReplayOptions | None = None,
    ) -> None:
        self._reader = reader
        self._roles = roles
        self._bumper = bumper
        self._options = options or ReplayOptions()
        self._start_ns, self._end_ns = _cut(reader, self._options)
        self._usual_beams: float | None = None
        kinds = {role.rule.kind for role in roles.bumps}
        self.bump_kind: BumpKind | None = None
        if kinds:
            self.bump_kind = kinds.pop() if len(kinds) == 1 else "edge"
        held = [role.rule.hold_s for role in roles.bumps if role.rule.hold_s is not None]
        self.hold_s = max(held, default=bumper.bump_hold)
        shift_ns = self._clock_shift_ns()
        self.start_ns = shift_ns + max(reader.start_ns, self._start_ns or reader.start_ns)
        last_ns = reader.end_ns if self._end_ns is None else self._end_ns - 1
        self.end_ns = shift_ns + min(reader.end_ns, last_ns)
        if self.end_ns < self.start_ns:
            _LOG.warning("%s: nothing lies between --start and --end", reader.path.name)
            self.end_ns = self.start_ns
        self.skipped: Counter[str] = Counter()

    def __iter__(self) -> Iterator[Batch]:
        """Yield the batches in time order."""
        self.skipped.clear()
        sensors: dict[str, int] = {}
        window = Window(self._options.block_scans, sensors, changes_only=self.bump_kind != "pulse")
        decoders, arrivals = self._decoders(sensors), Arrivals(_HEADER_MARGIN_NS)
        for settled_ns, runs in self._groups():
            scans = [
                piece
                for run in runs
                if run.topic.name not in decoders
                for piece in self._read_scans(run)
            ]
            bumps = [
                self._read_bumps(run, decoders[topic])
                for topic in decoders
                for run in runs
                if run.topic.name == topic
            ]
            by_header = self._options.time_source == "header"
            if by_header:
                scans, bumps = self._in_time(arrivals, scans, bumps)
            window.add(scans, bumps)
            yield from window.batches(arrivals.settled_ns if by_header else settled_ns)
        yield from window.batches(END_NS)

    def _groups(self) -> Iterator[RunGroup]:
        """Yield the messages of the roles' topics within the cut."""
        topics = [role.topic for role in self._roles.bumps]
        if self._roles.scan is not None:
            topics.append(self._roles.scan)
        msgtypes = {topic.name: topic.msgtype for topic in topics}
        for until_ns, runs in self._reader.runs(msgtypes.keys(), self._start_ns, self._end_ns):
            fitting = [run for run in runs if run.topic.msgtype == msgtypes[run.topic.name]]
            yield RunGroup(until_ns, fitting)

    def _decoders(self, sensors: dict[str, int]) -> dict[str, BumpDecoder]:
        """Make the decoder of each bump topic."""
        several = len(self._roles.bumps) > 1
        decoders = {}
        for topic, rule in ((role.topic, role.rule) for role in self._roles.bumps):
            prefix = topic.name + (":" if rule.sensor_field else "") if several else ""
            decoders[topic.name] = BumpDecoder(
                self._reader,
                rule,
                self._bumper,
                time_source=self._options.time_source,
                prefix=prefix,
                sensors=sensors,
            )
        return decoders

    def _read_scans(self, run: RawRun) -> list[ScanPiece]:
        """Read scans; those that are broken are left out."""
        pieces, malformed = read_scans(run, self._options.time_source)
        self.skipped.update(malformed)
        if pieces and self._usual_beams is None:
            self._usual_beams = survey_beams(self._reader, run.topic)
        whole = [
            piece for piece in pieces if not is_broken(piece.geometry, self._usual_beams or 0.0)
        ]
        if len(whole) < len(pieces):
            n_whole = sum(len(piece.stamps_ns) for piece in whole)
            self.skipped[_BROKEN] += sum(len(piece.stamps_ns) for piece in pieces) - n_whole
        return whole

    def _read_bumps(self, run: RawRun, decoder: BumpDecoder) -> BumpPiece:
        """Read bumps; left out is what is broken, or no touch where only touches count."""
        piece, n_broken = decoder(run)
        if n_broken:
            self.skipped[_BAD_BUMP] += n_broken
        return piece.rows(piece.codes % 2 == 1) if self.bump_kind == "pulse" else piece

    def _in_time(
        self, arrivals: Arrivals, scans: list[ScanPiece], bumps: list[BumpPiece]
    ) -> tuple[list[ScanPiece], list[BumpPiece]]:
        """Leave out what is stamped long before what came earlier."""
        kept = arrivals.in_time([*scans, *bumps])
        if n_late := sum(int((~rows).sum()) for rows in kept):
            self.skipped[_LATE] += n_late
        return (
            [piece.rows(rows) for piece, rows in zip(scans, kept, strict=False)],
            [piece.rows(rows) for piece, rows in zip(bumps, kept[len(scans) :], strict=True)],
        )

    def _clock_shift_ns(self) -> int:
        """Tell how far the clock of the headers is from log time, by the first scan."""
        if self._options.time_source == "log" or self._roles.scan is None:
            return 0
        for message in messages_of(self._reader, self._roles.scan):
            try:
                return scan_view(message, "header")[0] - message.stamp_ns
            except FieldError:
                continue
        return 0


def _cut(reader: LogReader, options: ReplayOptions) -> tuple[int | None, int | None]:
    """Turn start and end into stamps; None where nothing is cut."""
    start = parse_time(options.start, reader.start_ns) if options.start is not None else None
    end = parse_time(options.end, reader.start_ns) if options.end is not None else None
    if start is not None and end is not None and start >= end:
        msg = f"--start {options.start} is not before --end {options.end}"
        raise SettingError(msg)
    return start, end
