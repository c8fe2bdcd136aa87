"""A round robot on a random walk: it drives, turns, bumps, holds, backs off, turns."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import Float64Array
from mpap_cli.simulation.world import MATERIALS, World

STEP_NS = 50_000_000
_STEP_S = 0.05
_FOOT_CHANCE = 0.005
_MEMORY = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Habits:
    """Shape and manners of the robot, which differ from place to place."""

    radius_m: float = 0.2
    speed_mps: float = 0.35
    turn_radps: float = 1.2
    acceleration_mps2: float = 0.8
    ring_rad: float = math.radians(80)
    bold_share: float = 0.18
    leg_s: tuple[float, float] = (2.0, 9.0)
    look_m: tuple[float, float] = (0.1, 0.8)
    unseen_share: float = 0.15


@dataclass(frozen=True, slots=True)
class Contact:
    """What truly happened: something touched the front of the robot.

    Steps count from the start of the walk; ``start <= step < end``. ``bearing_rad`` is
    where it was touched, to the left of straight ahead.
    """

    start_step: int
    end_step: int
    cause: str
    visible: bool
    bearing_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Consecutive steps of a walk.

    ``poses`` (n, 3): x, y, heading; ``motion`` (n, 2): speed and turn rate as driven;
    ``commands`` (n, 2): the same as commanded.
    """

    first_step: int
    poses: Float64Array
    motion: Float64Array
    commands: Float64Array


class Walker:
    """Drives a robot through a world, step by step of 50 ms.

    A cautious leg ends before what the laser can see, a bold one at a contact. A robot in
    contact pushes for a while, backs off and turns. Now and then a foot presses the bumper.

    Parameters
    ----------
    world : World
        Where it starts and what stops it.
    habits : Habits
        Its shape and manners.
    seed : int
        Of everything left to chance.
    """

    def __init__(self, world: World, habits: Habits, seed: int) -> None:
        self.habits = habits
        self.contacts: list[Contact] = []
        self._rng = np.random.default_rng((seed, 3))
        self._names = world.names
        self._solid, self._solid_numbers = world.pick(solid=True)
        self._visible, _ = world.pick(solid=True, visible=True)
        self._x, self._y, self._heading = world.start
        self._speed = 0.0
        self._step = 0
        self._phase = self._drive
        self._left = 0
        self._curve = 0.0
        self._turn = 0.0
        self._look_m: float | None = None
        self._touched_rad: float | None = None
        self._clearance_m = 0.0
        self._n_unseen = 0
        self._remembered: deque[tuple[float, float]] = deque(maxlen=_MEMORY)
        self._start_leg()

    def advance(self, n_steps: int) -> Track:
        """Walk on; contacts are appended to ``contacts`` at their start."""
        poses = np.empty((n_steps, 3))
        motion = np.empty((n_steps, 2))
        commands = np.empty((n_steps, 2))
        first = self._step
        for i in range(n_steps):
            speed, turn = self._phase()
            self._move(speed, turn)
            poses[i] = self._x, self._y, self._heading
            motion[i] = self._speed, turn
            commands[i] = speed, turn
            self._step += 1
        return Track(first, poses, motion, commands)

    def _drive(self) -> tuple[float, float]:
        """Go ahead, until the leg ends or something is in sight."""
        self._left -= 1
        if self._foot_comes():
            self._begin_contact("foot", False, float(self._rng.uniform(-1.2, 1.2)))
            return 0.0, 0.0
        in_sight = self._look_m is not None and self._step % 3 == 0 and self._is_blocked(0.0)
        if in_sight or self._left <= 0:
            self._plan_turn(in_sight=in_sight)
        return self.habits.speed_mps, self._curve

    def _hold(self) -> tuple[float, float]:
        """Push against what was touched."""
        self._left -= 1
        if self._left <= 0:
            self._left = int(self._rng.integers(12, 45))
            self._phase = self._back_off
        return 0.0, 0.0

    def _back_off(self) -> tuple[float, float]:
        self._left -= 1
        if self._left <= 0:
            self._plan_turn(in_sight=True)
        return -0.6 * self.habits.speed_mps, 0.0

    def _wait(self) -> tuple[float, float]:
        """Stand still after the view was blocked."""
        self._left -= 1
        if self._left <= 0:
            self._phase = self._rotate
        return 0.0, 0.0

    def _rotate(self) -> tuple[float, float]:
        turn = math.copysign(min(self.habits.turn_radps, abs(self._turn) / _STEP_S), self._turn)
        self._turn -= turn * _STEP_S
        if abs(self._turn) < 1e-9:  # noqa: PLR2004  # rounding
            self._start_leg()
        return 0.0, turn

    def _start_leg(self) -> None:
        rng, habits = self._rng, self.habits
        self._phase = self._drive
        self._left = int(rng.uniform(*habits.leg_s) / _STEP_S)
        self._curve = float(rng.normal(0.0, 0.12))
        bold = rng.random() < habits.bold_share
        self._look_m = None if bold else float(rng.uniform(*habits.look_m))

    def _plan_turn(self, *, in_sight: bool) -> None:
        """Choose how far to turn: the freest of three ways; wait first at times."""
        rng = self._rng
        if self._touched_rad is not None:
            turns = -math.copysign(1.0, self._touched_rad) * rng.uniform(0.8, 2.8, 3)
        elif in_sight:
            turns = rng.choice((-1.0, 1.0), 3) * rng.uniform(0.5, 2.6, 3)
        else:
            turns = rng.normal(0.0, 0.6, 3)
        free = [turn for turn in turns if not self._is_blocked(float(turn))]
        self._turn = float(free[0] if free else turns[0])
        self._touched_rad = None
        self._left = int(rng.integers(10, 60)) if rng.random() < 0.25 else 1  # noqa: PLR2004
        self._phase = self._wait

    def _is_blocked(self, turn: float) -> bool:
        """Tell whether a robot ahead, after a turn, would touch what it sees or remembers."""
        look = self._look_m if self._look_m is not None else 0.4
        x = self._x + look * math.cos(self._heading + turn)
        y = self._y + look * math.sin(self._heading + turn)
        gaps = [math.hypot(x - bump_x, y - bump_y) for bump_x, bump_y in self._remembered]
        gaps.append(self._visible.nearest(x, y).distance_m)
        return min(gaps) < self.habits.radius_m

    def _foot_comes(self) -> bool:
        """Tell whether a foot or hand presses the bumper now: only while few were unseen."""
        wanted = self._n_unseen + 0.5 < self.habits.unseen_share * len(self.contacts)
        return bool(wanted and self._rng.random() < _FOOT_CHANCE)

    def _move(self, speed: float, turn: float) -> None:
        """Move one step; what is in the way pushes the robot back, and may press the bumper."""
        most = self.habits.acceleration_mps2 * _STEP_S
        # pushing and touching stop the wheels at once, otherwise speed changes slowly
        target = 0.0 if self._phase == self._hold else speed
        self._speed += min(max(target - self._speed, -2 * most), most)
        if self._phase == self._hold:
            self._speed = 0.0
        # rounding keeps the walk the same on processors whose sines differ in the last bit
        self._heading = round(math.remainder(self._heading + turn * _STEP_S, math.tau), 7)
        way = self._speed * _STEP_S
        self._x = round(self._x + way * math.cos(self._heading), 7)
        self._y = round(self._y + way * math.sin(self._heading), 7)
        self._clearance_m -= abs(way)
        if self._clearance_m <= 0:
            self._resolve()

    def _resolve(self) -> None:
        """Keep the robot out of solid things; a touch by the ring ahead is a contact."""
        radius = self.habits.radius_m
        nearest = self._solid.nearest(self._x, self._y)
        self._clearance_m = nearest.distance_m - radius
        if self._clearance_m > 0:
            return
        toward = math.atan2(nearest.y - self._y, nearest.x - self._x)
        if nearest.distance_m < 0:
            toward += math.pi
        bearing = math.remainder(toward - self._heading, math.tau)
        ahead = self._speed > 0 and abs(bearing) <= self.habits.ring_rad
        self._x = round(self._x + self._clearance_m * math.cos(toward), 7)
        self._y = round(self._y + self._clearance_m * math.sin(toward), 7)
        if ahead:
            cause = self._names[int(self._solid_numbers[nearest.index])]
            visible = MATERIALS[cause].reach_m > 0
            if not visible:
                self._remembered.append((nearest.x, nearest.y))
            self._begin_contact(cause, visible, bearing)
        elif self._speed < 0:
            self._speed = 0.0
            self._left = 0

    def _begin_contact(self, cause: str, visible: bool, bearing: float) -> None:
        self._left = int(self._rng.integers(4, 61))
        self._phase = self._hold
        self._touched_rad = bearing
        self._speed = 0.0
        # this step is the first in contact; the robot backs off when the hold is over
        end = self._step + self._left
        self._n_unseen += not visible
        self.contacts.append(Contact(self._step, end, cause, visible, bearing))
