"""Images cut into 9 to 144 patches: what is told apart, and what is decided (section 4.2.2)."""

from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.learn import LearnRequest, learn
from mpap_cli.commands.predict import predict
from mpap_cli.commands.predicting.images import PredictedImages
from mpap_cli.commands.predicting.request import PredictRequest
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.camera_logs import (
    INDOOR,
    OUTDOOR,
    Drive,
    Place,
    draw,
    repeats,
    settings_of,
)
from mpap_cli.commands.reproducing.stopping_runs import percent
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.evaluation.patch_files import read_seen_patches, read_true_patches
from mpap_cli.evaluation.patch_grids import regrid
from mpap_cli.evaluation.patch_truth import pair_patches, score_patches
from mpap_cli.simulation.camera_truth import GRID

ITEMS = ("patches",)
GRIDS = ((3, 3), (3, 6), (6, 6), (6, 12), (12, 12))
"""Rows and columns; each side divides that of the truth or is a multiple of it."""

MINUTES = (4.0, 2.0)
_NOTE = "AUC of p(obstacle) on the 36 cells of the truth, whatever the grid"


@dataclass(frozen=True, slots=True)
class Ground:
    """A place: a log to learn from, and another run there to be tested on."""

    learnt: Path
    tested: Path


def run(bench: Bench) -> None:
    """Deliver the claim that 9 to 144 patches work equally well.

    Notes
    -----
    The decision needs the same share of free rows whatever the grid.
    """
    grounds = [
        _ground(bench, place, seed) for seed in repeats(bench) for place in (INDOOR, OUTDOOR)
    ]
    means: list[float] = []
    for rows, columns in GRIDS:
        aucs: list[float | None] = []
        announced: list[float | None] = []
        exemplars: list[int] = []
        for ground in grounds:
            images, auc, n_exemplars = _try(bench, ground, (rows, columns))
            aucs.append(auc)
            announced.append(percent(images.contacts_foreseen, images.contacts))
            exemplars.append(n_exemplars)
        row = f"{rows * columns} ({rows}x{columns})"
        found = bench.number("patches", row, "AUC", aucs, note=_NOTE)
        bench.number("patches", row, "contacts announced (%)", announced)
        bench.number("patches", row, "exemplars", exemplars)
        means += [] if found.mean is None else [found.mean]
        bench.tell(f"{rows * columns} patches an image")
    if means:
        bench.finding(
            "patches",
            f'Nine to 144 patches an image "worked equally well" in the paper; here the AUC of '
            f"p(obstacle) is between {min(means):.3f} and {max(means):.3f}.",
        )


def _ground(bench: Bench, place: Place, seed: int) -> Ground:
    """Simulate both logs of a place."""
    learnt, tested = (
        draw(bench, Drive(place=place, world_seed=seed, run=run, minutes=minutes), f"log-{run}")
        for run, minutes in enumerate(MINUTES)
    )
    return Ground(learnt, tested)


def _try(
    bench: Bench, ground: Ground, shape: tuple[int, int]
) -> tuple[PredictedImages, float | None, int]:
    """Learn and predict with one grid; return what was predicted, its AUC, and exemplars."""
    out = bench.scratch / "grid"
    learnt = learn(_images(ground.learnt), _settings(bench, shape), _into(out))
    predicted = predict(_images(ground.tested), PredictRequest(out=out, model=out, jobs=1))
    if predicted.images is None or learnt.images is None:
        msg = "nothing was learnt of images"
        raise RuntimeError(msg)
    seen = regrid(read_seen_patches(out / "predict" / "patches.csv", 0), shape, GRID)
    truth = read_true_patches(ground.tested.with_name(f"{ground.tested.name}.patches.csv"))
    auc = score_patches([pair_patches(seen, truth)]).auc
    return predicted.images, auc, learnt.images.n_exemplars


def _images(log: Path) -> LogSelection:
    return LogSelection(logs=(str(log),), sensor="image")


def _into(out: Path) -> LearnRequest:
    return LearnRequest(out=out, keep_recording=False, jobs=1)


def _settings(bench: Bench, shape: tuple[int, int]) -> SettingsRequest:
    """Return the grid, and as many free rows as are as deep as those of 6 x 6."""
    rows, columns = shape
    deep, aside = (round(share * rows / 6) for share in (4, 2))
    pairs = (f"grid={rows}x{columns}", f"front-rows={deep}", f"side-rows={aside}")
    return settings_of(bench, "robust", pairs)
