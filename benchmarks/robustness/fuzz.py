"""Readers against changed bytes: ``python benchmarks/robustness/fuzz.py --minutes M [LOG...]``.

Every case changes a few bytes of a log, or of a plain copy without checksums, and goes
through what the commands do with it: open, choose topics, survey, replay of all sensors,
decoding. Each runs in a process of its own with 10 s of CPU time and 1 GiB. Inputs that
crash or hang are kept. Ends with 1 if there are any.
"""

import argparse
import logging
import os
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import count, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.measuring.guarded import Limits, Outcome, guarded
from benchmarks.robustness.damaged_logs import write_logs, write_plain
from benchmarks.robustness.mutations import mutated
from mpap_cli.errors import MpapError
from mpap_cli.features.images.frame_decoder import FrameDecoder
from mpap_cli.logs.fields import TimeSource
from mpap_cli.logs.raw import LogReader, PayloadError
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.replay_options import SENSORS, ReplayOptions
from mpap_cli.logs.survey import survey_log
from mpap_cli.logs.topics import Roles, TopicChoice, choose_roles
from mpap_cli.params import BumperParams

TIME_SOURCES: tuple[TimeSource, ...] = ("log", "header")
_MOST_BYTES = 4 << 20
_MOST_LOGGED_BYTES = 64 << 20
_DECODED = 5
_METADATA_SHARE = 0.2
_MADE = ("none.bag", "unchunked.mcap", "json.mcap", "sqlite3", "sqlite3-zstd-message")
_SUFFIXES = (".bag", ".active", ".mcap", ".db3", ".zstd")


class Base(NamedTuple):
    """A log to be changed: a file, or the files of a folder."""

    path: Path
    files: list[Path]


def bases_of(folder: Path, given: list[Path]) -> Iterator[Base]:
    """Yield the logs given, made ones if there is none, and their plain copies."""
    logs = given or write_logs(folder, 10.0, _MADE)
    for number, path in enumerate(logs):
        files = [path] if path.is_file() else sorted(p for p in path.iterdir() if p.is_file())
        if not files or sum(file.stat().st_size for file in files) > _MOST_LOGGED_BYTES:
            continue
        yield Base(path, files)
        plain = folder / f"plain-{number}.mcap"
        try:
            write_plain(path, plain, _MOST_BYTES)
        except MpapError:
            continue
        yield Base(plain, [plain])


def logs_in(folder: Path) -> list[Path]:
    """Find the logs of a folder and its subfolders; a rosbag2 folder is one."""
    found = {path.parent for path in folder.rglob("metadata.yaml")}
    files = [path for path in folder.rglob("*") if path.is_file() and path.suffix in _SUFFIXES]
    return sorted(found | {path for path in files if path.parent not in found})


def write_case(base: Base, rng: np.random.Generator, folder: Path) -> Path:
    """Write a changed copy of a log; large files are cut first."""
    storages = [file for file in base.files if file.suffix in _SUFFIXES] or base.files
    others = [file for file in base.files if file not in storages]
    is_other = bool(others) and rng.random() < _METADATA_SHARE
    chosen = (others if is_other else storages)[rng.integers(len(others if is_other else storages))]
    target = folder / base.path.name
    if base.path.is_dir():
        target.mkdir()
    for file in base.files:
        copy = target / file.name if base.path.is_dir() else target
        with file.open("rb") as stream:
            content = stream.read(_MOST_BYTES)
        copy.write_bytes(mutated(rng, content) if file == chosen else content)
    return target


def go_through(path: Path) -> str:
    """Do what the commands do with a log; return how it ended."""
    try:
        with open_log(path) as reader:
            roles = _roles(reader)
            survey_log(reader, roles)
            for source in TIME_SOURCES:
                _replay(reader, roles, source)
            _decode(reader)
            return "damage told" if reader.damage else "read"
    except MpapError:
        return "refused"


def _replay(reader: LogReader, roles: Roles, source: TimeSource) -> None:
    """Play all sensors back and decode some of the images."""
    if source == "header":  # few bumpers have one
        roles = replace(roles, bumps=())
    options = ReplayOptions(time_source=source, sensors=frozenset(SENSORS))
    decoder = FrameDecoder()
    for batch in Replay(reader, roles, BumperParams(), options):
        list(decoder.decode(batch.frames[:_DECODED]))


def _roles(reader: LogReader) -> Roles:
    """Choose topics; where the choice is the user's, the first."""
    roles = choose_roles(reader)
    scan = roles.scan_candidates[0] if roles.scan is None and roles.scan_candidates else None
    image = roles.image_candidates[0] if roles.image is None and roles.image_candidates else None
    return choose_roles(reader, TopicChoice(scan=scan, image=image)) if scan or image else roles


def _decode(reader: LogReader) -> None:
    """Decode the first messages of every topic by its definition."""
    for topic in reader.topics:
        for message in islice(reader.messages([topic.name]), _DECODED):
            try:
                reader.decode(message)
            except PayloadError:
                continue
            except MpapError:
                break


class Fuzzer:
    """Runs cases until the time is over and adds up how they ended."""

    def __init__(self, bases: list[Base], seed: int, keep: Path) -> None:
        self._bases = bases
        self._seed = seed
        self._keep = keep
        self.ends: Counter[str] = Counter()
        self.worst_mb = self.worst_s = 0.0
        self.worst_case = ""

    def run(self, number: int) -> None:
        """Run one case."""
        rng = np.random.default_rng((self._seed, number))
        base = self._bases[rng.integers(len(self._bases))]
        with tempfile.TemporaryDirectory() as name:
            path = write_case(base, rng, Path(name))
            outcome = guarded(partial(go_through, path), Limits())
            self._judge(outcome, path, number)

    def _judge(self, outcome: Outcome[str], path: Path, number: int) -> None:
        """Add one case; keep what crashes or hangs."""
        if outcome.grown_mb > self.worst_mb:
            self.worst_mb, self.worst_case = outcome.grown_mb, f"case {number}, {path.name}"
        self.worst_s = max(self.worst_s, outcome.cpu_s)
        crash = "hangs" if outcome.is_late else outcome.crash.strip()
        self.ends[(crash and crash.splitlines()[-1]) or outcome.result or ""] += 1
        if crash:
            kept = self._keep / f"{self._seed}-{number}-{path.name}"
            print(f"case {number}: {kept}\n{crash}", flush=True)
            if not kept.exists():
                self._keep.mkdir(parents=True, exist_ok=True)
                (shutil.copytree if path.is_dir() else shutil.copyfile)(path, kept)
            self.ends["crashes and hangs"] += 1


def main() -> int:
    """Run for so many minutes and say what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("logs", nargs="*", type=Path, help="logs, or folders of logs")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--case", type=int, help="only this one")
    parser.add_argument("--keep", type=Path, default=Path("mpap-out/fuzz"))
    asked = parser.parse_args()
    logging.disable()
    given = [log for path in asked.logs for log in (logs_in(path) if path.is_dir() else [path])]
    with tempfile.TemporaryDirectory() as name:
        bases = list(bases_of(Path(name), given))
        for base in bases:
            go_through(base.path)  # compiles the kernels, once for all children
        fuzzer = Fuzzer(bases, asked.seed, asked.keep)
        until = time.monotonic() + 60 * asked.minutes
        for number in count() if asked.case is None else [asked.case]:
            if time.monotonic() > until:
                break
            fuzzer.run(number)
    n_bad = fuzzer.ends.pop("crashes and hangs", 0)
    print(f"{fuzzer.ends.total():,} cases of {len(bases)} logs, seed {asked.seed}:")
    for end, n_cases in fuzzer.ends.most_common():
        print(f"  {n_cases:7,} {end}")
    print(
        f"worst memory {fuzzer.worst_mb:.0f} MB ({fuzzer.worst_case}), time {fuzzer.worst_s:.1f} s"
    )
    return int(n_bad > 0)


if __name__ == "__main__":
    os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
    sys.exit(main())
