"""Three environments explored from nothing: novelty, exemplars, members (section 5.3.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mpap_cli.commands.learning.patch_images import draw_patches
from mpap_cli.commands.novelty import Novelty, NoveltyRequest, novelty
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.camera_logs import (
    PLACES,
    Drive,
    Environment,
    draw,
    named_places,
    note_inputs,
    repeats,
    settings_of,
)
from mpap_cli.evaluation.novelty import NoveltyRow
from mpap_cli.logs.reader import expand_paths
from mpap_cli.outputs.novelty_curves import courses_of
from mpap_cli.outputs.novelty_panels import NoveltyPanel, plot_novelty_panels
from mpap_cli.outputs.picture_sheets import join_pictures
from mpap_cli.systems.appearance import AppearanceModel

MINUTES = 15.0
ITEMS = ("figure-13", "figure-14", "figure-15")
_STEP_S = 10.0
_LAST_MIN = 5.0
_HALF = 50.0
_PROFILES = ("robust", "paper")
_QUANTITIES = (
    "novel in the first minute (%)",
    "novel in the last five minutes (%)",
    "minutes above 50 %",
)


@dataclass(frozen=True, slots=True, eq=False)
class Explored:
    """One environment, and what was new in it to a model that began with nothing."""

    environment: Environment
    met: Novelty

    @property
    def model(self) -> AppearanceModel:
        """What was learnt there."""
        model = self.met.models.appearance
        if model is None:
            msg = "nothing was learnt of images"
            raise RuntimeError(msg)
        return model


def run(bench: Bench) -> None:
    """Deliver figures 13 to 15.

    Notes
    -----
    Profile paper is run with the first seed only: its reservoir of 2,000 outliers makes it
    several times as slow.
    """
    explored = [_explore(bench, seed, "robust") for seed in _seeds(bench)]
    bench.tell("environments explored")
    papers: list[Explored] = []
    if bench.wants("figure-13"):
        papers = [_visit(bench, one.environment, "paper") for one in explored[0]]
        bench.tell("environments explored with profile paper")
        _write_numbers(bench, explored, papers)
        _draw_novelty(bench, explored[0], papers)
    _draw_clusters(bench, explored[0])


class Progress(NamedTuple):
    """How novelty went down: percent in the first and the last minutes, minutes of a majority."""

    first: float
    last: float
    majority_min: float


def progress_of(rows: Sequence[NoveltyRow]) -> Progress:
    """Sum up the windows of the logs of one environment, on one clock.

    Parameters
    ----------
    rows : sequence of NoveltyRow
        At least one.

    Returns
    -------
    Progress
        Novelty of the first window and the mean over the windows that begin in the last
        five minutes, in percent; minutes until a window begins in which no more than half
        of the observations were novel.
    """
    courses = courses_of(rows)
    start, end, novel = (
        np.concatenate([getattr(course, name) for course in courses])
        for name in ("start", "end", "novel")
    )
    late = start >= max(end[-1] - _LAST_MIN, start[0])
    below = start[novel <= _HALF]
    until = below[0] if below.size else end[-1]
    return Progress(float(novel[0]), float(novel[late].mean()), float(until - start[0]))


def _is_simulated(bench: Bench) -> bool:
    return not (bench.request.novelty or named_places(bench))


def _seeds(bench: Bench) -> range:
    """Return the seeds of the simulated worlds; more than one only for numbers."""
    repeated = _is_simulated(bench) and bench.wants("figure-13")
    return repeats(bench) if repeated else repeats(bench)[:1]


def _environments(bench: Bench, seed: int) -> list[Environment]:
    """Return the environments: logs of the novelty experiment, other named ones, or simulated."""
    if not _is_simulated(bench):
        logs = [str(path) for path in expand_paths(bench.request.novelty)]
        named = [Environment(Path(log).name, (log,)) for log in logs] or named_places(bench)
        note_inputs(bench, named)
        return named
    places = (PLACES[0], PLACES[-1]) if bench.short else PLACES
    return [
        Environment(place.name, (str(draw(bench, drive, place.name)),))
        for place in places
        for drive in [Drive(place=place, world_seed=seed, run=0, minutes=MINUTES)]
    ]


def _explore(bench: Bench, seed: int, profile: str) -> list[Explored]:
    return [_visit(bench, one, profile) for one in _environments(bench, seed)]


def _visit(bench: Bench, environment: Environment, profile: str) -> Explored:
    """Meet one environment with an empty model."""
    met = novelty(
        environment.selection,
        settings_of(bench, profile),
        NoveltyRequest(out=bench.scratch / "met", step_s=_STEP_S, jobs=1),
    )
    bench.left_out(met.exit_code)
    return Explored(environment, met)


def _write_numbers(bench: Bench, explored: list[list[Explored]], papers: list[Explored]) -> None:
    """Write how new the beginning and the end were, for each environment and profile."""
    every: dict[str, list[Progress]] = {}
    for profile, runs in zip(_PROFILES, (explored, [papers]), strict=True):
        every[profile] = []
        for same_place in zip(*runs, strict=True):
            row = f"{same_place[0].environment.name}, profile {profile}"
            found = [progress_of(one.met.rows) for one in same_place]
            for quantity, ours in zip(_QUANTITIES, zip(*found, strict=True), strict=True):
                bench.number("figure-13", row, quantity, ours)
            exemplars = [one.model.two_scale.n_clusters for one in same_place]
            bench.number("figure-13", row, "exemplars", exemplars)
            every[profile] += found
    bench.finding("figure-13", _novelty_words(every["paper"], every["robust"]))


def _novelty_words(paper: list[Progress], robust: list[Progress]) -> str:
    """Say what became of the majority that the paper sees in the first minutes."""
    by_paper, by_robust = (list(zip(*found, strict=True)) for found in (paper, robust))
    return (
        f"Novel in the first minute were {_span(by_paper[0])} % under profile paper and "
        f"{_span(by_robust[0])} % under profile robust, in the last five minutes "
        f"{_span(by_paper[1])} % and {_span(by_robust[1])} %. The paper sees a majority of novel "
        f"observations during the first few minutes; here {_lasting(by_paper[2])} under profile "
        f"paper and {_lasting(by_robust[2])} under profile robust, since outliers are explained as "
        "soon as the reservoir is full."
    )


def _lasting(minutes: Sequence[float]) -> str:
    """Say how long a majority was novel."""
    if not any(minutes):
        return "no window of 60 s has one"
    return f"it lasts {_span(minutes, 1)} minutes"


def _span(values: Sequence[float], digits: int = 0) -> str:
    """Return the least and the largest of some numbers as text."""
    low, high = (f"{value:.{digits}f}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def _draw_novelty(bench: Bench, explored: list[Explored], papers: list[Explored]) -> None:
    """Draw figure 13."""
    panels = [
        NoveltyPanel(
            one.environment.name,
            tuple(
                (f"profile {profile}", visit.met.rows)
                for profile, visit in zip(_PROFILES, (one, paper), strict=True)
            ),
        )
        for one, paper in zip(explored, papers, strict=True)
    ]
    caption = (
        "Share of the observations in windows of 60 s that were novel to a model which began "
        "with nothing and learnt on, environment by environment."
    )
    plot_novelty_panels(bench.picture("figure-13", caption), panels)


def _draw_clusters(bench: Bench, explored: list[Explored]) -> None:
    """Draw figures 14 and 15: clusters of the first environment and of the last."""
    if not bench.wants("figure-14", "figure-15"):
        return
    shown = [explored[0], explored[-1]] if len(explored) > 1 else explored
    exemplars: list[tuple[str, Path]] = []
    members: list[tuple[str, Path]] = []
    for number, one in enumerate(shown):
        one.model.finish()
        for kind, drawn in (("exemplars", exemplars), ("members", members)):
            drawn.append((one.environment.name, bench.scratch / f"{kind}-{number}.png"))
        draw_patches([exemplars[-1][1], members[-1][1]], one.model, one.environment.selection)
    if bench.wants("figure-14"):
        caption = "Exemplars of the clusters in two environments, the likeliest obstacles first."
        join_pictures(bench.picture("figure-14", caption), exemplars, beside=True)
    if bench.wants("figure-15"):
        caption = "Each row shows members of one cluster beside its exemplar, in two environments."
        join_pictures(bench.picture("figure-15", caption), members, beside=False)
