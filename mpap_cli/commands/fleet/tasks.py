"""What a worker is told of one log, and what it tells of its leaf."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.logs.reader import LogPath
from mpap_cli.outputs.results_reader import InputFile
from mpap_cli.params import Settings
from mpap_cli.properties.press_files import PressRow


@dataclass(frozen=True, slots=True, kw_only=True)
class LeafTask:
    """One log to learn; all that a worker in another process or on another machine needs.

    ``number`` counts the logs of the run; ``described`` is None where the content was not
    read before; the leaf goes into the folder ``leaves``. ``selection`` names no logs.
    ``presses`` are those of ``--bump-from FILE.csv``, ``definitions`` a digest of ``--msgs``,
    ``version`` the mpap that asks.
    """

    number: int
    path: LogPath
    described: InputFile | None
    leaves: Path
    selection: LogSelection
    settings: Settings
    presses: tuple[PressRow, ...] | None
    definitions: str
    keep_recording: bool
    version: str

    @property
    def name(self) -> str:
        """Base name of the log."""
        return self.path.name


@dataclass(frozen=True, slots=True, kw_only=True)
class LeafFacts:
    """What is known of a leaf beside its model; ``n_presses`` is None without a bumper."""

    n_scans: int
    n_presses: int | None
    seconds: float
    damaged: bool
    has_images: bool
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Leaf:
    """A leaf in its folder: the log it is of, and what is known of it."""

    folder: Path
    log: InputFile
    facts: LeafFacts


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """How it went with one log.

    Without a ``leaf`` the ``reason`` says why, with the exit code that it would lead to.
    It is ``pending`` where nothing is known against the log itself, ``reused`` where an
    earlier run learnt it.
    """

    leaf: Leaf | None = None
    reason: str = ""
    exit_code: int = 1
    pending: bool = False
    reused: bool = False


Work: TypeAlias = Callable[[LeafTask], Outcome]
Finished: TypeAlias = tuple[LeafTask, Outcome]


def killed(task: LeafTask) -> Outcome:
    """Return what is said of a log whose worker died at it."""
    return Outcome(reason=f"{task.name}: the worker that read it was killed (out of memory?)")
