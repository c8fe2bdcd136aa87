"""A log of a simulated robot, and the truth about its contacts."""

import csv
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from mpap_cli.errors import OutputError
from mpap_cli.logs.writing.writer import LogWriter
from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation import messages
from mpap_cli.simulation.bumper import Bumper
from mpap_cli.simulation.bumper_messages import BUMPER_TYPES, BumperTopic
from mpap_cli.simulation.laser import Laser, Scanner
from mpap_cli.simulation.robot import STEP_NS, Contact, Track, Walker
from mpap_cli.simulation.settings import PLACES, SimulationParams

SCAN_TOPIC = "/scan"
ODOM_TOPIC = "/odom"
COMMAND_TOPIC = "/cmd_vel"

_BLOCK_STEPS = 512
_BUMP_DELAY_NS = 1_000_000
_ODOM_DELAY_NS = 1_500_000
_SCAN_DELAY_NS = (3_000_000, 15_000_000)

_Event = tuple[int, str, str, dict[str, Any]]
"""Log time, topic, message type, fields."""


@dataclass(frozen=True, slots=True)
class TruthContact:
    """A contact as it was, whatever the bumper said: start <= t < end, log time."""

    start_ns: int
    end_ns: int
    visible: bool
    cause: str


@dataclass(frozen=True, slots=True)
class SimulatedLog:
    """What was written.

    ``contacts`` is the truth, also in ``truth_path``; stamps are log time.
    """

    path: Path
    truth_path: Path
    contacts: tuple[TruthContact, ...]
    n_scans: int
    n_messages: int
    start_ns: int
    end_ns: int


def simulate(path: Path, params: SimulationParams) -> SimulatedLog:
    """Write the log of a simulated robot, and the truth beside it.

    The truth is a table with the columns log, start_s, end_s, visible, cause; times count
    from the log's first message. Its name is the log's with ``.truth.csv`` behind it.
    The same settings give the same messages.

    Parameters
    ----------
    path : Path
        The log, a file or (rosbag2) a folder; must not exist.
    params : SimulationParams
        What to simulate and how to write it.

    Returns
    -------
    SimulatedLog

    Raises
    ------
    OutputError
        If the log exists or cannot be written.
    """
    truth_path = _truth_path(path)
    run = _Run(params)
    n_scans = n_messages = 0
    start_ns = end_ns = params.start_stamp_ns
    with LogWriter(path, params.container, params.compression) as writer:
        for topic, msgtype in run.topics():
            writer.add_topic(topic, msgtype)
        for stamp_ns, topic, msgtype, fields in run.events():
            writer.write(topic, msgtype, stamp_ns, fields)
            start_ns = stamp_ns if n_messages == 0 else start_ns
            end_ns = stamp_ns
            n_messages += 1
            n_scans += topic == SCAN_TOPIC
    contacts = tuple(run.true_contact(contact, end_ns) for contact in run.walker.contacts)
    _write_truth(truth_path, path.name, start_ns, contacts)
    return SimulatedLog(path, truth_path, contacts, n_scans, n_messages, start_ns, end_ns)


def _truth_path(path: Path) -> Path:
    """Return where the truth of a log goes; neither it nor a nameless log may be there."""
    if not path.name:
        msg = f"{path}: no name for a log; give a file or folder that is not there yet"
        raise OutputError(msg)
    truth_path = path.with_name(path.name + ".truth.csv")
    if truth_path.exists():
        msg = f"{truth_path}: exists; choose another name for the log"
        raise OutputError(msg)
    return truth_path


class _Run:
    """The world, the robot in it and its sensors, on the way through one log."""

    def __init__(self, params: SimulationParams) -> None:
        self.params = params
        place = PLACES[params.world]
        world_seed = params.seed if params.world_seed is None else params.world_seed
        world = place.build(np.random.default_rng((world_seed, 0)))
        forward_rad = math.radians(params.forward_deg)
        self.scanner = Scanner(forward_rad=forward_rad, no_return=params.no_return)
        self.walker = Walker(world, place.habits, params.seed)
        self.laser = Laser(world, self.scanner, params.seed)
        self.bumper = Bumper(params.start_stamp_ns, params.seed, params.faults)
        self.odometer = messages.Odometer(params.start_stamp_ns, params.seed)
        self.bumper_type = BUMPER_TYPES[params.bumper_name]
        self.bumper_topic = BumperTopic(self.bumper_type, params.start_stamp_ns)
        self._delays = np.random.default_rng((params.seed, 6))
        self._n_told = 0

    def topics(self) -> Iterator[tuple[str, str]]:
        """Yield name and type of every topic of the log."""
        if self.params.is_json:
            yield SCAN_TOPIC, "foxglove.LaserScan"
        else:
            yield self.params.tf_topic, "tf2_msgs/msg/TFMessage"
            yield SCAN_TOPIC, "sensor_msgs/msg/LaserScan"
            yield ODOM_TOPIC, "nav_msgs/msg/Odometry"
            yield COMMAND_TOPIC, "geometry_msgs/msg/Twist"
        yield self.bumper_type.topic, self.params.bumper_msgtype

    def events(self) -> Iterator[_Event]:
        """Yield every message in time order, block by block."""
        types = dict(self.topics())
        n_steps = math.ceil(self.params.duration_s * NS_PER_S / STEP_NS)
        waiting: list[_Event] = []
        for first in range(0, n_steps, _BLOCK_STEPS):
            track = self.walker.advance(min(_BLOCK_STEPS, n_steps - first))
            until_ns = self.stamp(first + len(track.poses))
            for source in self._sources(track, until_ns):
                waiting += [(at, topic, types[topic], fields) for at, topic, fields in source]
            waiting.sort(key=itemgetter(0))
            n_ready = sum(event[0] < until_ns for event in waiting)
            yield from waiting[:n_ready]
            waiting = waiting[n_ready:]
        yield from waiting

    def stamp(self, step: int) -> int:
        """Return the moment of a step."""
        return self.params.start_stamp_ns + step * STEP_NS

    def true_contact(self, contact: Contact, end_ns: int) -> TruthContact:
        """Return a contact in log time, cut at the last message."""
        stop_ns = min(self.stamp(contact.end_step), end_ns)
        return TruthContact(self.stamp(contact.start_step), stop_ns, contact.visible, contact.cause)

    def _sources(
        self, track: Track, until_ns: int
    ) -> Iterator[Iterator[tuple[int, str, dict[str, Any]]]]:
        """Yield the messages of one block, topic by topic."""
        if not self.params.is_json:
            yield self._transforms(track)
            yield self._odometry(track)
            yield self._commands(track)
        yield self._scans(track)
        yield self._bumps(until_ns)

    def _transforms(self, track: Track) -> Iterator[tuple[int, str, dict[str, Any]]]:
        """Tell where the scanner is: once, or every 100 ms on /tf."""
        topic = self.params.tf_topic
        steps = range(track.first_step, track.first_step + len(track.poses))
        for step in steps:
            if step == 0 or (topic == "/tf" and step % 2 == 0):
                stamp_ns = self.stamp(step)
                yield stamp_ns, topic, messages.scanner_transform(stamp_ns, self.scanner)

    def _odometry(self, track: Track) -> Iterator[tuple[int, str, dict[str, Any]]]:
        for stamp_ns, fields in self.odometer.messages(track):
            yield stamp_ns + _ODOM_DELAY_NS, ODOM_TOPIC, fields

    def _commands(self, track: Track) -> Iterator[tuple[int, str, dict[str, Any]]]:
        for i in range(track.first_step % 2, len(track.commands), 2):
            speed, turn = track.commands[i].tolist()
            yield self.stamp(track.first_step + i), COMMAND_TOPIC, messages.twist(speed, turn)

    def _scans(self, track: Track) -> Iterator[tuple[int, str, dict[str, Any]]]:
        """Take a scan at every other step; it arrives some milliseconds later."""
        make = messages.foxglove_scan if self.params.is_json else messages.laser_scan
        offset = track.first_step % 2
        scans = self.laser.scan(track.poses[offset::2])
        delays = self._delays.integers(*_SCAN_DELAY_NS, len(scans)).tolist()
        for i, (ranges, delay_ns) in enumerate(zip(scans, delays, strict=True)):
            stamp_ns = self.stamp(track.first_step + offset + 2 * i)
            yield stamp_ns + delay_ns, SCAN_TOPIC, make(stamp_ns, ranges, self.scanner)

    def _bumps(self, until_ns: int) -> Iterator[tuple[int, str, dict[str, Any]]]:
        for contact in self.walker.contacts[self._n_told :]:
            self.bumper.touch(contact)
        self._n_told = len(self.walker.contacts)
        header: Callable[[int, str], dict[str, Any]] = (
            messages.json_header if self.params.is_json else messages.ros_header
        )
        changes = self.bumper.changes(until_ns)
        for stamp_ns, fields in self.bumper_topic.messages(changes, until_ns, header):
            yield stamp_ns + _BUMP_DELAY_NS, self.bumper_type.topic, fields


def _write_truth(path: Path, log: str, start_ns: int, contacts: tuple[TruthContact, ...]) -> None:
    try:
        with path.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(("log", "start_s", "end_s", "visible", "cause"))
            for contact in contacts:
                start_s = (contact.start_ns - start_ns) / NS_PER_S
                end_s = (contact.end_ns - start_ns) / NS_PER_S
                table.writerow((log, start_s, end_s, int(contact.visible), contact.cause))
    except OSError as err:
        msg = f"{path}: cannot be written ({err.strerror}); choose another place"
        raise OutputError(msg) from err
