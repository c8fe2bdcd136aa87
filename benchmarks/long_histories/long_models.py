"""Models that learn for many hours, with what each hour took."""

import resource
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Protocol

from benchmarks.long_histories.histories import HOUR_NS, KNOWN_AFTER_H, START_NS, bumps_of
from benchmarks.long_histories.patch_histories import PatchHistory, Way
from mpap_cli.observations import Batch
from mpap_cli.outputs.recording import read_recording
from mpap_cli.params import make_settings
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart

_KNOWN_NS = START_NS + round(KNOWN_AFTER_H * HOUR_NS)
_FEW_STEPS = 6


@dataclass(frozen=True, slots=True)
class Step:
    """What a model is to do next, how many messages that is, and the stamp of the last."""

    work: Callable[[], object]
    n: int
    until_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Hour:
    """What an hour took, and what there was at its end.

    ``cpu_us`` is the time for a message; ``known_us`` leaves out those of places that were
    still new to the robot. ``peak_mb`` is the most memory so far, ``kinds`` counts what the
    model is made of.
    """

    hour: int
    cpu_us: float
    known_us: float
    peak_mb: float
    kinds: dict[str, int]


class LongRun(Protocol):
    """A model, and a history that it learns from."""

    @property
    def model(self) -> CollisionModel | AppearanceModel:
        """The model."""

    def steps(self, hour: int) -> Iterator[Step]:
        """Yield what is to be learnt in an hour; to be asked for hour after hour."""

    def kinds(self) -> dict[str, int]:
        """Count what the model is made of."""


class ScanRun:
    """A collision model that learns from a recording.

    Parameters
    ----------
    path : Path
        As :func:`benchmarks.long_histories.histories.write_scans` wrote it.
    profile : str
        robust or paper.
    """

    def __init__(self, path: Path, profile: str) -> None:
        self.model = CollisionModel(make_settings(profile))
        self._logs = read_recording(path)

    def steps(self, hour: int) -> Iterator[Step]:
        """Yield the blocks of scans of an hour."""
        log = self._logs[hour]
        after_ns = log.start_ns - 1
        for block in log.blocks():
            until_ns = int(block.stamps_ns[-1])
            bumps = bumps_of(log.presses or (), after_ns, until_ns)
            batch = Batch(until_ns, (block,), bumps)
            yield Step(partial(self.model.observe, batch), len(block.stamps_ns), until_ns)
            after_ns = until_ns

    def kinds(self) -> dict[str, int]:
        """Count the meta-points."""
        points = self.model.meta_points
        n_cluster_points = int(points.is_cluster_point.sum())
        return {
            "cluster-points": n_cluster_points,
            "noise-points": points.n_points - n_cluster_points,
            "dropped": points.n_dropped,
        }


class ImageRun:
    """An appearance model that learns from ways through what was seen.

    Parameters
    ----------
    path : Path
        As :func:`benchmarks.long_histories.patch_histories.draw_views` wrote it.
    profile : str
        robust or paper.
    """

    def __init__(self, path: Path, profile: str) -> None:
        self.model = AppearanceModel(make_settings(profile))
        self._history = PatchHistory(path)

    def steps(self, hour: int) -> Iterator[Step]:
        """Yield the ways of an hour."""
        for way in self._history.hour(hour):
            stamps_ns = way.patches.stamps_ns
            until_ns = int(stamps_ns[-1])

            yield Step(partial(self._learn, way, until_ns), len(stamps_ns), until_ns)

    def _learn(self, way: Way, until_ns: int) -> None:
        self.model.learn(way.patches)
        self.model.settle(way.bumps, way.poses, until_ns)

    def kinds(self) -> dict[str, int]:
        """Count exemplars and outliers."""
        two_scale = self.model.two_scale
        return {
            "exemplars": two_scale.n_clusters,
            "reservoir": two_scale.n_reservoir,
            "outliers ever": two_scale.n_outliers_ever,
            "rebuilds": two_scale.n_rebuilds,
        }


def warm_up(run: LongRun) -> None:
    """Learn a little, so that all kernels are loaded; not to be learnt on."""
    run.model.begin_log(_start(0))
    for step in islice(run.steps(0), _FEW_STEPS):
        step.work()
    run.model.end_log(START_NS + HOUR_NS - 1)
    run.model.state()


def _start(hour: int) -> LogStart:
    start_ns = START_NS + hour * HOUR_NS
    return LogStart(name=f"hour-{hour:03d}", start_ns=start_ns, bump_kind="level")


def learn_hours(run: LongRun, hours: int) -> Iterator[Hour]:
    """Learn hour after hour, each as a log of its own."""
    for hour in range(hours):
        run.model.begin_log(_start(hour))
        whole, known = _Meter(), _Meter()
        for step in run.steps(hour):
            before_s = time.process_time()
            step.work()
            spent_s = time.process_time() - before_s
            whole.add(spent_s, step.n)
            if step.until_ns > _KNOWN_NS:
                known.add(spent_s, step.n)
        run.model.end_log(START_NS + (hour + 1) * HOUR_NS - 1)
        yield Hour(
            hour=hour + 1,
            cpu_us=whole.mean_us,
            known_us=known.mean_us,
            peak_mb=peak_mb(),
            kinds=run.kinds(),
        )


def peak_mb() -> float:
    """Return the most memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@dataclass(slots=True)
class _Meter:
    """CPU time of some messages."""

    spent_s: float = 0.0
    n: int = 0

    def add(self, spent_s: float, n: int) -> None:
        self.spent_s += spent_s
        self.n += n

    @property
    def mean_us(self) -> float:
        return 1e6 * self.spent_s / self.n
