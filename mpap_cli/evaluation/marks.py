"""Marks of one method: the row of auc.csv and the curve behind it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.calibration import Calibration, calibration
from mpap_cli.evaluation.intervals import area_interval
from mpap_cli.evaluation.roc import (
    Curve,
    Scored,
    area_per_log,
    area_under_curve,
    average_precision,
    roc_curve,
)
from mpap_cli.evaluation.rows import AucRow, RocRow
from mpap_cli.evaluation.sheets import Sheet, has_both_labels
from mpap_cli.observations import BoolArray, Float64Array
from mpap_cli.params import EvaluationParams

CIRCULAR = "the presses were made from the scan itself: scoring them by the scan is circular"


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """Scores and probabilities, both (n,), of n scans; NaN where no model spoke."""

    score: Float64Array
    p: Float64Array

    @classmethod
    def nothing(cls, n_scans: int) -> "Outcome":
        """Say nothing of any scan."""
        return cls(np.full(n_scans, np.nan), np.full(n_scans, np.nan))


@dataclass(frozen=True, slots=True, kw_only=True)
class Name:
    """Which method under which settings; None where a column has no meaning for it."""

    method: str
    feature: str | None = None
    bins: int | None = None
    profile: str | None = None
    readout: str | None = None
    clusters: int | None = None
    meta_points: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What methods share: words for the tables, learnt pair of labels, resampling.

    A fold whose training scans lack one of the labels of ``pair`` is not scored.
    ``circular``: the truth was made from the scan, so it says nothing of a model of scans.
    """

    target: str
    truth: str
    pair: int
    n_logs: int
    circular: bool
    params: EvaluationParams
    seed: int


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """Marks of one method; ``reason`` says in words why the area is empty, else "".

    ``curve`` and ``calibration`` are of the held-out scores, None without any.
    """

    row: AucRow
    curve: Curve | None
    calibration: Calibration | None
    reason: str

    def roc_rows(self) -> Iterator[RocRow]:
        """Yield the corners of the curve as rows of roc.csv."""
        if self.curve is None:
            return
        row = self.row
        corners = (self.curve.threshold, self.curve.fpr, self.curve.tpr)
        for threshold, fpr, tpr in zip(*(corner.tolist() for corner in corners), strict=True):
            yield RocRow(
                method=row.method,
                feature=row.feature,
                bins=row.bins,
                profile=row.profile,
                target=row.target,
                protocol=row.protocol,
                threshold=None if np.isnan(threshold) else threshold,
                fpr=fpr,
                tpr=tpr,
            )


def mark(name: Name, asked: Asked, sheet: Sheet, outcomes: tuple[Outcome, Outcome]) -> Marks:
    """Mark one method.

    Parameters
    ----------
    name : Name
        The method.
    asked : Asked
        What all methods share.
    sheet : Sheet
        n scans with truth and folds.
    outcomes : tuple of Outcome
        What it says of these scans held out, and in-sample.

    Returns
    -------
    Marks
        The area is empty where no fold holds both classes, never one half.
    """
    held_out, in_sample = outcomes
    chosen = scored_scans(sheet, asked.pair) & ~np.isnan(held_out.score)
    scored = _scored(sheet, held_out, chosen)
    with_p = chosen & ~np.isnan(held_out.p)
    calibrated = calibration(held_out.p[with_p], sheet.truth[with_p] == 1)
    areas = _NO_AREAS if asked.circular else _areas(asked, sheet, scored, chosen)
    counted = sheet.truth[chosen if chosen.any() else sheet.truth >= 0]
    row = AucRow(
        method=name.method,
        feature=name.feature,
        bins=name.bins,
        profile=name.profile,
        readout=name.readout,
        target=asked.target,
        protocol=sheet.protocol,
        truth=asked.truth,
        auc=areas.auc,
        auc_low=areas.low,
        auc_high=areas.high,
        auc_per_log=areas.per_log,
        folds_scored=areas.folds,
        auc_in_sample=None if asked.circular else _in_sample_area(asked, sheet, in_sample),
        average_precision=areas.precision,
        brier=calibrated.brier if calibrated else None,
        brier_skill=calibrated.brier_skill if calibrated else None,
        ece=calibrated.ece if calibrated else None,
        positives=int(np.sum(counted == 1)),
        negatives=int(np.sum(counted == 0)),
        presses=sheet.n_presses,
        logs=asked.n_logs,
        clusters=name.clusters,
        meta_points=name.meta_points,
    )
    reason = "" if areas.auc is not None else _reason(asked, sheet, scored)
    return Marks(row, areas.curve, calibrated, reason)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Areas:
    """What is made of the order of scores; empty without a fold of both classes."""

    auc: float | None = None
    low: float | None = None
    high: float | None = None
    per_log: float | None = None
    folds: int = 0
    precision: float | None = None
    curve: Curve | None = None


_NO_AREAS = _Areas()


def _areas(asked: Asked, sheet: Sheet, scored: Scored, chosen: BoolArray) -> _Areas:
    """Make everything that depends on the order of scores only."""
    unit = None if sheet.unit is None else sheet.unit[chosen]
    low, high = area_interval(scored, unit, asked.params.resamples, asked.seed) or (None, None)
    return _Areas(
        auc=area_under_curve(scored),
        low=low,
        high=high,
        per_log=area_per_log(scored, sheet.rows.log_index[chosen]),
        folds=scored.two_class_folds().size,
        precision=average_precision(scored),
        curve=roc_curve(scored),
    )


def scored_scans(sheet: Sheet, pair: int) -> BoolArray:
    """Mark the scans (n,) that have a truth and a fold with both classes to learn from."""
    chosen = sheet.truth >= 0
    if sheet.protocol == "given-model":
        return np.asarray(chosen, dtype=np.bool_)
    learnable = [sheet.learnable(fold, pair) for fold in range(sheet.folds.plan.n_folds)]
    if not learnable:
        return np.zeros(sheet.truth.size, dtype=np.bool_)
    return np.asarray(chosen & np.array(learnable)[sheet.folds.test], dtype=np.bool_)


def _scored(sheet: Sheet, outcome: Outcome, chosen: BoolArray) -> Scored:
    """Cut out what is scored."""
    return Scored(outcome.score[chosen], sheet.truth[chosen] == 1, sheet.folds.test[chosen])


def _in_sample_area(asked: Asked, sheet: Sheet, outcome: Outcome) -> float | None:
    """Return the area where the same scans are learnt and scored by one model."""
    if not has_both_labels(sheet.labels[:, asked.pair]):
        return None
    chosen = (sheet.truth >= 0) & ~np.isnan(outcome.score)
    one_model = np.zeros(int(chosen.sum()), dtype=np.int64)
    return area_under_curve(Scored(outcome.score[chosen], sheet.truth[chosen] == 1, one_model))


def _reason(asked: Asked, sheet: Sheet, scored: Scored) -> str:
    """Say in words why there is no area."""
    reasons = (
        (asked.circular, CIRCULAR),
        (sheet.rows.n_scans == 0, "no scan could be used"),
        (not (sheet.truth == 1).any(), f"no positive scan for target {asked.target}"),
        (not (sheet.truth == 0).any(), f"no negative scan for target {asked.target}"),
        (sheet.folds.plan.reason != "", sheet.folds.plan.reason),
        (scored.score.size == 0, "no fold has both classes to learn from"),
    )
    return next((words for holds, words in reasons if holds), "no fold has both classes to score")
