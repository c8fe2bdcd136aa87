"""Camera logs of the experiments of section 5.3: simulated places, or logs that the user names."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.inputs.common_sensors import common_sensors
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.commands.simulate import simulate
from mpap_cli.logs.reader import expand_paths

SHORT_S = 20.0
MOST_REPEATS = 2
"""Camera runs are repeated that often: each minute of them takes seconds to draw."""

_SIZE = "320x240"


@dataclass(frozen=True, slots=True)
class Place:
    """Somewhere to drive: its name in tables, kind of world, and set of surfaces."""

    name: str
    world: str
    textures: str


INDOOR, INDOOR_2, OUTDOOR = (
    Place("Indoor", "indoor", "a"),
    Place("Indoor 2", "indoor", "b"),
    Place("Outdoor", "outdoor", "c"),
)
PLACES = (INDOOR, INDOOR_2, OUTDOOR)
"""Three environments that share no surface."""


@dataclass(frozen=True, slots=True)
class Environment:
    """Camera logs of one place, one history in their order."""

    name: str
    logs: tuple[str, ...]

    @property
    def selection(self) -> LogSelection:
        """The logs, of which images are read."""
        return LogSelection(logs=self.logs, sensor="image")


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One simulated log: where, in which world of that kind, and how it is driven and seen.

    Logs with the same ``world_seed`` are of one world; ``run`` tells them apart.
    """

    place: Place
    world_seed: int
    run: int
    minutes: float
    light: str = "day"
    hz: float = 5.0


def repeats(bench: Bench) -> range:
    """Return the seeds of what is repeated with a camera."""
    return bench.seeds[:MOST_REPEATS]


def settings_of(bench: Bench, profile: str, pairs: tuple[str, ...] = ()) -> SettingsRequest:
    """Return the settings to learn with; short logs hold too few outliers for the reservoir."""
    few = ("reservoir=100",) if bench.short else ()
    return SettingsRequest(profile=profile, pairs=(*few, *pairs))


def draw(bench: Bench, drive: Drive, name: str) -> Path:
    """Simulate a log with a camera and return its path.

    Parameters
    ----------
    bench : Bench
        Its scratch folder takes the log; a short experiment has logs of 20 seconds.
    drive : Drive
        What is simulated.
    name : str
        Stem of the file, which pictures show.
    """
    folder = bench.scratch / f"{drive.place.textures}{drive.world_seed}-{drive.run}"
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.mcap"
    camera = {
        "size": _SIZE,
        "textures": drive.place.textures,
        "light": drive.light,
        "hz": drive.hz,
    }
    simulate(
        path,
        camera=camera,
        world=drive.place.world,
        duration_s=SHORT_S if bench.short else 60 * drive.minutes,
        seed=100 * drive.world_seed + drive.run,
        world_seed=drive.world_seed,
    )
    return path


def with_camera(words: Sequence[str]) -> tuple[str, ...]:
    """Return those of the logs that a user names which hold images of one camera."""
    paths = [str(path) for path in expand_paths(words)]
    return tuple(path for path in paths if "image" in common_sensors(LogSelection(logs=(path,))))


def named_places(bench: Bench) -> list[Environment]:
    """Return the indoor and outdoor logs that the user names, as far as they have images."""
    named = (("Indoor", bench.request.indoor), ("Outdoor", bench.request.outdoor))
    found = [Environment(name, with_camera(words)) for name, words in named if words]
    return [one for one in found if one.logs]


def note_inputs(bench: Bench, environments: Sequence[Environment]) -> None:
    """Note which files of the user were read."""
    for path in dict.fromkeys(log for one in environments for log in one.logs):
        bench.read(Path(path))
