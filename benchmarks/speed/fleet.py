"""Many logs at once: the wall time of ``learn --merge`` with one worker and with two.

``python benchmarks/speed/fleet.py [--logs 16] [--minutes 240] [--repeats 1]`` simulates the logs,
learns them in turns with ``--jobs 1`` and ``--jobs 2`` into empty folders, and prints both
wall times, their ratio, and whether the results are the same bytes. Starting workers counts.
It is of no use on a machine whose processors have other work: the load is printed.
"""

import argparse
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

from benchmarks.measuring.processes import MPAP, run_child, simulated

_GOAL = 0.6
_WORLDS = 2
_SAME = ("clusters.csv", "model.npz", "recording.npz")


def learn_merged(logs: list[Path], jobs: int, out: Path) -> tuple[float, float]:
    """Learn into an empty folder; return wall time and CPU time, of the workers too."""
    shutil.rmtree(out, ignore_errors=True)
    words = [MPAP, "learn", "--merge", *map(str, logs), "--jobs", str(jobs), "-o", str(out), "-q"]
    began = time.perf_counter()
    usage = run_child(words)
    return time.perf_counter() - began, usage.cpu_s


def named_logs(folder: Path, n_logs: int, minutes: int) -> list[Path]:
    """Return logs of two worlds under as many names as are wanted; no two are the same log."""
    worlds = [simulated(folder, "indoor", minutes, 1 + n) for n in range(min(_WORLDS, n_logs))]
    logs = [folder / f"log{n:03d}.mcap" for n in range(n_logs)]
    for n, log in enumerate(logs):
        shutil.copyfile(worlds[n % _WORLDS], log)
    return logs


def main() -> None:
    """Print the figures; exit with 1 if results differ or the goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=16, help="how many (16)")
    parser.add_argument("--minutes", type=int, default=240, help="each of them (240)")
    parser.add_argument("--repeats", type=int, default=1, help="in turns (1)")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="mpap-fleet-") as name:
        folder = Path(name)
        logs = named_logs(folder, asked.logs, asked.minutes)
        ratios = list[float]()
        for turn in range(asked.repeats):
            walls = list[float]()
            for jobs in (1, 2):
                wall_s, cpu_s = learn_merged(logs, jobs, folder / f"jobs{jobs}")
                walls.append(wall_s)
                load = os.getloadavg()[0]
                print(
                    f"turn {turn + 1}: {len(logs)} logs of {asked.minutes} min, --jobs {jobs}: "
                    f"{wall_s:.1f} s wall, {cpu_s:.1f} s CPU, load {load:.1f}",
                    flush=True,
                )
            ratios.append(walls[1] / walls[0])
        same = all(
            (folder / "jobs1/learn" / file).read_bytes()
            == (folder / "jobs2/learn" / file).read_bytes()
            for file in _SAME
        )
    met = median(ratios) <= _GOAL
    print(f"2 workers / 1 worker: {median(ratios):.2f}x (goal <= {_GOAL}x, met: {met})")
    print(f"same bytes: {same}")
    sys.exit(not (met and same))


if __name__ == "__main__":
    main()
