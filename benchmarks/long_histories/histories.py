"""Histories of many hours, out of the simulator's worlds: what a model learns from for days.

The robot is carried from place to place, leg by leg. One place after the other is opened;
from ``KNOWN_AFTER_H`` on it stays in those that it has been to.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpap_cli.observations import (
    NS_PER_S,
    Bump,
    Float64Array,
    IntArray,
    Press,
    ScanBlock,
    ScanGeometry,
)
from mpap_cli.outputs.recorded_log import RecordedLog
from mpap_cli.outputs.recording import RecordingWriter
from mpap_cli.simulation.laser import Laser, Scanner
from mpap_cli.simulation.robot import STEP_NS, Contact, Track, Walker
from mpap_cli.simulation.settings import PLACES

HOUR_NS = 3600 * NS_PER_S
KNOWN_AFTER_H = 0.5
LEG_S = 120
HZ = 5
STEPS = NS_PER_S // HZ // STEP_NS
START_NS = 1_577_836_800 * NS_PER_S
_SCANNER = Scanner()
_GEOMETRY = ScanGeometry(
    _SCANNER.n_beams,
    _SCANNER.angle_min,
    _SCANNER.increment_rad,
    _SCANNER.range_min_m,
    _SCANNER.range_max_m,
    "laser",
)
KINDS = tuple(PLACES)
_N_PLACES = 12
_ASIDE = (0.005, 0.005, 0.005)


class Visits:
    """The places that a robot is in, leg after leg.

    Parameters
    ----------
    n_places : int
        How many there are; they are opened at even intervals.
    seed : int
        Of the order in which they are met.
    """

    def __init__(self, n_places: int, seed: int = 0) -> None:
        self._n_places = n_places
        self._rng = np.random.default_rng((seed, 20))
        self._n_opened = 0

    def next_place(self, after_ns: int) -> int:
        """Return where the leg that begins so long after the start goes: to what is new first."""
        n_open = min(self._n_places, 1 + int(after_ns * self._n_places / KNOWN_AFTER_H / HOUR_NS))
        if n_open > self._n_opened:
            self._n_opened += 1
            return self._n_opened - 1
        return int(self._rng.integers(n_open))


@dataclass(frozen=True, slots=True, eq=False)
class _Way:
    """Poses (n, 3) of the robot at its scans, and what it touched since its start."""

    poses: Float64Array
    presses: tuple[Press, ...]


class _Room:
    """A world with a robot in it that drives whenever it is there."""

    def __init__(self, number: int) -> None:
        place = PLACES[KINDS[number % len(KINDS)]]
        world = place.build(np.random.default_rng((number, 0)))
        self._walker = Walker(world, place.habits, number)
        self._laser = Laser(world, _SCANNER, number)
        self._ways: list[_Way] = []
        self._rng = np.random.default_rng((number, 22))

    def drive(self, start_ns: int, *, new_way: bool) -> tuple[ScanBlock, tuple[Press, ...]]:
        """Return the scans and contacts of a leg that begins at a stamp.

        Its way is a new one, or one that was driven before, but for some millimeters.
        """
        if new_way or not self._ways:
            track = self._walker.advance(LEG_S * NS_PER_S // STEP_NS)
            presses = presses_of(self._walker.contacts, track, 0)
            self._walker.contacts.clear()
            way = _Way(track.poses[::STEPS], presses)
            self._ways.append(way)
        else:
            way = self._ways[int(self._rng.integers(len(self._ways)))]
        aside = self._rng.normal(0.0, _ASIDE, 3)
        ranges = self._laser.scan(way.poses + aside)
        presses = tuple(
            Press(start_ns + one.start_ns, start_ns + one.end_ns) for one in way.presses
        )
        return ScanBlock(stamps_of(start_ns, len(ranges)), ranges, _GEOMETRY), presses


def stamps_of(start_ns: int, n: int) -> IntArray:
    """Return the stamps of n observations."""
    return start_ns + np.arange(n, dtype=np.int64) * (NS_PER_S // HZ)


def presses_of(contacts: Sequence[Contact], track: Track, start_ns: int) -> tuple[Press, ...]:
    """Return contacts as presses, cut at the end of the leg."""
    last = track.first_step + len(track.poses)
    spans = [
        (one.start_step - track.first_step, min(one.end_step, last) - track.first_step)
        for one in contacts
    ]
    return tuple(
        Press(start_ns + begin * STEP_NS, start_ns + end * STEP_NS)
        for begin, end in spans
        if begin < end
    )


def write_scans(path: Path, hours: int, *, new_ways: bool) -> Path:
    """Write a recording of the scans and presses of so many hours, one log an hour, once.

    When all places are known, the robot goes the ways that it has gone before, or new ones.
    """
    if path.exists():
        return path
    rooms, visits = [_Room(number) for number in range(_N_PLACES)], Visits(_N_PLACES)
    part = path.with_suffix(".part")
    with RecordingWriter(part) as writer:
        for hour in range(hours):
            start_ns, found = START_NS + hour * HOUR_NS, list[Press]()
            for leg_ns in range(0, HOUR_NS, LEG_S * NS_PER_S):
                after_ns = hour * HOUR_NS + leg_ns
                place = rooms[visits.next_place(after_ns)]
                is_new = new_ways or after_ns < KNOWN_AFTER_H * HOUR_NS
                block, presses = place.drive(start_ns + leg_ns, new_way=is_new)
                writer.add_block(block)
                found += presses
            writer.end_log(_hour_log(hour, start_ns, tuple(found)))
    return part.rename(path)


def _hour_log(hour: int, start_ns: int, presses: tuple[Press, ...]) -> RecordedLog:
    return RecordedLog(
        name=f"hour-{hour:03d}",
        path=f"hour-{hour:03d}",
        start_ns=start_ns,
        end_ns=start_ns + HOUR_NS - 1,
        forward_rad=0.0,
        range_max=None,
        presses=presses,
        bump_source="simulation",
    )


def bumps_of(presses: Sequence[Press], after_ns: int, until_ns: int) -> tuple[Bump, ...]:
    """Return the changes of a level sensor in ``after_ns < stamp <= until_ns``."""
    changes = [
        Bump(stamp_ns, "", pressed)
        for press in presses
        for stamp_ns, pressed in ((press.start_ns, True), (press.end_ns, False))
    ]
    return tuple(bump for bump in changes if after_ns < bump.stamp_ns <= until_ns)
