"""How fast logs without an index are read, beside whole ones, and in how much memory."""

import time
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.measuring.guarded import Limits, guarded
from benchmarks.robustness.linear_scan import places_in
from mpap_cli.logs.reader import open_log

LONG_CHUNK_BYTES = 1 << 20
_SPEED_COLUMNS = """CPU time of reading all messages, of the log as it is and without its end
log                     MB     chunk    whole   no end   share   memory of both [MB]"""


def compare_speed(logs: list[Path], folder: Path) -> None:
    """Print how fast and in how much memory logs are read, whole and without their end."""
    print(_SPEED_COLUMNS)
    for log in logs:
        print(_speed_and_memory(log, folder), flush=True)


def _speed_and_memory(log: Path, folder: Path) -> str:
    """Compare reading a log with reading it without what stands at its end."""
    storage = log
    if log.is_dir():
        (storage,) = (path for path in log.iterdir() if path.suffix != ".yaml")
    content = storage.read_bytes()
    cut = folder / f"endless-{storage.name}"
    cut.write_bytes(content[: len(content) - max(len(content) // 200, 2_000)])
    places = places_in(content)
    largest = max(sum(end - begin for begin, end in place.pieces) for place in places)
    times, memory = [], []
    for path in (storage, cut):
        _time(path)  # compiles and loads the kernels, once for all children
        outcomes = [guarded(partial(_time, path), Limits(300, 4096)) for _ in range(3)]
        times.append(min(outcome.result or np.inf for outcome in outcomes))
        memory.append(max(outcome.grown_mb for outcome in outcomes))
    sizes = f"{len(content) / 1e6:7.1f} {largest / 1e6:8.2f}"
    taken = f"{times[0]:8.2f} {times[1]:8.2f} {times[0] / times[1]:7.2f}"
    return f"{log.name:22} {sizes} {taken} {memory[0]:8.0f} {memory[1]:8.0f}"


def _time(path: Path) -> float:
    """Return the CPU time of reading all messages as blocks do."""
    begin = time.process_time()
    with open_log(path) as reader:
        for _ in reader.runs([topic.name for topic in reader.topics]):
            pass
    return time.process_time() - begin
