"""Many hours of learning: memory, CPU time and the size of the model, hour by hour.

``make bench`` compares hour 10 with hour 1;
``python benchmarks/long_histories/long_runs.py --hours 100`` prints a table of each run
for as many hours as asked for. Every run is a process of its own, learns each hour as a log of
its own, and writes the model after the hours that are shown.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.long_histories.histories import write_scans
from benchmarks.long_histories.long_models import (
    Hour,
    ImageRun,
    LongRun,
    ScanRun,
    learn_hours,
    peak_mb,
    warm_up,
)
from benchmarks.long_histories.patch_histories import draw_views
from benchmarks.measuring.processes import run_child
from benchmarks.measuring.table import Row
from mpap_cli.outputs.model_file import write_model
from mpap_cli.outputs.text_table import aligned

_LONG_H = 10
_LAST_HOURS = 3
_SHOWN_H = (1, 2, 5, 10, 20, 50, 100)
_CHILD = "--in-child"
# Name of a run: what makes it, the history that it learns from, the profile.
RUNS: dict[str, tuple[Callable[[Path, str], LongRun], str, str]] = {
    "scans": (ScanRun, "known-ways", "robust"),
    "scans-paper": (ScanRun, "known-ways", "paper"),
    "images": (ImageRun, "views", "robust"),
    "scans-new-ways": (ScanRun, "new-ways", "robust"),
    "scans-paper-new-ways": (ScanRun, "new-ways", "paper"),
}
_BENCHED = ("scans", "scans-paper", "images")


def long_runs(folder: Path) -> list[Row]:
    """Compare the last of ten hours, in known surroundings, with the first."""
    return [row for name in _BENCHED for row in _rows(name, folder)]


def _rows(name: str, folder: Path) -> Iterator[Row]:
    """Compare time, memory and sizes; the time in hour 1 is that after all places are known."""
    hours = _in_child(name, folder, _LONG_H, (1, _LONG_H))
    first, last = hours[0], hours[-1]
    yield Row(
        work=f"{name}, CPU for a message, hour {_LONG_H}",
        mpap=tuple(hour.known_us for hour in hours[-_LAST_HOURS:]),
        beside="in hour 1, once the places are known",
        peer=(first.known_us,),
        unit="us",
        goal="<= 1.15x",
    )
    yield Row(
        work=f"{name}, peak memory, {_LONG_H} hours",
        mpap=(last.peak_mb,),
        beside="after hour 1",
        peer=(first.peak_mb,),
        unit="MB",
        goal="<= 1.1x",
    )
    (kind, n_last), n_first = next(iter(last.kinds.items())), next(iter(first.kinds.values()))
    yield Row(
        work=f"{name}, {kind}, {_LONG_H} hours",
        mpap=(n_last,),
        beside="after hour 1",
        peer=(n_first,),
        unit="",
        goal="<=",
    )


def _history(name: str, folder: Path, hours: int) -> Path:
    """Return the path of what a run learns from; it is made once a folder."""
    _, history, _ = RUNS[name]
    if history == "views":
        return draw_views(folder)
    path = folder / f"{history}-{hours}.npz"
    return write_scans(path, hours, new_ways=history == "new-ways")


def _in_child(name: str, folder: Path, hours: int, shown: Sequence[int]) -> list[Hour]:
    """Let a process of its own learn; return what it says of each hour."""
    path = _history(name, folder, hours)
    command = [sys.executable, __file__, _CHILD, name, str(path)]
    run_child([*command, "0"])  # compiles the kernels, which takes memory of its own
    output = run_child([*command, str(hours), *map(str, shown)]).output
    return [Hour(**json.loads(line)) for line in output.splitlines()]


def _tell_hours(name: str, path: Path, hours: int, shown: Sequence[int]) -> None:
    """Learn, and print each hour as JSON; of those shown with the size of the model."""
    make, _, profile = RUNS[name]
    warm_up(make(path, profile))
    run = make(path, profile)
    for hour in learn_hours(run, hours):
        kinds = hour.kinds
        if hour.hour in shown:
            kinds = {**kinds, **_written(run, path.with_suffix(".model"))}
        found = {**asdict(hour), "kinds": kinds, "peak_mb": peak_mb()}
        print(json.dumps(found), flush=True)


def _written(run: LongRun, path: Path) -> dict[str, int]:
    """Write the model; return how large it is and how long it took, clustering included."""
    before_s = time.process_time()
    state = run.model.state()
    write_model(path, state.header, state.arrays)
    spent_s = time.process_time() - before_s
    return {"model kB": path.stat().st_size // 1000, "clustered and written ms": int(1e3 * spent_s)}


def print_table(name: str, folder: Path, hours: int) -> None:
    """Print what each of the shown hours of a run took."""
    shown = [hour for hour in _SHOWN_H if hour <= hours]
    found = [one for one in _in_child(name, folder, hours, shown) if one.hour in shown]
    kinds = list(found[0].kinds)
    lines = [(f"{name}, hour", "CPU us", "once known", "peak MB", *kinds)]
    lines += [
        (
            str(one.hour),
            f"{one.cpu_us:.2f}",
            f"{one.known_us:.2f}",
            f"{one.peak_mb:.0f}",
            *(f"{one.kinds[kind]:,}" for kind in kinds),
        )
        for one in found
    ]
    print("\n".join(aligned(lines, right=range(1, len(lines[0])))), flush=True)


def main(words: Sequence[str]) -> None:
    """Print the tables of the runs that are named, or of all."""
    if words[:1] == [_CHILD]:
        name, path, hours, *shown = words[1:]
        _tell_hours(name, Path(path), int(hours), [int(hour) for hour in shown])
        return
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", nargs="*", metavar="RUN", help=", ".join(RUNS))
    parser.add_argument("--hours", type=int, default=100)
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where histories are kept")
    asked = parser.parse_args(words)
    for name in asked.runs:
        if name not in RUNS:
            parser.error(f"no run {name}; there are {', '.join(RUNS)}")
    with tempfile.TemporaryDirectory(prefix="mpap-hours-") as folder:
        for name in asked.runs or RUNS:
            print_table(name, asked.keep or Path(folder), asked.hours)


if __name__ == "__main__":
    main(sys.argv[1:])
