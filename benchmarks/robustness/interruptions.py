"""Interrupt runs at random moments: exit code 130, one line, soon.

``python -m benchmarks.robustness.interruptions --times 100``
prints one line a command. A moment lies
anywhere between the first line of ``mpap_cli.__main__`` that heeds signals and the end of
an undisturbed run; a run that was done before ends with 0.
"""

import argparse
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.measuring.processes import environment

_FIXTURES = Path(__file__).parents[2] / "fixtures"
_LOG, _OTHER, _CAMERA = (
    str(_FIXTURES / name) for name in ("indoor-a.bag", "indoor-a2.mcap", "camera-a.mcap")
)
_LINE = "mpap: interrupted; results are whole, older or new"
_PATIENCE_S = 60.0
_TICKS = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Ending:
    """How a run ended after its SIGINT."""

    code: int
    wall_s: float
    cpu_s: float
    said: str

    @property
    def is_clean(self) -> bool:
        """Whether it told of the interruption in one line, or had been done before."""
        if self.code == 0:
            return "Traceback" not in self.said and "Exception ignored" not in self.said
        ours = [line for line in self.said.splitlines() if line]
        others = [line for line in ours if not line.startswith("mpap: ")]
        return self.code == 130 and ours.count(_LINE) == 1 and not others  # noqa: PLR2004


def commands(model: Path) -> dict[str, list[str]]:
    """Return the command lines that are interrupted."""
    return {
        "info": ["info", _LOG, _CAMERA],
        "learn": ["learn", _CAMERA, _LOG],
        "evaluate": ["evaluate", _LOG],
        "predict": ["predict", str(model), _LOG, "--to-mcap"],
        "novelty": ["novelty", _CAMERA],
        "compare": ["compare", _LOG, _OTHER],
    }


def _line(words: list[str], out: Path) -> list[str]:
    """Return the whole command line."""
    line = [sys.executable, "-m", "mpap_cli", *words]
    return line if words[0] == "info" else [*line, "-o", str(out)]


def _run(words: list[str], out: Path) -> None:
    """Run a command undisturbed."""
    subprocess.run(_line(words, out), env=environment(), capture_output=True, check=True)


def interrupt(words: list[str], out: Path, delay_s: float) -> Ending:
    """Run a command, interrupt it so long after it first heeds signals, and wait for its end."""
    quiet, pipe = subprocess.DEVNULL, subprocess.PIPE
    with subprocess.Popen(
        _line(words, out), env=environment(), stdout=quiet, stderr=pipe, text=True
    ) as child:
        await_heed(child)
        time.sleep(delay_s)
        return end(child)


def await_heed(child: "subprocess.Popen[str]") -> None:
    """Wait until a run has a handler of its own for SIGHUP, or is dead."""
    while True:
        status = Path(f"/proc/{child.pid}/status").read_text(encoding="utf-8")
        caught = next((line for line in status.splitlines() if line.startswith("SigCgt")), "x 0")
        if "\nState:\tZ" in status or int(caught.split()[1], 16) >> (signal.SIGHUP - 1) & 1:
            return
        time.sleep(0.0005)


def end(child: "subprocess.Popen[str]", number: int = signal.SIGINT) -> Ending:
    """Send a signal to a run whose stderr is a pipe, and wait for its end.

    Raises
    ------
    subprocess.TimeoutExpired
        If it does not end within a minute.
    """
    before_s, asked_s = cpu_s(child.pid), time.monotonic()
    reaped = resource.getrusage(resource.RUSAGE_CHILDREN)
    os.kill(child.pid, number)  # a dead one waits to be asked about
    _, said = child.communicate(timeout=_PATIENCE_S)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    wall_s = time.monotonic() - asked_s
    took_s = used.ru_utime + used.ru_stime - reaped.ru_utime - reaped.ru_stime
    return Ending(child.returncode, wall_s, took_s - before_s, said)


def cpu_s(process: int) -> float:
    """Return the CPU time of a process so far, all threads."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS


def main() -> None:
    """Print a line a command; exit with 1 if one did not end as it should."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=100, help="each command (100)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", default="", help="with commas; all without")
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    n_bad = 0
    print("command    runs  exit codes            worst wall s  worst CPU s  not clean", flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _run(["learn", _LOG], folder / "model")
        lines = commands(folder / "model" / "learn" / "model.npz")
        for command in asked.commands.split(",") if asked.commands else lines:
            words, out = lines[command], folder / "out"
            began_s = time.monotonic()
            _run(words, out)
            took_s = time.monotonic() - began_s
            endings = [interrupt(words, out, rng.uniform(0, took_s)) for _ in range(asked.times)]
            bad = [ending for ending in endings if not ending.is_clean]
            n_bad += len(bad)
            codes = dict(sorted(Counter(ending.code for ending in endings).items()))
            worst = max(ending.wall_s for ending in endings), max(e.cpu_s for e in endings)
            print(
                f"{command:<11}{len(endings):<6}{codes!s:<22}{worst[0]:<14.2f}{worst[1]:<13.2f}"
                f"{len(bad)}",
                flush=True,
            )
            for ending in bad:
                print(f"  {ending.code}: {ending.said[-400:]}", flush=True)
    sys.exit(n_bad > 0)


if __name__ == "__main__":
    main()
