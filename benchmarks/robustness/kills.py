"""Kill runs at random moments: results stay whole, older or new, and the next run works.

``python benchmarks/robustness/kills.py --kills 30`` prints one line a kill.
Each run writes into one
OUT that holds the whole results of every command already, made from another input. Half of
the kills come anywhere in a run, the others while results are put in place. Afterwards a
copy of OUT is read, in which each folder must be byte by byte what one of two undisturbed
runs wrote; and the same command is run again in OUT itself. ``learn --merge`` has an OUT
of its own in OUT, and learns its leaves anew each time.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import numpy as np

from benchmarks.measuring.processes import MPAP, environment
from mpap_cli.commands.fleet.learn_merged import LEAVES
from mpap_cli.errors import OutputError
from mpap_cli.outputs.publishing import staging_of
from mpap_cli.outputs.results_reader import read_results
from mpap_cli.outputs.results_record import SETTINGS_NAME, listed_outputs

MERGED = "learn --merge"
COMMANDS = ("learn", "merge", "predict", "novelty", "evaluate", "extract", MERGED)
_FOLDERS = {MERGED: "merged/learn"}
_FIXTURES = Path(__file__).parents[2] / "fixtures"
_LOGS = tuple(str(_FIXTURES / name) for name in ("indoor-a.bag", "indoor-a2.mcap"))
_PART = ("--end", "40")
_PUBLISHING_S = 0.03
_POLL_S = 0.0002
_COLUMNS = (
    ("kill", 5),
    ("command", 15),
    ("moment", 26),
    ("left behind", 38),
    ("results", 9),
    ("whole", 6),
)
_WHOLE = (
    "each folder of OUT is byte by byte what an undisturbed run wrote",
    "the next run ended with 0, with whole new results",
    "after it nothing of the dead run is left, no lock either",
)


@dataclass(frozen=True, slots=True)
class Kill:
    """One kill: when, what lay there then, and how it ended."""

    command: str
    moment: str
    left: str
    results: str
    complaints: tuple[str, ...]

    @property
    def is_whole(self) -> bool:
        """Whether nothing was lost and nothing stood in the way."""
        return not self.complaints

    def cells(self, number: int) -> list[str]:
        """Return a line of the table."""
        whole = "yes" if self.is_whole else f"NO: {'; '.join(self.complaints)}"
        return [str(number), self.command, self.moment, self.left, self.results, whole]


class Target:
    """An OUT in which runs are killed, and what undisturbed runs write into it.

    Parameters
    ----------
    folder : Path
        Empty; OUT and the undisturbed results are made in it.
    commands : sequence of str
        Of `COMMANDS`; learn must be there, whose models the others take.
    """

    def __init__(self, folder: Path, commands: Sequence[str]) -> None:
        self.commands = commands
        self.out = folder / "out"
        self._copy = folder / "copy"
        self._undisturbed = (folder / "first", folder / "second")
        self._took_s: dict[str, float] = {}
        for command in sorted(commands, key=COMMANDS.index):
            for variant, out in enumerate(self._undisturbed):
                begin = time.monotonic()
                _run(self.words(command, variant), _folder(out, command).parent).check_returncode()
                self._took_s[command] = time.monotonic() - begin
        shutil.copytree(self._undisturbed[0], self.out)

    def words(self, command: str, variant: int) -> list[str]:
        """Return the command line of one of two variants, but for the results folder."""
        log = _LOGS[variant]
        models = [str(out / "learn" / "model.npz") for out in self._undisturbed]
        return {
            "learn": ["learn", log, *_PART],
            "merge": ["merge", *models[: 2 - variant]],
            "predict": ["predict", models[0], log, "--to-mcap", *_PART],
            "novelty": ["novelty", log, *_PART],
            "evaluate": ["evaluate", log, *_PART],
            "extract": ["extract", log, "--presses", *_PART],
            MERGED: ["learn", "--merge", *_LOGS[variant:], "--jobs", "1", *_PART],
        }[command]

    def kill(self, command: str, rng: np.random.Generator, *, while_publishing: bool) -> Kill:
        """Kill a run of a command once, look at what is there, and run the command again."""
        variant = 1 - self._variant_in(self.out, command)
        folder = _folder(self.out, command)
        while True:
            shutil.rmtree(folder.parent / LEAVES, ignore_errors=True)
            moment = self._kill_at_random(command, variant, rng, while_publishing=while_publishing)
            if moment:
                break
            variant = 1 - variant  # it was done before: once more, back to the other one
        left = _left_behind(folder)
        complaints = []
        shutil.copytree(self.out, self._copy)
        try:
            now = self._variant_in(self._copy, command)
            for other in self.commands:
                self._variant_in(self._copy, other)
        except OutputError as error:
            now = -1
            complaints.append(str(error))
        shutil.rmtree(self._copy)
        again = _run(self.words(command, variant), folder.parent)
        if again.returncode or self._variant_in(self.out, command) != variant:
            complaints.append(f"the next run ended with {again.returncode}: {again.stderr[-200:]}")
        hidden = sorted(path.name for path in self.out.rglob(".*"))
        complaints += [f"{name} is still there" for name in hidden]
        results = {variant: "new", 1 - variant: "older"}.get(now, "broken")
        return Kill(command, moment, left, results, tuple(complaints))

    def _variant_in(self, out: Path, command: str) -> int:
        """Return which undisturbed run the results are those of; OutputError if of none."""
        results = read_results(_folder(out, command))
        names = {SETTINGS_NAME, *results.outputs}
        for variant, undisturbed in enumerate(self._undisturbed):
            whole = _folder(undisturbed, command)
            if names == {path.name for path in whole.iterdir()} and all(
                (results.folder / name).read_bytes() == (whole / name).read_bytes()
                for name in names
            ):
                return variant
        msg = f"{results.folder}: neither the older results nor the new ones"
        raise OutputError(msg)

    def _kill_at_random(
        self, command: str, variant: int, rng: np.random.Generator, *, while_publishing: bool
    ) -> str:
        """Start a run and kill it; return the moment, nothing if the run was done before."""
        delay_s = rng.uniform(0, _PUBLISHING_S if while_publishing else self._took_s[command])
        folder = _folder(self.out, command)
        staged = staging_of(folder) / SETTINGS_NAME
        words = [MPAP, *self.words(command, variant), "-o", str(folder.parent)]
        null = subprocess.DEVNULL
        with subprocess.Popen(words, env=environment(), stdout=null, stderr=null) as child:
            while while_publishing and child.poll() is None and not staged.exists():
                time.sleep(_POLL_S)
            time.sleep(delay_s)
            child.kill()
        if child.returncode == 0:
            return ""
        if while_publishing:
            return f"{1000 * delay_s:.1f} ms after staging"
        return f"{delay_s:.2f} s of {self._took_s[command]:.2f} s"


def _folder(out: Path, command: str) -> Path:
    """Return where the results of a command lie."""
    return out / _FOLDERS.get(command, command)


def _run(words: Sequence[str], out: Path) -> "subprocess.CompletedProcess[str]":
    """Run a command to its end."""
    line = [MPAP, *words, "-o", str(out)]
    return subprocess.run(line, env=environment(), capture_output=True, text=True, check=False)


def _left_behind(folder: Path) -> str:
    """Say what a dead run has left of its work."""
    staging = staging_of(folder)
    if not staging.exists():
        lock = folder.parent / f".{folder.name}.lock"
        return "a lock" if lock.exists() else "nothing"
    staged = [path for path in staging.iterdir() if path.name != SETTINGS_NAME]
    names = listed_outputs(staging)
    if not names:
        return f"a lock, {len(staged)} unfinished files"
    return f"a lock, {len(names) - len(staged)} of {len(names)} files in place"


def kill_often(folder: Path, commands: Sequence[str], n_kills: int, seed: int) -> Iterator[Kill]:
    """Kill runs of some commands in turns, at random moments.

    Parameters
    ----------
    folder : Path
        Empty.
    commands : sequence of str
        Of `COMMANDS`; learn must be there.
    n_kills, seed : int
        How many, and of the moments.

    Yields
    ------
    Kill
        As they happen.
    """
    rng = np.random.default_rng(seed)
    target = Target(folder, commands)
    for number, command in zip(range(n_kills), cycle(commands), strict=False):
        yield target.kill(command, rng, while_publishing=bool(number // len(commands) % 2))


def _line(cells: Sequence[str]) -> str:
    """Lay out one line of the table."""
    return "".join(f"{cell:<{width}}" for cell, (_, width) in zip(cells, _COLUMNS, strict=True))


def main() -> None:
    """Print the table; exit with 1 if anything was lost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=30, help="in all (30)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", default=",".join(COMMANDS), help="with commas")
    asked = parser.parse_args()
    n_whole = 0
    with tempfile.TemporaryDirectory() as name:
        print(_line([name for name, _ in _COLUMNS]), flush=True)
        commands = asked.commands.split(",")
        for number, kill in enumerate(
            kill_often(Path(name), commands, asked.kills, asked.seed), start=1
        ):
            n_whole += kill.is_whole
            print(_line(kill.cells(number)).rstrip(), flush=True)
    print(f"{n_whole} of {asked.kills} whole. Whole: " + "; ".join(_WHOLE) + ".")
    sys.exit(n_whole < asked.kills)


if __name__ == "__main__":
    main()
