"""The table of benchmarks: ``make bench``, or ``python benchmarks/run.py NAME...`` for some.

Every figure stands beside a peer or a limit that was measured in turns with it, in the same
run: only the ratios mean anything. CPU time counts; the time on the clock stands beside it
and says how far the machine was shared. Figures are medians, the spread is that of the
ratios. A goal that is not met fails nothing. Each name runs in a process of its own.
"""

import importlib
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.measuring.processes import environment
from benchmarks.measuring.table import COLUMNS, Row, line, packed, shown, unpacked

# Name of a benchmark: its module; the function in it has the name of the benchmark.
BENCHMARKS = {
    "startup": "speed.startup",
    "kernel": "speed.scan_features",
    "reading": "speed.scan_features",
    "chosen": "speed.scan_features",
    "containers": "speed.scan_features",
    "images": "speed.images",
    "insertion": "speed.insertion",
    "affinity": "speed.affinity",
    "strap": "speed.strap",
    "growth": "speed.growth",
    "long_runs": "long_histories.long_runs",
    "learn": "speed.learning",
    "pipeline": "speed.learning",
    "evaluate": "speed.learning",
    "memory": "speed.learning",
}
# These take half an hour and more: only where they are named.
LONG_BENCHMARKS = {"hour": "speed.learning"}
_CHILD = "--in-child"


def measure(name: str, folder: Path) -> list[Row]:
    """Run one benchmark in this process."""
    module = importlib.import_module(f"benchmarks.{(BENCHMARKS | LONG_BENCHMARKS)[name]}")
    rows: list[Row] = getattr(module, name)(folder)
    return rows


def measure_in_child(name: str, folder: Path) -> list[Row]:
    """Run one benchmark in a clean process."""
    command = [sys.executable, __file__, _CHILD, name, str(folder)]
    child = subprocess.run(
        command, env=environment(), stdout=subprocess.PIPE, text=True, check=True
    )
    return [unpacked(cells) for cells in json.loads(child.stdout.splitlines()[-1])]


def main(words: list[str]) -> None:
    """Measure what is named, or everything, and print the table line by line."""
    if words[:1] == [_CHILD]:
        rows = measure(words[1], Path(words[2]))
        print(json.dumps([packed(row) for row in rows]))
        return
    known = BENCHMARKS | LONG_BENCHMARKS
    unknown = [name for name in words if name not in known]
    if unknown:
        sys.exit(f"no benchmark {unknown[0]}; there are {', '.join(known)}")
    print(line(COLUMNS), flush=True)
    began = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="mpap-bench-") as folder:
        for name in words or BENCHMARKS:
            for row in measure_in_child(name, Path(folder)):
                print(shown(row), flush=True)
    print(f"{time.perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main(sys.argv[1:])
