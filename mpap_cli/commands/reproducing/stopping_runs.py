"""Obstacles seen before they are touched: decisions, map, stopping distance (4.2.6, 5.3.3)."""

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.models import load_models
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.learn import LearnRequest, learn
from mpap_cli.commands.predict import predict
from mpap_cli.commands.predicting.images import PredictedImages
from mpap_cli.commands.predicting.request import PredictRequest
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.camera_logs import (
    INDOOR,
    OUTDOOR,
    PLACES,
    Drive,
    draw,
    named_places,
    note_inputs,
    repeats,
    settings_of,
)
from mpap_cli.commands.reproducing.decided_images import DecidedLog, draw_decided
from mpap_cli.evaluation.paper_tables import STOPPING_DISTANCE_M, STOPPING_SPREAD_M
from mpap_cli.evaluation.reproduced import Spread
from mpap_cli.logs.reader import open_log
from mpap_cli.observations import NS_PER_S

ITEMS = ("figure-6", "figure-12", "stopping-distance")
LEARN_MINUTES, TEST_MINUTES = 6.0, 5.0
_PAPER_NOTE = f"the paper's spread is {STOPPING_SPREAD_M} m"
_LEARNT, _OTHER, _PAPER = (
    "environment learnt",
    "another environment learnt",
    "environment learnt, profile paper",
)


@dataclass(frozen=True, slots=True)
class Ground:
    """An environment: logs to learn from, and a log to be tested on that is not learnt."""

    name: str
    learnt: LogSelection
    tested: LogSelection


@dataclass(slots=True)
class Judged:
    """What the decisions of one kind of test were like, test after test."""

    distances_m: list[float] = field(default_factory=list)
    announced: list[float | None] = field(default_factory=list)
    unknown: list[float | None] = field(default_factory=list)

    def add(self, images: PredictedImages) -> None:
        """Add one test."""
        distances = np.concatenate([one.distance_m for one in images.stops])
        self.distances_m += distances[~np.isnan(distances)].tolist()
        self.announced.append(percent(images.contacts_foreseen, images.contacts))
        self.unknown.append(percent(images.n_unknown, images.n_patches))


def percent(part: int, whole: int) -> float | None:
    """Return a share in percent, None of nothing.

    >>> percent(1, 4), percent(0, 0)
    (25.0, None)
    """
    return 100 * part / whole if whole else None


def run(bench: Bench) -> None:
    """Deliver figures 6 and 12, the stopping distance, and the count of discrepancies.

    Notes
    -----
    Profile paper is tested with the first seed only.
    """
    judged = {row: Judged() for row in (_LEARNT, _OTHER, _PAPER)}
    discrepancies: list[float] = []
    for number, seed in enumerate(_seeds(bench)):
        grounds = _grounds(bench, seed)
        for ground in grounds:
            model = _learn(bench, ground, "robust")
            appearance = load_models(model).appearance
            if appearance is not None:
                discrepancies.append(float(len(appearance.discrepancies())))
            for row, tested in _tests(bench, ground, grounds):
                judged[row].add(_predict(bench, model, tested))
            if number == 0 and bench.wants("stopping-distance"):
                by_paper = _learn(bench, ground, "paper")
                judged[_PAPER].add(_predict(bench, by_paper, ground))
        if number == 0:
            _draw(bench, grounds)
        bench.tell(f"decisions in {len(grounds)} environments, seed {seed}")
    _write_numbers(bench, judged, discrepancies)


def _seeds(bench: Bench) -> range:
    """Return the seeds of the worlds; further ones than the first only for the distance."""
    once = named_places(bench) or not bench.wants("stopping-distance")
    return repeats(bench)[:1] if once else repeats(bench)


def _grounds(bench: Bench, seed: int) -> list[Ground]:
    """Return the environments: those of the user, or simulated ones."""
    named = named_places(bench)
    if named:
        note_inputs(bench, named)
        return [_divided(one.name, one.logs) for one in named]
    places = (INDOOR, OUTDOOR) if bench.short else PLACES
    return [
        Ground(place.name, *(LogSelection(logs=(log,), sensor="image") for log in logs))
        for place in places
        for logs in [
            [
                str(
                    draw(bench, Drive(place=place, world_seed=seed, run=run, minutes=minutes), name)
                )
                for run, (name, minutes) in enumerate(
                    (("learnt", LEARN_MINUTES), (f"{place.name}-test", TEST_MINUTES))
                )
            ]
        ]
    ]


def _divided(name: str, logs: tuple[str, ...]) -> Ground:
    """Learn from all logs but the last, which is the test; a single log is halved."""
    if len(logs) > 1:
        first, last = (LogSelection(logs=part, sensor="image") for part in (logs[:-1], logs[-1:]))
        return Ground(name, first, last)
    with open_log(Path(logs[0])) as reader:
        half = f"{(reader.end_ns - reader.start_ns) / 2 / NS_PER_S}"
    return Ground(
        name,
        LogSelection(logs=logs, sensor="image", end=half),
        LogSelection(logs=logs, sensor="image", start=half),
    )


def _learn(bench: Bench, ground: Ground, profile: str) -> Path:
    """Learn one environment; return the results folder."""
    out = bench.scratch / f"model-{profile}-{ground.name}"
    request = LearnRequest(out=out, keep_recording=False, jobs=1)
    learnt = learn(ground.learnt, settings_of(bench, profile), request)
    bench.left_out(learnt.exit_code)
    return out


def _tests(bench: Bench, learnt: Ground, grounds: Sequence[Ground]) -> Iterator[tuple[str, Ground]]:
    """Yield what a model is tested on: its own environment, and for the distance the others."""
    yield _LEARNT, learnt
    if bench.wants("stopping-distance"):
        yield from ((_OTHER, ground) for ground in grounds if ground is not learnt)


def _predict(bench: Bench, model: Path, ground: Ground) -> PredictedImages:
    """Decide at every image of the test of an environment."""
    out = _folder(bench, model, ground)
    predicted = predict(ground.tested, PredictRequest(out=out, model=model, jobs=1))
    bench.left_out(predicted.exit_code)
    if predicted.images is None:
        msg = "a model of images predicted none"
        raise RuntimeError(msg)
    return predicted.images


def _folder(bench: Bench, model: Path, ground: Ground) -> Path:
    return bench.scratch / f"{model.name}-on-{ground.name}"


def _draw(bench: Bench, grounds: Sequence[Ground]) -> None:
    """Draw figures 6 and 12 from what was predicted of environments that were learnt."""
    folders = [
        _folder(bench, bench.scratch / f"model-robust-{ground.name}", ground) / "predict"
        for ground in grounds
    ]
    if bench.wants("figure-6"):
        caption = (
            "Images with predicted obstacles and the decision below each: for the first "
            "environment and the last, of each action the image in which obstacles and free "
            "patches are most balanced."
        )
        ends = sorted({0, len(grounds) - 1})
        logs = [DecidedLog(grounds[end].tested, folders[end]) for end in ends]
        draw_decided(bench.picture("figure-6", caption), logs)
    if bench.wants("figure-12") and (folders[0] / "map.png").exists():
        caption = (
            "Way of the robot by odometry, laser returns, and patches at the places they were "
            "seen from; framed vermilion where the model calls them obstacles, green where not."
        )
        shutil.copyfile(folders[0] / "map.png", bench.picture("figure-12", caption))


def _write_numbers(bench: Bench, judged: dict[str, Judged], discrepancies: Sequence[float]) -> None:
    """Write distances, contacts that were announced, and clusters with both labels."""
    item = "stopping-distance"
    distances, unknown = dict[str, Spread](), dict[str, Spread]()
    for row, one in judged.items():
        paper, note = (None, "") if row == _OTHER else (STOPPING_DISTANCE_M, _PAPER_NOTE)
        distances[row] = bench.number(
            item, row, "distance (m)", one.distances_m, paper=paper, note=note
        )
        bench.number(item, row, "contacts announced (%)", one.announced)
        unknown[row] = bench.number(item, row, "unknown patches (%)", one.unknown)
    bench.number(item, "discrepancies (section 4.2.4)", "clusters with both labels", discrepancies)
    words = (
        "Where the environment was learnt the robot would have stopped "
        f"{_said(distances[_LEARNT])} before what was ahead (paper: {STOPPING_DISTANCE_M} +- "
        f"{STOPPING_SPREAD_M} m, driven by its decisions; here they are judged along a log that "
        "was not)."
    )
    share = unknown[_OTHER].mean
    if share is not None:
        words += (
            f" With a model of another environment {share:.0f} % of the patches are unknown, hence "
            f"free: {_said(distances[_OTHER])}."
        )
    if distances[_LEARNT].n:
        bench.finding(item, words)


def _said(distances: Spread) -> str:
    """Say mean, spread and number of distances."""
    if distances.mean is None:
        return "it never stops"
    spread = "" if distances.sd is None else f" +- {distances.sd:.2f}"
    return f"{distances.mean:.2f}{spread} m (n = {distances.n})"
