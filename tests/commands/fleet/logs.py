"""Logs, work and processes for the tests of many logs at once."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from mpap_cli.commands.fleet.leaves import learn_leaf
from mpap_cli.commands.fleet.tasks import LeafTask, Outcome
from tests.commands.running import BAG, FIXTURES, MCAP, rows_of

LOGS = (BAG, MCAP, FIXTURES / "indoor-b", FIXTURES / "indoor-json.mcap")
MPAP = str(Path(sys.executable).with_name("mpap"))
DEADLY = "deadly.bag"
WAIT_S = 60


def learn_or_die(task: LeafTask) -> Outcome:
    """Learn a log; at one of them die as a worker without memory does."""
    if task.name == DEADLY:
        time.sleep(0.2)
        os.kill(os.getpid(), signal.SIGKILL)
    return learn_leaf(task)


def manifest(out: Path) -> dict[str, dict[str, str]]:
    """Return the rows of the manifest by name of the log."""
    return {row["log"]: row for row in rows_of(out / "leaves" / "manifest.csv")}


def states(out: Path) -> dict[str, str]:
    """Return the state of every log."""
    return {name: row["state"] for name, row in manifest(out).items()}


def merged_bytes(out: Path) -> dict[str, bytes]:
    """Return what must be the same however it was learnt."""
    names = ("clusters.csv", "model.npz", "recording.npz")
    return {name: (out / "learn" / name).read_bytes() for name in names}


def start(*words: object) -> "subprocess.Popen[str]":
    """Start ``mpap learn --merge`` in a process of its own."""
    line = [MPAP, "learn", "--merge", *map(str, words)]
    pipe = subprocess.PIPE
    return subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=pipe, text=True)  # noqa: S603  # mpap itself


def wait_until(holds: Callable[[], bool]) -> None:
    """Wait until something holds; fail after a minute."""
    end_s = time.monotonic() + WAIT_S
    while not holds():
        assert time.monotonic() < end_s, "waited in vain"
        time.sleep(0.01)


def n_done(out: Path) -> int:
    """Return how many logs the manifest calls done; 0 before there is one."""
    path = out / "leaves" / "manifest.csv"
    return list(states(out).values()).count("done") if path.exists() else 0


def children_of(parent: int) -> list[int]:
    """Return the processes that a process has started itself."""
    text = Path(f"/proc/{parent}/task/{parent}/children").read_text(encoding="ascii")
    return [int(word) for word in text.split()]


def copied(source: Path, folder: Path, name: str) -> Path:
    """Copy a log under another name."""
    folder.mkdir(exist_ok=True)
    return Path(shutil.copyfile(source, folder / name))
