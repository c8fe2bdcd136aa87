"""Marks of one method: the row of auc.csv and the curve behind it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.areas import Areas, Resampling, measure_areas
from mpap_cli.evaluation.calibration import Calibration, calibration
from mpap_cli.evaluation.operating import OperatingPoint, operating_points
from mpap_cli.evaluation.reasons import why_empty
from mpap_cli.evaluation.roc import (
    Curve,
    Scored,
    area_under_curve,
    average_precision,
    roc_curve,
)
from mpap_cli.evaluation.rows import AucRow, RocRow
from mpap_cli.evaluation.sheets import Sheet, has_both_labels
from mpap_cli.observations import BoolArray, Float64Array, Int8Array
from mpap_cli.params import EvaluationParams


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Marks:
    """Marks of one method; ``reason`` says in words why the area is empty, else "".

    ``curve`` and ``calibration`` are of the held-out scores, None without any; ``visible``
    are the areas without the presses before which nothing near was seen; ``points`` are
    thresholds and what they announce.
    """

    row: AucRow
    curve: Curve | None
    calibration: Calibration | None
    reason: str
    areas: Areas
    visible: Areas
    points: tuple[OperatingPoint, ...]

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
    found = _found(asked, sheet, held_out)
    in_sample_area = None if asked.circular else _in_sample_area(asked, sheet, in_sample)
    return Marks(
        row=_row(name, asked, sheet, found, in_sample_area),
        curve=roc_curve(found.scored) if found.has_area else None,
        calibration=found.calibrated,
        reason=""
        if found.has_area
        else why_empty(sheet, asked.target, found.scored, circular=asked.circular),
        areas=found.areas,
        visible=found.visible,
        points=operating_points(sheet.announcing, held_out.p),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Found:
    """What the held-out scores of one method gave; ``counted`` is the truth of its scans."""

    scored: Scored
    counted: Int8Array
    areas: Areas
    visible: Areas
    calibrated: Calibration | None

    @property
    def has_area(self) -> bool:
        return self.areas.pooled is not None


def _found(asked: Asked, sheet: Sheet, held_out: Outcome) -> _Found:
    """Score what was held out."""
    chosen = scored_scans(sheet, asked.pair) & ~np.isnan(held_out.score)
    with_p = chosen & ~np.isnan(held_out.p)
    areas = _areas(asked, sheet, held_out, chosen)
    seen = chosen & (sheet.truth_visible >= 0)
    return _Found(
        scored=_scored(sheet, held_out, chosen),
        counted=sheet.truth[chosen if chosen.any() else sheet.truth >= 0],
        areas=areas,
        visible=areas if seen.sum() == chosen.sum() else _areas(asked, sheet, held_out, seen),
        calibrated=calibration(held_out.p[with_p], sheet.truth[with_p] == 1),
    )


def _row(
    name: Name, asked: Asked, sheet: Sheet, found: _Found, in_sample_area: float | None
) -> AucRow:
    """Lay out the row of auc.csv."""
    calibrated = found.calibrated
    low, high = found.areas.pooled_interval()
    log_low, log_high = found.areas.per_log_interval()
    visible_low, visible_high = found.visible.pooled_interval()
    visible_log_low, visible_log_high = found.visible.per_log_interval()
    return AucRow(
        method=name.method,
        feature=name.feature,
        bins=name.bins,
        profile=name.profile,
        readout=name.readout,
        target=asked.target,
        protocol=sheet.protocol,
        truth=asked.truth,
        auc=found.areas.pooled,
        auc_low=low,
        auc_high=high,
        auc_per_log=found.areas.per_log,
        folds_scored=found.scored.two_class_folds().size if found.has_area else 0,
        auc_in_sample=in_sample_area,
        average_precision=average_precision(found.scored) if found.has_area else None,
        brier=calibrated.brier if calibrated else None,
        brier_skill=calibrated.brier_skill if calibrated else None,
        ece=calibrated.ece if calibrated else None,
        positives=int(np.sum(found.counted == 1)),
        negatives=int(np.sum(found.counted == 0)),
        presses=sheet.n_presses,
        logs=asked.n_logs,
        clusters=name.clusters,
        meta_points=name.meta_points,
        auc_per_log_low=log_low,
        auc_per_log_high=log_high,
        visible_presses=sheet.n_visible,
        auc_visible=found.visible.pooled,
        auc_visible_low=visible_low,
        auc_visible_high=visible_high,
        auc_visible_per_log=found.visible.per_log,
        auc_visible_per_log_low=visible_log_low,
        auc_visible_per_log_high=visible_log_high,
        calibration_slope=calibrated.slope if calibrated else None,
        calibration_intercept=calibrated.intercept if calibrated else None,
    )


def _areas(asked: Asked, sheet: Sheet, outcome: Outcome, chosen: BoolArray) -> Areas:
    """Measure the areas over the chosen scans (n,); none where they would be circular."""
    kept = np.zeros_like(chosen) if asked.circular else chosen
    unit = None if sheet.unit is None else sheet.unit[kept]
    params = asked.params
    how = Resampling(asked.n_logs, sheet.n_units, params.resamples, asked.seed)
    return measure_areas(_scored(sheet, outcome, kept), sheet.rows.log_index[kept], unit, how)


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
