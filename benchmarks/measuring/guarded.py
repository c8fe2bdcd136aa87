"""Work in a child process with limits of time and memory: a hang or a crash ends nothing else."""

import gc
import os
import pickle
import resource
import signal
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

Result = TypeVar("Result")

_WAIT_FACTOR = 10  # other processes may take turns on the processor
_KILLED_LATE = (signal.SIGALRM, signal.SIGXCPU)


@dataclass(frozen=True, slots=True)
class Limits:
    """What a child may take: seconds of CPU time (tenfold by the clock), MB of address space."""

    seconds: float = 10.0
    memory_mb: float = 1024.0


@dataclass(frozen=True, slots=True)
class Outcome(Generic[Result]):
    """How a child ended: with a result, or with the text of a crash, or late.

    ``grown_mb`` is how far its memory rose above that of the parent; ``cpu_s`` its CPU time.
    """

    result: Result | None
    crash: str
    is_late: bool
    grown_mb: float
    cpu_s: float


def guarded(work: Callable[[], Result], limits: Limits) -> Outcome[Result]:
    """Call a function in a fork of this process.

    Parameters
    ----------
    work : callable
        Its result must be picklable.
    limits : Limits
        Of the child.

    Returns
    -------
    Outcome
        A crash is any exception, running out of memory, or the end by a signal.
    """
    begin, end = os.pipe()
    sys.stdout.flush()
    pid = os.fork()
    if pid == 0:
        os.close(begin)
        _be_child(work, limits, end)
    os.close(end)
    with os.fdopen(begin, "rb") as stream:
        sent = stream.read()
    _, status, used = os.wait4(pid, 0)
    cpu_s = used.ru_utime + used.ru_stime
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        is_late = number in _KILLED_LATE
        crash = "" if is_late else f"killed by {signal.Signals(number).name}"
        return Outcome(None, crash, is_late, used.ru_maxrss / 1024 - _memory_mb("VmRSS"), cpu_s)
    result, crash, grown_mb = pickle.loads(sent)  # noqa: S301  # our own child wrote it
    return Outcome(result, crash, is_late=False, grown_mb=grown_mb, cpu_s=cpu_s)


def _be_child(work: Callable[[], Result], limits: Limits, end: int) -> None:
    """Do the work, send what came of it, and leave without unwinding the parent's frames."""
    result, crash = None, ""
    gc.disable()  # a collection would copy the pages that are shared with the parent
    before_mb = _memory_mb("VmRSS")
    _limit(limits)
    try:
        result = work()
    except BaseException:  # noqa: BLE001  # whatever it is, it is a crash to be told
        crash = traceback.format_exc()
    grown_mb = _memory_mb("VmHWM") - before_mb
    with os.fdopen(end, "wb") as stream:
        stream.write(pickle.dumps((result, crash, grown_mb)))
    os._exit(0)


def _limit(limits: Limits) -> None:
    """Set the limits of this process."""
    most_bytes = int((_memory_mb("VmSize") + limits.memory_mb) * 2**20)
    resource.setrlimit(resource.RLIMIT_AS, (most_bytes, most_bytes))
    for number in _KILLED_LATE:
        signal.signal(number, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, _WAIT_FACTOR * limits.seconds)
    seconds = int(limits.seconds) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))


def _memory_mb(name: str) -> float:
    """Return a line of the kernel's account of this process."""
    lines = Path("/proc/self/status").read_text(encoding="ascii", errors="replace").splitlines()
    kilobytes = next(line.split()[1] for line in lines if line.startswith(f"{name}:"))
    return int(kilobytes) / 1024
