"""How much a model learns from the part of logs that ``mpap extract --novel`` keeps.

``python benchmarks/scores/kept_share.py LOG... [--sensor scan|image] [--keep-ratio R]``. Of the
observations outside the kept part, those that a model of everything explains are counted,
and of these the share that a model learnt from the kept part alone explains. Beside it the
same for stretches as long as those that were kept, or of two seconds, spread evenly over
each log, and for the first part of all logs.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpap_cli.commands.extract import extract
from mpap_cli.commands.extracting.request import NOVEL, ExtractRequest
from mpap_cli.commands.inputs.meeting import known_scans, meet
from mpap_cli.commands.inputs.models import Models
from mpap_cli.commands.inputs.progress import no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, Source, open_sources
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import MpapError, UsageError
from mpap_cli.evaluation.keeping import Moment, by_log
from mpap_cli.logs.passthrough.cuts import Cut, cut_records
from mpap_cli.logs.passthrough.reader import PassthroughLog
from mpap_cli.logs.reader import LogPath
from mpap_cli.logs.writing.raw_log import SUFFIXES, RawLogWriter
from mpap_cli.observations import NS_PER_S, BoolArray, Float32Array, IntArray
from mpap_cli.outputs.text_table import aligned
from mpap_cli.params import make_settings
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.obstacles import KnownExemplars

SETTINGS = make_settings()
SHORT_NS = 2 * NS_PER_S


@dataclass(frozen=True, slots=True)
class Way:
    """A way to choose what is kept: its segments, and the logs cut out by them."""

    name: str
    segments: Sequence[Moment]
    logs: Sequence[Path]


def main(words: Sequence[str]) -> int:
    """Keep parts in several ways and print what each teaches."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", nargs="+", metavar="LOG")
    parser.add_argument("--sensor", choices=("scan", "image"), default="scan")
    parser.add_argument("--keep-ratio", type=float, default=0.1)
    parser.add_argument("--lookback", type=float)
    parser.add_argument("--post", type=float)
    asked = parser.parse_args(words)
    keep_kernels_writable()
    try:
        with tempfile.TemporaryDirectory(prefix="mpap-kept-") as folder, one_thread_each():
            ways = kept_in_all_ways(asked, Path(folder))
            print("\n".join(aligned(list(page(asked, ways)), right={1, 2, 3})))
    except MpapError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return error.exit_code
    return 0


def kept_in_all_ways(asked: argparse.Namespace, folder: Path) -> list[Way]:
    """Keep by extract, and the same share in other ways."""
    selection = LogSelection(logs=tuple(asked.logs), sensor=asked.sensor)
    request = ExtractRequest(
        out=folder / "novel",
        reason=NOVEL,
        keep_ratio=asked.keep_ratio,
        lookback_s=asked.lookback,
        post_s=asked.post,
        jobs=1,
    )
    found = extract(selection, SettingsRequest(), request)
    bounds = [log_bounds(path) for path in selection.paths()]
    ours = [
        Moment(
            row.log_index,
            round(row.start_s * NS_PER_S) + bounds[row.log_index][0],
            round(row.end_s * NS_PER_S) + bounds[row.log_index][0],
            row.score,
        )
        for row in found.rows
    ]
    assert found.folder is not None  # noqa: S101  # no dry run
    ways = [Way("extract --novel", ours, [found.folder / name for name in found.logs])]
    mean_ns = int(sum(one.length_ns for one in ours) / max(len(ours), 1))
    others = {
        "uniform, as long": uniform(bounds, asked.keep_ratio, mean_ns),
        "uniform, 2 s": uniform(bounds, asked.keep_ratio, SHORT_NS),
        "the first of all": first(bounds, asked.keep_ratio),
        "the first of each": [
            Moment(index, start_ns, start_ns + int((end_ns - start_ns) * asked.keep_ratio), 0.0)
            for index, (start_ns, end_ns) in enumerate(bounds)
        ],
    }
    paths = selection.paths()
    for number, (name, segments) in enumerate(others.items()):
        target = folder / str(number)
        target.mkdir()
        ways.append(Way(name, segments, cut(paths, segments, target)))
    return ways


def log_bounds(path: LogPath) -> tuple[int, int]:
    """Return the first stamp of a log and the one behind its last."""
    selection = LogSelection(logs=(str(path),), sensor="auto")
    for source in open_sources(selection, SETTINGS, Losses()):
        return source.replay.start_ns, source.replay.end_ns + 1
    raise AssertionError


def uniform(bounds: Sequence[tuple[int, int]], ratio: float, length_ns: int) -> list[Moment]:
    """Spread stretches evenly over the joined logs, those that straddle two logs parted."""
    total_ns = sum(end_ns - start_ns for start_ns, end_ns in bounds)
    step_ns = int(length_ns / ratio)
    begins = range((step_ns - length_ns) // 2, total_ns, step_ns)
    return [part for begin in begins for part in parts(bounds, begin, begin + length_ns)]


def first(bounds: Sequence[tuple[int, int]], ratio: float) -> list[Moment]:
    """Take the first part of the joined logs."""
    total_ns = sum(end_ns - start_ns for start_ns, end_ns in bounds)
    return parts(bounds, 0, int(total_ns * ratio))


def parts(bounds: Sequence[tuple[int, int]], begin: int, end: int) -> list[Moment]:
    """Return what a stretch of the joined logs is in each of them."""
    found, before = [], 0
    for index, (start_ns, end_ns) in enumerate(bounds):
        length = end_ns - start_ns
        low, high = max(begin - before, 0), min(end - before, length)
        if low < high:
            found.append(Moment(index, start_ns + low, start_ns + high, 0.0))
        before += length
    return found


def cut(paths: Sequence[LogPath], segments: Sequence[Moment], folder: Path) -> list[Path]:
    """Cut segments out of logs."""
    written = []
    for index, of_log in by_log(segments):
        with PassthroughLog(paths[index]) as log:
            target = folder / f"{index}{SUFFIXES.get(log.origin.container, '')}"
            cuts = [Cut(one.start_ns, one.end_ns) for one in of_log]
            channels = dict(enumerate(log.channels))
            with RawLogWriter(target, log.origin, channels) as writer:
                for _, record in cut_records(log, channels, cuts):
                    writer.write(record)
        written.append(target)
    return written


def page(asked: argparse.Namespace, ways: Sequence[Way]) -> Iterator[Sequence[str]]:
    """Lay out what each way teaches."""
    everything = learn(asked.logs, asked.sensor)
    taught = [learn(way.logs, asked.sensor) for way in ways]
    rest = np.zeros(len(ways))
    explained = np.zeros(len(ways))
    for index, stamps_ns, features in observations(asked.logs, asked.sensor):
        by_all = ~everything.unknown(features)
        for number, (way, known) in enumerate(zip(ways, taught, strict=True)):
            counted = by_all & ~inside(stamps_ns, way.segments, index)[:, None]
            rest[number] += counted.sum()
            explained[number] += (counted & ~known.unknown(features)).sum()
    yield "kept", "seconds", "segments", "explained of the rest, %"
    for way, share in zip(ways, 100 * explained / np.maximum(rest, 1), strict=True):
        seconds = sum(one.length_ns for one in way.segments) / NS_PER_S
        yield way.name, f"{seconds:.1f}", f"{len(way.segments)}", f"{share:.1f}"


def inside(stamps_ns: IntArray, segments: Sequence[Moment], index: int) -> BoolArray:
    """Mark observations of a log that lie in a segment."""
    found = np.zeros(stamps_ns.size, np.bool_)
    for one in segments:
        if one.log_index == index:
            found |= (stamps_ns >= one.start_ns) & (stamps_ns < one.end_ns)
    return found


def learn(logs: Sequence[Path | str], sensor: str) -> KnownExemplars:
    """Learn logs; return what is known then."""
    models = Models(SETTINGS)
    for source in sources(logs, sensor):
        for _ in meet(models, source, sensor, 1, no_progress):
            pass
    if sensor == "image":
        assert models.appearance is not None  # noqa: S101  # a log was met
        return models.appearance.known()
    assert models.collision is not None  # noqa: S101  # a log was met
    return known_scans(models.collision.meta_points)


def sources(logs: Sequence[Path | str], sensor: str) -> Iterator[Source]:
    """Open logs one by one; a short part may hold no scan or image."""
    for log in logs:
        selection = LogSelection(logs=(str(log),), sensor=sensor)
        with suppress(UsageError):
            yield from open_sources(selection, SETTINGS, Losses())


def observations(logs: Sequence[str], sensor: str) -> Iterator[tuple[int, IntArray, Float32Array]]:
    """Yield log, stamps (n,) and features (n, k, d) of all observations."""
    for index, source in enumerate(sources(logs, sensor)):
        if sensor == "image":
            seer = AppearanceModel(SETTINGS)
            seer.begin_log(source.start)
            for batch in source.batches():
                patches = seer.embed(batch.frames)
                yield index, patches.stamps_ns, patches.features
            continue
        model = CollisionModel(SETTINGS)
        model.begin_log(source.start)
        for batch in source.batches():
            for block in batch.scans:
                features = model.embed(block)
                yield index, features.stamps_ns, features.features[:, None]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
