"""CPU time and memory, of child processes and of functions taken in turns."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from benchmarks.measuring.seconds import Seconds

Result = TypeVar("Result")
MPAP = str(Path(sys.executable).with_name("mpap"))
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@dataclass(frozen=True, slots=True)
class Usage:
    """What a child process took: user and system time together, and its peak memory."""

    cpu_s: Seconds
    peak_mb: float
    output: str


def environment() -> dict[str, str]:
    """Return the environment of children: one thread a library, BLAS as the processor has it.

    Idle threads of BLAS and OpenMP spin, which would count as work of the peers.
    """
    kept = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    return {**kept, **_ONE_THREAD}


def run_child(command: Sequence[str]) -> Usage:
    """Run a command to its end.

    Raises
    ------
    RuntimeError
        If it does not end with 0.
    """
    began = time.perf_counter()
    child = subprocess.Popen(command, env=environment(), stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None  # noqa: S101  # it is a pipe
    with child.stdout as stream:
        output = stream.read()
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        msg = f"{' '.join(command)} ended with {child.returncode}"
        raise RuntimeError(msg)
    clock = time.perf_counter() - began
    return Usage(Seconds(used.ru_utime + used.ru_stime, clock), used.ru_maxrss / 1024, output)


def children_in_turns(commands: Sequence[Sequence[str]], repeats: int) -> list[list[Usage]]:
    """Run commands in turns; the first turn, which fills caches, is thrown away."""
    usages: list[list[Usage]] = [[] for _ in commands]
    for turn in range(repeats + 1):
        for taken, command in zip(usages, commands, strict=True):
            usage = run_child(command)
            if turn > 0:
                taken.append(usage)
    return usages


def cpu_of(work: Callable[[], Result]) -> tuple[Seconds, Result]:
    """Return the CPU time of a call in this process, all threads, and its result."""
    began, before = time.perf_counter(), time.process_time()
    result = work()
    taken = Seconds(time.process_time() - before, time.perf_counter() - began)
    return taken, result


def in_turns(works: Sequence[Callable[[], object]], repeats: int) -> list[tuple[Seconds, ...]]:
    """Return the CPU times of functions called in turns; the first turn is thrown away."""
    for work in works:
        work()
    turns = [[cpu_of(work)[0] for work in works] for _ in range(repeats)]
    return [tuple(times) for times in zip(*turns, strict=True)]


def simulated(folder: Path, world: str, minutes: int = 60, seed: int = 1) -> Path:
    """Return a simulated log with a bumper of type Bool; it is written once a run."""
    path = folder / f"{world}-{minutes}min-{seed}.mcap"
    if not path.exists():
        words = {"world": world, "duration": 60 * minutes, "seed": seed, "bumper": "bool"}
        options = [word for name, value in words.items() for word in (f"--{name}", str(value))]
        run_child([MPAP, "simulate", str(path), *options])
    return path
