"""The ranges of the two parameters that section 3.4 calls good."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_logs import PLACES, scenes
from mpap_cli.commands.reproducing.synthetic import META_POINT
from mpap_cli.commands.reproducing.texture_sets import texture_sets
from mpap_cli.evaluation.clusterers.methods import CLUSTERERS, warm_up
from mpap_cli.evaluation.clusterers.records import PATCH_SETTINGS, LabelledPoints
from mpap_cli.evaluation.clusterers.scores import score_clustering
from mpap_cli.evaluation.gaussians import MARGIN, N_NOISE, WIDTH, plane_gaussians
from mpap_cli.evaluation.paper_tables import MIN_POINTS_RANGE, THETA_SHARES
from mpap_cli.evaluation.reproduced import ITEMS
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.params import MetaPointParams

_MPAP = ("mpap", "default")
_FEATURE, _BINS = "global-diff", 6
_REPEATS = 3
_PLANE, _PATCHES = "plane", "patches"
# beside the ends of the paper's ranges, one value between them and one on either side
_MIN_POINTS = (2, MIN_POINTS_RANGE[0], 7, MIN_POINTS_RANGE[1], 20)
_SHARES = (0.02, THETA_SHARES[0], 0.1, THETA_SHARES[1], 0.25)
_NOTES = {
    "min-points": "The other parameter is as usual: theta 0.7 deviations, 0.13 and 0.10.",
    "theta": (
        "The space of histograms is 1 wide (equation 7), that of the plane as wide as the area "
        "its points lie in. The other parameter is as usual, min-points 5."
    ),
}


class _Choice(NamedTuple):
    """One value of a parameter: its name, whether the paper calls it good, what it means."""

    name: str
    good: bool
    plane: MetaPointParams
    patches: MetaPointParams
    scans: dict[str, object]


Measured = dict[tuple[str, str], list[float | None]]
"""Repeats of one measure by its name and the name of a choice."""


def run(bench: Bench) -> None:
    """Deliver the sweeps over min-points and theta."""
    choices = {"min-points": _min_points(), "theta": _thetas()}
    wanted = {item: of_item for item, of_item in choices.items() if bench.wants(item)}
    warm_up()
    point_sets = _point_sets(bench)
    for item, of_item in wanted.items():
        measured: Measured = defaultdict(list)
        _measure_points(point_sets, of_item, measured)
        _measure_scans(bench, of_item, measured)
        for (quantity, name), values in measured.items():
            bench.number(item, name, quantity, values, note=_NOTES[item])
        _compare(bench, item, of_item, measured)
        bench.tell(f"{ITEMS[item].title} tried")


def _min_points() -> list[_Choice]:
    """Return the values of min-points."""
    low, high = MIN_POINTS_RANGE
    patches = PATCH_SETTINGS.meta_point
    return [
        _Choice(
            name=str(n),
            good=low <= n <= high,
            plane=replace(META_POINT, min_points=n),
            patches=replace(patches, min_points=n),
            scans={"min_points": n},
        )
        for n in _MIN_POINTS
    ]


def _thetas() -> list[_Choice]:
    """Return the values of theta, as shares of the feature space."""
    low, high = THETA_SHARES
    width = WIDTH + 2 * MARGIN
    patches = PATCH_SETTINGS.meta_point
    return [
        _Choice(
            name=f"{100 * share:g} %",
            good=low <= share <= high,
            plane=replace(META_POINT, theta=share * width),
            patches=replace(patches, theta=share),
            scans={"theta": share},
        )
        for share in _SHARES
    ]


def _point_sets(bench: Bench) -> dict[str, list[LabelledPoints]]:
    """Return some sets of points in the plane, with noise, and of image patches."""
    return {
        _PLANE: [plane_gaussians(seed, N_NOISE) for seed in bench.seeds[:_REPEATS]],
        _PATCHES: [one.shuffled() for one in texture_sets(bench, _REPEATS)],
    }


def _measure_points(
    point_sets: dict[str, list[LabelledPoints]], choices: Sequence[_Choice], measured: Measured
) -> None:
    """Cluster all sets of points under each choice."""
    for kind, sets in point_sets.items():
        for choice in choices:
            params = choice.plane if kind == _PLANE else choice.patches
            settings = replace(PATCH_SETTINGS, meta_point=params, theta_from_points=False)
            for points in sets:
                result = CLUSTERERS[_MPAP].run(points, settings, 0)
                row = score_clustering(*_MPAP, 0, points, result)
                measured[f"V-measure, {kind}", choice.name].append(row.v_measure)
                measured[f"clusters, {kind}", choice.name].append(float(row.clusters))


def _measure_scans(bench: Bench, choices: Sequence[_Choice], measured: Measured) -> None:
    """Score the collision model under each choice, held out."""
    variants = [
        Variant(
            choice.name,
            bench.settings("paper", feature=_FEATURE, bins=_BINS, resamples=10, **choice.scans),
        )
        for choice in choices
    ]
    for place in PLACES:
        for scene in scenes(bench, place, variants[0].settings, _REPEATS):
            question = scene.question("blocked" if len(scene.logs) == 1 else None)
            marks = evaluate_all(question, variants, baselines=False).marks
            for choice, one in zip(choices, marks, strict=True):
                measured[f"held-out AUC, {place}", choice.name].append(one.row.auc)
                measured[f"in-sample AUC, {place}", choice.name].append(one.row.auc_in_sample)


def _compare(bench: Bench, item: str, choices: Sequence[_Choice], measured: Measured) -> None:
    """Say whether the best value lies in the paper's range."""
    inside: list[str] = []
    outside: list[str] = []
    for quantity in dict.fromkeys(key[0] for key in measured if not key[0].startswith("clusters")):
        means = {
            choice.name: float(np.mean(known))
            for choice in choices
            if (known := [value for value in measured[quantity, choice.name] if value is not None])
        }
        if means:
            best = max(means, key=lambda name: means[name])
            good = next(choice.good for choice in choices if choice.name == best)
            words = f"{quantity} ({means[best]:.2f} at {best})"
            (inside if good else outside).append(words)
    claim = "The best of the values tried lies in the range that the paper calls good"
    bench.finding(
        item,
        f"{claim} for {'; '.join(inside) or 'nothing'}"
        + (f", outside of it for {'; '.join(outside)}." if outside else "."),
    )
