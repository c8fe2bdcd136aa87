"""What is saved of damaged logs: ``python benchmarks/robustness/damage.py [LOG...]``.

Every log is cut at many places and gets one byte changed at many places; each copy is opened
and read in a process of its own with a limit of time and memory. What mpap finds stands beside
what a plain scan finds that knows the undamaged log. Without logs, small ones are made, in
every container. Then: how fast logs without index are read, and in how much memory.
"""

import argparse
import shutil
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.measuring.guarded import Limits, Outcome, guarded
from benchmarks.robustness.damaged_logs import KINDS, write_logs
from benchmarks.robustness.linear_scan import (
    Key,
    Place,
    is_packed_checked,
    key_of,
    places_in,
    whole_messages,
)
from benchmarks.robustness.salvage_speed import LONG_CHUNK_BYTES, compare_speed
from mpap_cli.errors import MpapError
from mpap_cli.logs.reader import open_log

Damaged = Iterator[tuple[int, bytes]]

DAMAGES = ("cut", "flip")
_STORAGES = (".db3", ".mcap", ".zstd")
_COLUMNS = (
    ("container", 24), ("damage", 7), ("cases", 6), ("scan", 8), ("mpap", 8), ("short", 6),
    ("crashes", 8), ("hangs", 6), ("wrong", 6), ("unchecked", 10), ("unsaid", 7), ("MB", 7),
)  # fmt: skip
_LEGEND = """
scan        messages whose bytes are whole, by a plain scan that knows the undamaged log
mpap        those messages of the undamaged log that mpap gives, each once
short       cases in which mpap gives fewer than the scan finds
crashes     errors that are not mpap's own sentence, or more than 1 GiB asked for
hangs       more than 10 s of CPU time
wrong       messages given that the log never held, where a checksum could tell
unchecked   the same where the container has no checksum: it cannot be detected
unsaid      cases in which messages are lost and neither damage nor warning is told
MB          largest growth of memory over all cases
"""


@dataclass(frozen=True, slots=True)
class Read:
    """What mpap gave of one copy: the messages, and whether it said that something is wrong."""

    keys: Counter[Key]
    is_told: bool


@dataclass(slots=True)
class Tally:
    """Sums over the copies of one log with one kind of damage."""

    container: str
    damage: str
    cases: int = 0
    scan: int = 0
    mpap: int = 0
    short: int = 0
    crashes: int = 0
    hangs: int = 0
    wrong: int = 0
    unchecked: int = 0
    unsaid: int = 0
    largest_mb: float = 0.0
    notes: list[str] = field(default_factory=list)

    @property
    def is_clean(self) -> bool:
        """Whether nothing falls short that could be better."""
        return not (self.short or self.crashes or self.hangs or self.wrong or self.unsaid)

    def cells(self) -> list[str]:
        """Return the figures as the table shows them."""
        counts = (self.cases, self.scan, self.mpap, self.short, self.crashes, self.hangs)
        rest = (self.wrong, self.unchecked, self.unsaid)
        figures = [f"{count:,}" for count in (*counts, *rest)]
        return [self.container, self.damage, *figures, f"{self.largest_mb:.0f}"]


@dataclass(frozen=True, slots=True)
class Subject:
    """An undamaged log: the file in it that is damaged, and where its messages lie."""

    log: Path
    storage: Path
    content: bytes
    places: list[Place]
    is_checked: bool

    @property
    def held(self) -> Counter[Key]:
        """Return all its messages."""
        return Counter(key for place in self.places for key in place.keys)


def subject_of(log: Path) -> Subject:
    """Look at an undamaged log; of a folder, at its only file of messages."""
    storage = log
    if log.is_dir():
        (storage,) = (path for path in log.iterdir() if path.suffix in _STORAGES)
    content = storage.read_bytes()
    places = places_in(content)
    is_checked = is_packed_checked(content) or all(place.is_checked for place in places)
    return Subject(log, storage, content, places, is_checked)


def damaged(content: bytes, damage: str, n_cases: int, seed: int) -> Damaged:
    """Yield the place of each damage, and the damaged bytes."""
    rng = np.random.default_rng((seed, DAMAGES.index(damage)))
    for place in rng.integers(1, len(content), n_cases).tolist():
        if damage == "cut":
            yield place, content[:place]
        else:
            changed = content[place] ^ int(rng.integers(1, 256))
            yield place, content[:place] + bytes([changed]) + content[place + 1 :]


def read_copy(log: Path) -> Read:
    """Read all messages of a log; one that is refused has none."""
    keys: Counter[Key] = Counter()
    try:
        with open_log(log) as reader:
            names = [topic.name for topic in reader.topics]
            for topic, stamp_ns, payload in reader.messages(names):
                keys[key_of(topic.name, stamp_ns, payload)] += 1
            return Read(keys, bool(reader.damage or reader.warnings))
    except MpapError:
        return Read(keys, is_told=True)


def damage_log(
    subject: Subject, damage: str, n_cases: int, seed: int, folder: Path, limits: Limits
) -> Tally:
    """Damage a log in many places, one after the other, and sum up what is read.

    Parameters
    ----------
    subject : Subject
        The undamaged log.
    damage : {"cut", "flip"}
        Cut off, or one byte changed.
    n_cases, seed : int
        How many places, and of their choice.
    folder : Path
        Where the damaged copy goes.
    limits : Limits
        Of each reading.
    """
    copy = folder / f"{damage}-{subject.log.name}"
    target = copy
    if subject.log.is_dir():
        shutil.copytree(subject.log, copy)
        target = copy / subject.storage.name
    target.write_bytes(subject.content[: len(subject.content) // 2])
    read_copy(copy)  # compiles the kernels, once for all children
    tally = Tally(subject.log.name, damage)
    for place, content in damaged(subject.content, damage, n_cases, seed):
        target.write_bytes(content)
        outcome = guarded(partial(read_copy, copy), limits)
        _judge(subject, tally, outcome, content, f"{tally.container} {damage} at {place:,}")
    return tally


def _judge(
    subject: Subject, tally: Tally, outcome: Outcome[Read], content: bytes, case: str
) -> None:
    """Add one case to the sums."""
    scanned = whole_messages(subject.places, subject.content, content)
    found = outcome.result or Read(Counter(), is_told=True)
    right = found.keys & subject.held
    n_wrong = (found.keys - right).total()
    n_scanned, n_right = scanned.total(), right.total()
    tally.cases += 1
    tally.scan += n_scanned
    tally.mpap += n_right
    tally.crashes += bool(outcome.crash)
    tally.hangs += outcome.is_late
    tally.wrong += n_wrong if subject.is_checked else 0
    tally.unchecked += 0 if subject.is_checked else n_wrong
    is_unsaid = n_right + n_wrong < subject.held.total() and not found.is_told
    tally.unsaid += is_unsaid
    tally.largest_mb = max(tally.largest_mb, outcome.grown_mb)
    missing = (scanned - right).total()
    tally.short += missing > 0
    if outcome.crash or outcome.is_late:
        tally.notes.append(f"{case}: {outcome.crash.strip() or 'hangs'}")
    if missing or is_unsaid or (n_wrong and subject.is_checked):
        tally.notes.append(
            f"{case}: scan {n_scanned}, mpap {n_right}, missing {missing}, wrong {n_wrong}"
            f"{', unsaid' if is_unsaid else ''}"
        )


def line(cells: Sequence[str]) -> str:
    """Lay out one line of the table."""
    widths = [width for _, width in _COLUMNS]
    named = [cell.ljust(width) for cell, width in zip(cells[:2], widths, strict=False)]
    counted = [cell.rjust(width) for cell, width in zip(cells[2:], widths[2:], strict=True)]
    return "".join([*named, *counted])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("logs", nargs="*", type=Path)
    parser.add_argument("--cases", type=int, default=50, help="of each damage (50)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=20.0, help="length of made logs (20)")
    parser.add_argument("--kinds", default=",".join(KINDS), help="of made logs, with commas")
    parser.add_argument("--long", type=float, default=300.0, help="length for the speed (300)")
    parser.add_argument("--verbose", action="store_true", help="tell each case that falls short")
    asked = parser.parse_args()
    kinds = tuple(asked.kinds.split(","))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        logs = asked.logs or write_logs(folder, asked.seconds, kinds)
        print(line([name for name, _ in _COLUMNS]))
        for log in logs:
            subject = subject_of(log)
            for damage in DAMAGES:
                tally = damage_log(subject, damage, asked.cases, asked.seed, folder, Limits())
                print(line(tally.cells()), flush=True)
                if asked.verbose:
                    print(*tally.notes, sep="\n", flush=True)
        print(_LEGEND)
        if asked.long:
            long = folder / "long"
            long.mkdir()
            compare_speed(
                asked.logs or write_logs(long, asked.long, kinds, LONG_CHUNK_BYTES), folder
            )


if __name__ == "__main__":
    main()
