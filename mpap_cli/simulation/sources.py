"""What happens in a simulated log: the robot drives, its sensors and switches tell of it."""

import math
from collections.abc import Callable, Iterator
from operator import itemgetter
from typing import Any

import numpy as np

from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation import messages
from mpap_cli.simulation.bumper import Bumper
from mpap_cli.simulation.bumper_messages import BUMPER_TYPES, BumperTopic
from mpap_cli.simulation.camera_source import CameraSource
from mpap_cli.simulation.camera_truth import CameraTruth
from mpap_cli.simulation.laser import Laser, Scanner
from mpap_cli.simulation.robot import STEP_NS, Track, Walker
from mpap_cli.simulation.settings import SimulationParams

SCAN_TOPIC = "/scan"
ODOM_TOPIC = "/odom"
COMMAND_TOPIC = "/cmd_vel"

_BLOCK_STEPS = 512
_CAMERA_BLOCK_STEPS = 40
_BUMP_DELAY_NS = 1_000_000
_ODOM_DELAY_NS = 1_500_000
_SCAN_DELAY_NS = (3_000_000, 15_000_000)

_Message = tuple[int, str, dict[str, Any]]
_Event = tuple[int, str, str, dict[str, Any]]
"""Log time, topic, message type, fields."""


class Run:
    """The world, the robot in it and its sensors, on the way through one log."""

    def __init__(self, params: SimulationParams, truth: CameraTruth | None) -> None:
        self.params = params
        world = params.place.build(np.random.default_rng((params.seed_of_world, 0)))
        forward_rad = math.radians(params.forward_deg)
        self.scanner = Scanner(forward_rad=forward_rad, no_return=params.no_return)
        self.walker = Walker(world, params.habits, params.seed)
        self.laser = Laser(world, self.scanner, params.seed)
        self.bumper = Bumper(params.start_stamp_ns, params.seed, params.faults)
        self.odometer = messages.Odometer(params.start_stamp_ns, params.seed)
        self.bumper_type = BUMPER_TYPES[params.bumper_name]
        self.bumper_topic = BumperTopic(self.bumper_type, params.start_stamp_ns)
        self.camera: CameraSource | None = None
        if params.camera is not None and truth is not None:
            self.camera = CameraSource(world, params, params.camera, truth)
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
        if self.camera is not None:
            yield from self.camera.topics()

    def events(self) -> Iterator[_Event]:
        """Yield every message in time order, block by block."""
        types = dict(self.topics())
        n_steps = math.ceil(self.params.duration_s * NS_PER_S / STEP_NS)
        waiting: list[_Event] = []
        # images are large, and wait until their block is done
        block = _BLOCK_STEPS if self.camera is None else _CAMERA_BLOCK_STEPS
        for first in range(0, n_steps, block):
            track = self.walker.advance(min(block, n_steps - first))
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

    def _sources(self, track: Track, until_ns: int) -> Iterator[Iterator[_Message]]:
        """Yield the messages of one block, topic by topic."""
        if not self.params.is_json:
            yield self._transforms(track)
            yield self._odometry(track)
            yield self._commands(track)
        yield self._scans(track)
        yield self._bumps(until_ns)
        if self.camera is not None:
            yield self.camera.messages(track, self.walker.contacts)

    def _transforms(self, track: Track) -> Iterator[_Message]:
        """Tell where the scanner is: once, or every 100 ms on /tf."""
        topic = self.params.tf_topic
        steps = range(track.first_step, track.first_step + len(track.poses))
        for step in steps:
            if step == 0 or (topic == "/tf" and step % 2 == 0):
                stamp_ns = self.stamp(step)
                yield stamp_ns, topic, messages.scanner_transform(stamp_ns, self.scanner)

    def _odometry(self, track: Track) -> Iterator[_Message]:
        for stamp_ns, fields in self.odometer.messages(track):
            yield stamp_ns + _ODOM_DELAY_NS, ODOM_TOPIC, fields

    def _commands(self, track: Track) -> Iterator[_Message]:
        for i in range(track.first_step % 2, len(track.commands), 2):
            speed, turn = track.commands[i].tolist()
            yield self.stamp(track.first_step + i), COMMAND_TOPIC, messages.twist(speed, turn)

    def _scans(self, track: Track) -> Iterator[_Message]:
        """Take a scan at every other step; it arrives some milliseconds later."""
        make = messages.foxglove_scan if self.params.is_json else messages.laser_scan
        offset = track.first_step % 2
        scans = self.laser.scan(track.poses[offset::2])
        delays = self._delays.integers(*_SCAN_DELAY_NS, len(scans)).tolist()
        for i, (ranges, delay_ns) in enumerate(zip(scans, delays, strict=True)):
            stamp_ns = self.stamp(track.first_step + offset + 2 * i)
            yield stamp_ns + delay_ns, SCAN_TOPIC, make(stamp_ns, ranges, self.scanner)

    def _bumps(self, until_ns: int) -> Iterator[_Message]:
        for contact in self.walker.contacts[self._n_told :]:
            self.bumper.touch(contact)
        self._n_told = len(self.walker.contacts)
        header: Callable[[int, str], dict[str, Any]] = (
            messages.json_header if self.params.is_json else messages.ros_header
        )
        changes = self.bumper.changes(until_ns)
        for stamp_ns, fields in self.bumper_topic.messages(changes, until_ns, header):
            yield stamp_ns + _BUMP_DELAY_NS, self.bumper_type.topic, fields
