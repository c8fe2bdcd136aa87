"""A log played back: scans, bumps, images and poses, in time order (Figure 1)."""

import logging
from collections import Counter
from collections.abc import Iterator, Sequence

from mpap_cli.logs.bumps.bumpers import BumpDecoder, BumpKind, BumpPiece
from mpap_cli.logs.clocks import ClockWatch, clock_shift_ns
from mpap_cli.logs.files.runs import END_NS
from mpap_cli.logs.image_runs import read_frames
from mpap_cli.logs.odometry import read_poses
from mpap_cli.logs.raw import LogReader, RawRun, RunGroup
from mpap_cli.logs.replay_options import ReplayOptions
from mpap_cli.logs.scan_runs import ScanPiece, read_scans
from mpap_cli.logs.survey import is_broken, survey_beams
from mpap_cli.logs.times import parse_time
from mpap_cli.logs.topics import Roles
from mpap_cli.logs.video.links import PacketLinks, links_before
from mpap_cli.logs.waiting import P
from mpap_cli.logs.windows import Arrivals, Events, Window
from mpap_cli.observations import NS_PER_S, Batch
from mpap_cli.params import BumperParams

__all__ = ["Replay", "ReplayOptions", "parse_time"]

_LOG = logging.getLogger(__name__)

_HEADER_MARGIN_NS = 2 * NS_PER_S
_LATE = "stamped before what came earlier"
_LATE_IMAGE, _LATE_POSE = f"an image {_LATE}", f"a pose {_LATE}"
_BROKEN = "a scan with fewer than half the usual beams"
_BAD_BUMP = "a bump message that does not fit its definition"


class Replay:
    """Iterates over the batches of a log; each iteration reads the log anew.

    Parameters
    ----------
    reader : LogReader
        An open log.
    roles : Roles
        The topics to play back; any of them alone will do.
    bumper : BumperParams
        How long a touch lasts, and which simulated contacts do not count.
    options : ReplayOptions, optional
        By default the whole log by log time, of its sensors the laser.

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
    A batch ends after ``block_scans`` scans, 512 images, 32 MB of images or two minutes,
    whatever comes first; a block in it ends where the geometry changes. Only the first
    message of a sensor and its changes become bumps; of pulses every touch. A cut that
    misses the log gives no batch, and one warning. With ``header`` stamps messages may come
    out of order: they are sorted within 2 s, and left out where they are later than that.
    The clock of the headers is told by the first scan; where scans are not asked for or
    there are none, by the first image, else by the first pose.
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
        self._start_ns, self._end_ns = self._options.cut(reader.start_ns)
        topics = {"scan": roles.scan, "image": roles.image, "odometry": roles.odometry}
        self._topics = {
            sensor: topic
            for sensor, topic in topics.items()
            if topic is not None and sensor in self._options.sensors
        }
        self._usual_beams: float | None = None
        kinds = {role.rule.kind for role in roles.bumps}
        self.bump_kind: BumpKind | None = None
        if kinds:
            self.bump_kind = kinds.pop() if len(kinds) == 1 else "edge"
        held = [role.rule.hold_s for role in roles.bumps if role.rule.hold_s is not None]
        self.hold_s = max(held, default=bumper.bump_hold)
        by_header = self._options.time_source == "header"
        shift_ns = clock_shift_ns(reader, self._topics) if by_header else 0
        self.start_ns = shift_ns + max(reader.start_ns, self._start_ns or reader.start_ns)
        last_ns = reader.end_ns if self._end_ns is None else self._end_ns - 1
        self.end_ns = shift_ns + min(reader.end_ns, last_ns)
        if self.end_ns < self.start_ns:
            _LOG.warning("%s: nothing lies between --start and --end", reader.path.name)
            self.end_ns = self.start_ns
        self.skipped: Counter[str] = Counter()
        self._watches: dict[str, ClockWatch] = {}

    def clock_findings(self) -> tuple[str, ...]:
        """Say after an iteration what is odd about the clocks of its sensors."""
        return tuple(text for watch in self._watches.values() for text in watch.findings())

    def __iter__(self) -> Iterator[Batch]:
        """Yield the batches in time order."""
        self.skipped.clear()
        self._watches.clear()
        sensors: dict[str, int] = {}
        window = Window(
            self._options.block_scans,
            sensors,
            changes_only=self.bump_kind != "pulse",
            with_poses="odometry" in self._topics,
        )
        decoders, arrivals = self._decoders(sensors), Arrivals(_HEADER_MARGIN_NS)
        links = PacketLinks()
        if "image" in self._topics:
            links = links_before(self._reader, self._topics["image"], self._start_ns)
        for settled_ns, runs in self._groups():
            events = self._read(runs, decoders, links)
            by_header = self._options.time_source == "header"
            if by_header:
                events = self._in_time(arrivals, events)
            window.add(*events)
            yield from window.batches(arrivals.settled_ns if by_header else settled_ns)
        yield from window.batches(END_NS)

    def _groups(self) -> Iterator[RunGroup]:
        """Yield the messages of the topics to play back, within the cut."""
        topics = [*(role.topic for role in self._roles.bumps), *self._topics.values()]
        msgtypes = {topic.name: topic.msgtype for topic in topics}
        for until_ns, runs in self._reader.runs(msgtypes.keys(), self._start_ns, self._end_ns):
            fitting = [run for run in runs if run.topic.msgtype == msgtypes[run.topic.name]]
            yield RunGroup(until_ns, fitting)

    def _read(
        self, runs: Sequence[RawRun], decoders: dict[str, BumpDecoder], links: PacketLinks
    ) -> Events:
        """Read the messages of all topics."""
        events = Events([], [], [], [])
        clock = self._options.time_source
        sensors = {topic.name: sensor for sensor, topic in self._topics.items()}
        for run in runs:
            sensor = sensors.get(run.topic.name)
            if sensor is not None:
                self._watch(run)
            if sensor == "scan":
                events.scans.extend(self._read_scans(run))
            elif sensor == "image":
                events.frames.append(self._count(*read_frames(run, clock, links)))
            elif sensor == "odometry":
                events.poses.append(self._count(*read_poses(run, clock)))
        for name, decoder in decoders.items():
            same = (run for run in runs if run.topic.name == name)
            events.bumps.extend(self._read_bumps(run, decoder) for run in same)
        return events

    def _watch(self, run: RawRun) -> None:
        """Look at the clocks of a sensor."""
        name = run.topic.name
        if name not in self._watches:
            self._watches[name] = ClockWatch(name, self._reader.start_ns)
        self._watches[name].add(run)

    def _count(self, found: P, skipped: Counter[str]) -> P:
        """Add up what was left out."""
        self.skipped.update(skipped)
        return found

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

    def _in_time(self, arrivals: Arrivals, events: Events) -> Events:
        """Leave out what is stamped long before what came earlier."""
        kept = iter(arrivals.in_time([piece for pieces in events for piece in pieces]))

        def timely(pieces: list[P], late: str) -> list[P]:
            rows = [next(kept) for _ in pieces]
            if n_late := sum(int((~in_time).sum()) for in_time in rows):
                self.skipped[late] += n_late
            return [piece.rows(in_time) for piece, in_time in zip(pieces, rows, strict=True)]

        return Events(
            timely(events.scans, _LATE),
            timely(events.bumps, _LATE),
            timely(events.frames, _LATE_IMAGE),
            timely(events.poses, _LATE_POSE),
        )
