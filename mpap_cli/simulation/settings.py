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
from mpap_cli.simulation.indoor import build_indoor
from mpap_cli.simulation.laser import NO_RETURN_CODES
from mpap_cli.simulation.outdoor import build_outdoor
from mpap_cli.simulation.robot import Habits
from mpap_cli.simulation.world import World

_START_2020_NS = 1_577_836_800 * NS_PER_S
_LAST_STAMP_NS = 2**31 * NS_PER_S
_TF_TOPICS = ("/tf_static", "/tf")


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A kind of world, and how the robot behaves in it."""

    build: Callable[[np.random.Generator], World]
    habits: Habits


PLACES: dict[str, Place] = {
    "indoor": Place(build=build_indoor, habits=Habits()),
    "outdoor": Place(
        build=build_outdoor,
        habits=Habits(speed_mps=0.6, bold_share=0.5, leg_s=(4.0, 15.0), look_m=(0.1, 1.0)),
    ),
}


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

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_container(self.container, self.compression)
        _require_choice("world", self.world, tuple(PLACES))
        _require_choice("no-return", self.no_return, tuple(NO_RETURN_CODES))
        _require_choice("tf-topic", self.tf_topic, _TF_TOPICS)
        _require_choice("bumper", self.bumper_name, self._bumpers())
        seeds = (self.seed, self.seed if self.world_seed is None else self.world_seed)
        _require(min(seeds) >= 0, "seed", min(seeds), "0 or more")
        if self.is_json and self.no_return == "inf":
            msg = "no-return: found inf, which JSON cannot hold; choose above-max or zero"
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
    def is_json(self) -> bool:
        """Whether messages are JSON."""
        return self.container == "mcap-json"

    @property
    def bumper_name(self) -> str:
        """Key of the bumper type in use."""
        return self.bumper or ("pressed" if self.is_json else "kobuki")

    @property
    def bumper_msgtype(self) -> str:
        """Type of the bumper messages."""
        bumper = BUMPER_TYPES[self.bumper_name]
        return bumper.ros1 if self.container in ("bag", "mcap-ros1") else bumper.ros2

    def _bumpers(self) -> tuple[str, ...]:
        return tuple(name for name in BUMPER_TYPES if (name == "pressed") == self.is_json)


def _require(holds: bool, key: str, found: object, wanted: str) -> None:
    if not holds:
        msg = f"{key}: found {found}, expected {wanted}"
        raise SettingError(msg)


def _require_choice(key: str, found: str, choices: tuple[str, ...]) -> None:
    _require(found in choices, key, found, "one of " + ", ".join(choices))
