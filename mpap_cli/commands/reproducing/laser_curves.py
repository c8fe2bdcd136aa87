"""ROC curves of every feature, averaged over the worlds of a place (figure 10)."""

from collections.abc import Mapping, Sequence

import numpy as np

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_marks import BINS, Key, PlaceMarks
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.reproduced import spread
from mpap_cli.evaluation.roc import Curve
from mpap_cli.observations import Float64Array
from mpap_cli.outputs.plots import RocLine, plot_roc
from mpap_cli.params import PAPER_FEATURES

GRID: Float64Array = np.linspace(0.0, 1.0, 201)
"""False positive rates at which the curves of several worlds are averaged."""


def mean_curve(curves: Sequence[Curve]) -> Float64Array:
    """Return the mean true positive rate at each rate of ``GRID``, after a first 0.

    Examples
    --------
    >>> steps = np.array([np.inf, 0.5, 0.1]), np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 1.0])
    >>> mean_curve([Curve(*steps)])[:2].tolist()
    [0.0, 1.0]
    """
    at_grid = [_heights(one) for one in curves]
    return np.concatenate(([0.0], np.mean(at_grid, axis=0)))


def _heights(curve: Curve) -> Float64Array:
    """Return the highest true positive rate at each rate of the grid."""
    last = np.append(np.diff(curve.fpr) > 0, True)
    fpr, tpr = curve.fpr[last], curve.tpr[last]
    return np.asarray(np.interp(GRID, fpr, tpr), dtype=np.float64)


def height_at(marks: Sequence[Marks], fpr: float) -> float | None:
    """Return the mean true positive rate at a false positive rate, None without a curve."""
    curves = [one.curve for one in marks if one.curve is not None]
    return float(np.interp(fpr, GRID, mean_curve(curves)[1:])) if curves else None


def draw_curves(bench: Bench, marks: Mapping[str, PlaceMarks]) -> None:
    """Draw figure 10 in-sample, as the paper seems to have it, and held out."""
    caption = (
        "ROC curves of the five features, in-sample as in the paper: the mean of the repeats at "
        "each false positive rate."
    )
    held_out = "The same held out: each scan scored by a model that has not seen its press."
    for path, title, in_sample in (
        (bench.picture("figure-10", caption), "in-sample", True),
        (bench.picture("figure-10", held_out, "held-out"), "held out", False),
    ):
        lines = [
            line
            for place, found in marks.items()
            for bins in BINS
            for line in _lines(place, found, bins, in_sample=in_sample)
        ]
        plot_roc(path, lines, f"target contact, {title}")


def _lines(place: str, found: PlaceMarks, bins: int, *, in_sample: bool) -> list[RocLine]:
    """Return the curves of one panel."""
    lines = []
    for feature in PAPER_FEATURES:
        marks = marks_of(found, (feature, bins), in_sample=in_sample)
        curves = [one.curve for one in marks if one.curve is not None]
        if curves:
            area = spread([one.row.auc for one in marks]).mean
            fpr = np.concatenate(([0.0], GRID))
            panel = f"{place}, {bins} bins"
            lines.append(RocLine(feature, panel, fpr, mean_curve(curves), area))
    return lines


def marks_of(found: PlaceMarks, key: Key, *, in_sample: bool) -> list[Marks]:
    """Return the marks of one setting, scene by scene."""
    return [(one.in_sample if in_sample else one.held_out)[key] for one in found.scenes]
