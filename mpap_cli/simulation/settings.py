"""What to simulate: places, and the settings of one log."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from mpap_cli.errors import SettingError
from mpap_cli.logs.writing.writer import check_container
from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation.bumper import Faults
from mpap_cli.simulation.bumper_messages import BUMPER_TYPES
from mpap_cli.simulation.camera_messages import ENCODINGS
from mpap_cli.simulation.indoor import build_indoor
from mpap_cli.simulation.laser import NO_RETURN_CODES
from mpap_cli.simulation.lights import LIGHTS
from mpap_cli.simulation.outdoor import build_outdoor
from mpap_cli.simulation.palettes import PALETTES
from mpap_cli.simulation.robot import Habits
from mpap_cli.simulation.world import World

_START_2020_NS = 1_577_836_800 * NS_PER_S
_LAST_STAMP_NS = 2**31 * NS_PER_S
_TF_TOPICS = ("/tf_static", "/tf")


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A kind of world, and how the robot behaves in it.

    With a camera it is bolder, so that a log of minutes holds enough contacts, and hardly
    touched by feet.
    """

    build: Callable[[np.random.Generator], World]
    habits: Habits
    camera_habits: Habits


PLACES: dict[str, Place] = {
    "indoor": Place(
        build=build_indoor, habits=Habits(), camera_habits=Habits(bold_share=0.8, unseen_share=0.04)
    ),
    "outdoor": Place(
        build=build_outdoor,
        habits=Habits(speed_mps=0.6, bold_share=0.5, leg_s=(4.0, 15.0), look_m=(0.1, 1.0)),
        camera_habits=Habits(
            speed_mps=0.8, bold_share=1.0, leg_s=(8.0, 30.0), look_m=(0.1, 1.0), unseen_share=0.04
        ),
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraParams:
    """The camera of a robot, and what it looks at.

    Parameters
    ----------
    hz : float
        Images a second, 0.1 to 30.
    encoding : str
        One of ``ENCODINGS``: jpeg, png, or the encoding of a raw image.
    size : str
        Width and height in pixels, like 640x480; even, 64 to 2048 a side.
    textures : str
        A key of ``PALETTES``.
    light : str
        A key of ``LIGHTS``.

    Raises
    ------
    SettingError
        If a value does not exist.
    """

    hz: float = 5.0
    encoding: str = "jpeg"
    size: str = "640x480"
    textures: str = "a"
    light: str = "day"

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        _require(0.1 <= self.hz <= 30, "camera-hz", self.hz, "0.1 to 30")  # noqa: PLR2004
        _require_choice("image-encoding", self.encoding, ENCODINGS)
        _require_choice("textures", self.textures, tuple(PALETTES))
        _require_choice("light", self.light, tuple(LIGHTS))
        self.width_height()

    def width_height(self) -> tuple[int, int]:
        """Return the size in pixels.

        >>> CameraParams(size="320x240").width_height()
        (320, 240)
        """
        sides = [int(side) if side.isdecimal() else 0 for side in self.size.split("x")]
        fits = len(sides) == 2 and all(64 <= n <= 2048 and n % 2 == 0 for n in sides)  # noqa: PLR2004
        _require(fits, "image-size", self.size, "even numbers like 640x480, 64 to 2048 a side")
        return sides[0], sides[1]


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationParams:
    """What to simulate and how to write it.

    Parameters
    ----------
    world : str
        A key of ``PLACES``.
    duration_s : float
        Length of the log, at least one second.
    seed : int
        Of everything that happens.
    world_seed : int, optional
        Of the world (default: the seed); logs of one world differ in their seed.
    container : str
        A key of ``mpap_cli.logs.writing.storages.CONTAINERS``.
    compression : str, optional
        One of the container's compressions (default: its first).
    bumper : str, optional
        A key of ``BUMPER_TYPES`` (default: kobuki, or pressed in JSON).
    forward_deg : float
        Direction of travel in the frame of the scanner; the field of view turns with it.
    no_return : str
        A key of ``NO_RETURN_CODES``.
    tf_topic : str
        Where the place of the scanner is told: /tf_static, or /tf ten times a second.
    start_stamp_ns : int
        Stamp of the first moment (default 2020-01-01, UTC).
    faults : Faults
        How often the bumper is wrong.
    camera : CameraParams, optional
        Camera of the robot (default: it has none).

    Raises
    ------
    SettingError
        If a value does not exist or does not fit the others.
    """

    world: str = "indoor"
    duration_s: float = 300.0
    seed: int = 0
    world_seed: int | None = None
    container: str = "mcap"
    compression: str | None = None
    bumper: str | None = None
    forward_deg: float = 0.0
    no_return: str = "above-max"
    tf_topic: str = "/tf_static"
    start_stamp_ns: int = _START_2020_NS
    faults: Faults = field(default_factory=Faults)
    camera: CameraParams | None = None

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_container(self.container, self.compression)
        _require_choice("world", self.world, tuple(PLACES))
        _require_choice("no-return", self.no_return, tuple(NO_RETURN_CODES))
        _require_choice("tf-topic", self.tf_topic, _TF_TOPICS)
        _require_choice("bumper", self.bumper_name, self._bumpers())
        least_seed = min(self.seed, self.seed_of_world)
        _require(least_seed >= 0, "seed", least_seed, "0 or more")
        if self.is_json and self.no_return == "inf":
            msg = "no-return: found inf, which JSON cannot hold; choose above-max or zero"
            raise SettingError(msg)
        if self.is_json and self.camera is not None:
            msg = "camera: not written in JSON; choose another container"
            raise SettingError(msg)
        _require(abs(self.forward_deg) <= 360, "forward-deg", self.forward_deg, "-360 to 360")  # noqa: PLR2004
        _require(
            math.isfinite(self.duration_s) and self.duration_s >= 1,
            "duration-s",
            self.duration_s,
            "one second or more",
        )
        last = self.start_stamp_ns + self.duration_s * NS_PER_S
        _require(
            self.start_stamp_ns >= 0 and last < _LAST_STAMP_NS,
            "start-stamp-ns",
            self.start_stamp_ns,
            "nanoseconds between 1970 and 2038, with the end",
        )

    @property
    def place(self) -> Place:
        """The kind of world."""
        return PLACES[self.world]

    @property
    def habits(self) -> Habits:
        """How the robot behaves."""
        return self.place.habits if self.camera is None else self.place.camera_habits

    @property
    def seed_of_world(self) -> int:
        """Seed that the world is made of."""
        return self.seed if self.world_seed is None else self.world_seed

    @property
    def is_json(self) -> bool:
        """Whether messages are JSON."""
        return self.container == "mcap-json"

    @property
    def is_ros1(self) -> bool:
        """Whether messages are ROS1's."""
        return self.container in ("bag", "mcap-ros1")

    @property
    def bumper_name(self) -> str:
        """Key of the bumper type in use."""
        return self.bumper or ("pressed" if self.is_json else "kobuki")

    @property
    def bumper_msgtype(self) -> str:
        """Type of the bumper messages."""
        bumper = BUMPER_TYPES[self.bumper_name]
        return bumper.ros1 if self.is_ros1 else bumper.ros2

    def _bumpers(self) -> tuple[str, ...]:
        return tuple(name for name in BUMPER_TYPES if (name == "pressed") == self.is_json)


def _require(holds: bool, key: str, found: object, wanted: str) -> None:
    if not holds:
        msg = f"{key}: found {found}, expected {wanted}"
        raise SettingError(msg)


def _require_choice(key: str, found: str, choices: tuple[str, ...]) -> None:
    _require(found in choices, key, found, "one of " + ", ".join(choices))
