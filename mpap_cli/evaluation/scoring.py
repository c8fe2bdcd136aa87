"""Evaluation: models trained by a protocol, scored, with the baselines beside them.

The order of the paper: train on what the bumper tells, predict, compare (section 5.2).
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.baselines import ReadOut
from mpap_cli.evaluation.comparisons import Sheets, score_baselines
from mpap_cli.evaluation.differences import difference_rows
from mpap_cli.evaluation.marks import Asked, Marks, Name, Outcome, mark
from mpap_cli.evaluation.observing import Look, ScanRows, observe, raw_look
from mpap_cli.evaluation.predictions import (
    learn_all,
    predict_all,
    predict_held_out,
    predict_prequential,
)
from mpap_cli.evaluation.rows import DifferenceRow
from mpap_cli.evaluation.sheets import Question, Sheet, make_sheet
from mpap_cli.evaluation.timelines import Timeline, make_timeline
from mpap_cli.evaluation.visible import visible_presses
from mpap_cli.observations import Prediction
from mpap_cli.params import Settings
from mpap_cli.properties.labels import EARLY
from mpap_cli.systems.cluster_rows import pair_of
from mpap_cli.systems.collision import CollisionModel

SCAN = "scan"

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Variant:
    """Settings to be scored, and the method's name in the tables."""

    method: str
    settings: Settings


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """What an evaluation found.

    ``marks`` are those of the variants, then of the baselines; ``differences`` compare the
    first with each of the others. ``timeline`` is of the
    first variant. ``models`` were trained on all scans, one for each variant (or are the
    given one); their clusters are the rows of clusters.csv. ``interval_kind`` is what was
    resampled: logs, segments or none; ``reason`` says why the first area is empty, or "".
    """

    marks: tuple[Marks, ...]
    differences: tuple[DifferenceRow, ...]
    timeline: Timeline
    models: tuple[CollisionModel, ...]
    protocol: str
    protocol_reason: str
    interval_kind: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class _Scored:
    """One variant: its marks, what was predicted, and the model of all scans."""

    marks: Marks
    sheet: Sheet
    prediction: Prediction
    model: CollisionModel
    settings: Settings


def evaluate_all(
    question: Question, variants: Sequence[Variant], *, baselines: bool = True
) -> Evaluation:
    """Score settings on the same logs, and the baselines beside them.

    Parameters
    ----------
    question : Question
        Logs, target, protocol, truth; or a model that is scored as it is.
    variants : sequence of Variant
        At least one; the baselines take labels, features and kernel of the first.
    baselines : bool
        Whether to fit them.

    Returns
    -------
    Evaluation
        Marks in the order of the variants, then of ``BASELINES``.

    Raises
    ------
    UsageError
        If the protocol does not exist, or lacks its groups.
    """
    _check_warning_time(question)
    question = _seen(question, variants[0].settings)
    settings = [question.target.applied_to(variant.settings) for variant in variants]
    looks = [Look(chosen.scan) for chosen in settings]
    raw = raw_look(settings[0].scan)
    rows = observe(question.logs, dict.fromkeys([*looks, raw] if baselines else looks))
    found = [
        _score_variant(question, variant.method, chosen, rows[look])
        for variant, chosen, look in zip(variants, settings, looks, strict=True)
    ]
    first = found[0]
    marks = [one.marks for one in found]
    if baselines:
        marks += _score_baselines(question, first, rows[raw])
    if question.model is None:
        _log.info("protocol %s: %s", first.sheet.protocol, first.sheet.protocol_reason)
    return Evaluation(
        marks=tuple(marks),
        differences=tuple(difference_rows(marks)),
        timeline=make_timeline(question, first.sheet, first.prediction, first.settings),
        models=tuple(one.model for one in found),
        protocol=first.sheet.protocol,
        protocol_reason=first.sheet.protocol_reason,
        interval_kind=first.sheet.unit_kind,
        reason=first.marks.reason,
    )


def _seen(question: Question, settings: Settings) -> Question:
    """Find out which of the presses that are scored were visible."""
    presses = question.scored_presses()
    visible = visible_presses(question.logs, presses, settings.scan, settings.evaluation)
    return replace(question, visible=visible)


def _score_variant(question: Question, method: str, settings: Settings, rows: ScanRows) -> _Scored:
    """Train and score one variant."""
    sheet = make_sheet(question, settings, rows)
    target = question.target.name
    model = question.model or learn_all(sheet, question.logs, settings)
    of_all = predict_all(sheet, model, target)
    if sheet.protocol in {"in-sample", "given-model"}:
        held_out = of_all
    elif sheet.protocol == "prequential":
        held_out = predict_prequential(sheet, question.logs, settings, target)
    else:
        held_out = predict_held_out(sheet, settings, target)
    in_sample = Outcome.nothing(rows.n_scans) if question.model else _outcome(of_all)
    name = Name(
        method=method,
        feature=settings.scan.feature,
        bins=settings.scan.bins,
        profile=settings.profile,
        readout=settings.properties.readout,
        clusters=model.clustering.exemplars.size,
        meta_points=model.meta_points.n_points,
    )
    marks = mark(name, _asked(question, settings), sheet, (_outcome(held_out), in_sample))
    shown = held_out if sheet.folds.plan.n_folds else of_all
    # clusters.csv lists those of the model of all scans
    shown = replace(shown, cluster=of_all.cluster)
    return _Scored(marks, sheet, shown, model, settings)


def _score_baselines(question: Question, first: _Scored, raw: ScanRows) -> list[Marks]:
    """Fit and mark the baselines beside the first variant."""
    settings = first.settings
    sheets = Sheets(first.sheet, make_sheet(question, settings, raw))
    learnt = None
    if question.model_logs is not None:
        looks = Look(settings.scan), raw_look(settings.scan)
        known = observe(question.model_logs, looks)
        past = replace(question, logs=question.model_logs, groups=None, truth=None, visible=None)
        learnt = Sheets(*(make_sheet(past, settings, known[look]) for look in looks))
    read_out = ReadOut(
        theta=settings.meta_point.theta,
        neighbors=settings.properties.kernel_k,
        prior_counts=settings.properties.prior_counts,
        n_centers=first.marks.row.meta_points or 1,
        seed=settings.affinity.seed,
    )
    asked = _asked(question, settings)
    return list(score_baselines(sheets, learnt, settings, asked, read_out))


def _asked(question: Question, settings: Settings) -> Asked:
    """Gather what all methods of one variant share."""
    target = question.target
    from_scan = SCAN in question.truth_name.split("+")
    early = target.name == "early"
    return Asked(
        target=target.text(settings),
        truth=f"{question.truth_name} (circular)" if from_scan and early else question.truth_name,
        pair=pair_of(settings, target.name),
        n_logs=len(question.logs),
        circular=from_scan and not early,
        params=settings.evaluation,
        seed=settings.affinity.seed,
    )


def _check_warning_time(question: Question) -> None:
    """Refuse a warning time that a given model did not count."""
    model, asked_s = question.model, question.target.early_s
    if model is None or asked_s is None or pair_of(model.settings, "early") != EARLY:
        return
    counted_s = model.settings.properties.early_s
    if asked_s != counted_s:
        msg = (
            f"--target early:{asked_s:g}: the model counted early:{counted_s:g}; "
            "leave out --model, so that it is trained for that"
        )
        raise UsageError(msg)


def _outcome(prediction: Prediction) -> Outcome:
    """Score by the probability."""
    return Outcome(prediction.p_collision, prediction.p_collision)
