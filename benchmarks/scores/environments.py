"""The environments of section 5.3 on simulated worlds.

``python benchmarks/scores/environments.py``:
for each seed, and with the two sets of textures exchanged: worlds A and B, the return to A,
and A in other light with other camera settings. Printed is what was unknown at the start of
each log, how well obstacles are told in a run through A that was not learnt, and what the
robot would have decided: before which presses it would have stopped or turned, and before
which of the contacts that truly met its front, pressed or not.

``--minutes M`` (6), ``--seeds 0,1,2``, ``--set KEY=VALUE`` for the settings of learning.
"""

import argparse
import csv
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, Source, open_sources
from mpap_cli.commands.learn import LearnRequest, learn
from mpap_cli.commands.novelty import NoveltyRequest, novelty
from mpap_cli.commands.predict import predict
from mpap_cli.commands.predicting.images import PredictedImages
from mpap_cli.commands.predicting.request import PredictRequest
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.commands.simulate import simulate
from mpap_cli.evaluation.driving import drives_ahead
from mpap_cli.evaluation.patch_files import (
    read_free_ahead,
    read_seen_patches,
    read_true_patches,
)
from mpap_cli.evaluation.patch_truth import pair_patches, score_free_way, score_patches
from mpap_cli.evaluation.stopping import announced_contacts
from mpap_cli.observations import NS_PER_S, Int8Array, IntArray, PoseBlock, Press
from mpap_cli.params import make_settings
from mpap_cli.systems.decision import ACTIONS

SWAPS = (("a", "b"), ("b", "a"))
RUNS = ("A", "held", "B", "A2", "A-light")
COLUMNS = (
    "seed textures  unknown: B  return  light | auc  p floor  p obst.  unknown  straight  "
    "foreseen  in front  stop A  stop B"
)
FRONT_DEG = 45


@dataclass(frozen=True, slots=True)
class Case:
    """One seed with one pair of texture sets."""

    seed: int
    here: str
    there: str

    def run(self, name: str) -> dict[str, Any]:
        """Return how one of ``RUNS`` differs."""
        world = 2 * self.seed
        camera = {"textures": self.there if name == "B" else self.here}
        if name == "A-light":
            camera["light"] = "evening"
        return {
            "camera": camera,
            "seed": 100 * self.seed + RUNS.index(name),
            "world_seed": world + 1 if name == "B" else world,
        }


def play(case: Case, folder: Path, minutes: float, settings: SettingsRequest) -> str:
    """Simulate, learn, predict one case; return its line."""
    logs = {}
    for name in RUNS:
        logs[name] = folder / f"{name}-{case.seed}{case.here}.mcap"
        if not logs[name].exists():
            simulate(logs[name], duration_s=60 * minutes, **case.run(name))
    out = folder / f"out-{case.seed}{case.here}"
    chain = LogSelection(logs=tuple(str(logs[name]) for name in ("A", "B", "A2")), sensor="image")
    met = novelty(chain, settings, NoveltyRequest(out=out))
    learn(_image(logs["A"]), settings, LearnRequest(out=out))
    light = novelty(_image(logs["A-light"]), SettingsRequest(), NoveltyRequest(out=out, model=out))
    there, here = (
        predict(_image(logs[name]), PredictRequest(out=out, model=out)).images
        for name in ("B", "held")
    )
    foreseen = "-" if here is None else f"{here.contacts_foreseen}/{here.contacts}"
    decided = _read_decisions(out / "predict" / "decisions.csv")
    seen = read_seen_patches(out / "predict" / "patches.csv", 0)
    truth = read_true_patches(_beside(logs["held"], "patches"))
    scores = score_patches([pair_patches(seen, truth)])
    way = score_free_way(*decided, *read_free_ahead(_beside(logs["held"], "images")))
    front = _in_front(logs["held"], decided)
    unknown = [boundary.percent_unknown_at_start for boundary in met.boundaries]
    return (
        f"{case.seed:4} {case.here} then {case.there}  {unknown[1]:9.1f}  {unknown[2]:6.1f}  "
        f"{light.boundaries[0].percent_unknown_at_start:5.1f} | {scores.auc:.3f}  "
        f"{scores.mean_p_floor:7.2f}  {scores.mean_p_obstacle:7.2f}  "
        f"{100 * scores.unknown_share:7.1f}  {way.straight_share or 0:8.2f}  "
        f"{foreseen:>8}  {front:>8}  {_stops(here)}  {_stops(there)}"
    )


def _image(log: Path) -> LogSelection:
    return LogSelection(logs=(str(log),), sensor="image")


def _beside(log: Path, what: str) -> Path:
    """Return the table of truth of a log."""
    return log.with_name(f"{log.name}.{what}.csv")


def _read_decisions(path: Path) -> tuple[IntArray, Int8Array]:
    """Return stamps and decisions."""
    rows = _rows(path)
    stamps_ns = np.array([int(row["stamp_ns"]) for row in rows])
    return stamps_ns, np.array([ACTIONS.index(row["action"]) for row in rows], dtype=np.int8)


def _in_front(log: Path, decided: tuple[IntArray, Int8Array]) -> str:
    """Say before how many of the contacts with the front of the robot it would have stopped."""
    (source,) = open_sources(_image(log), make_settings(), Losses())
    blocks = [batch.poses for batch in source.batches() if batch.poses is not None]
    stamps_ns = np.concatenate([block.stamps_ns for block in blocks])
    path = PoseBlock(stamps_ns, np.concatenate([block.poses for block in blocks]))
    contacts = [
        Press(_moment(source, row["start_s"]), _moment(source, row["end_s"]))
        for row in _rows(_beside(log, "truth"))
        if abs(float(row["bearing_deg"])) <= FRONT_DEG
    ]
    leads = announced_contacts(*decided, contacts, drives_ahead(decided[0], path))
    judged = [lead.predicted for lead in leads if lead.predicted is not None]
    return f"{sum(judged)}/{len(judged)}"


def _moment(source: Source, seconds: str) -> int:
    """Return the stamp of a moment of the truth, which counts from the first message."""
    return source.start.start_ns + round(float(seconds) * NS_PER_S)


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _stops(images: PredictedImages | None) -> str:
    """Say the stopping distance with mean, spread and number."""
    if images is None or images.stopping.mean_m is None:
        return "-"
    stopping = images.stopping
    return f"{stopping.mean_m:.2f}+-{stopping.sd_m or 0:.2f} ({stopping.measured})"


def main() -> None:
    """Play all cases and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=6.0)
    parser.add_argument("--seeds", default="0,1,2")
    parser.add_argument("--set", dest="pairs", action="append", default=[])
    parser.add_argument("--folder", type=Path, help="where logs are kept and found again")
    words = parser.parse_args()
    settings = SettingsRequest(pairs=tuple(words.pairs))
    print(COLUMNS, flush=True)
    with tempfile.TemporaryDirectory(prefix="mpap-environments-") as scratch:
        folder = words.folder or Path(scratch)
        folder.mkdir(exist_ok=True)
        for here, there in SWAPS:
            for seed in words.seeds.split(","):
                case = Case(int(seed), here, there)
                print(play(case, folder, words.minutes, settings), flush=True)


if __name__ == "__main__":
    main()
