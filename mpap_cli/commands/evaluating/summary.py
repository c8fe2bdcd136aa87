"""What ``evaluate`` prints, gathered from an evaluation."""

from collections.abc import Sequence

import numpy as np

from mpap_cli.commands.evaluating.scores import (
    alarmed,
    announced,
    best_below,
    per_log,
    probabilities,
    spoken,
    visible_scores,
)
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.evaluation.paper_tables import TABLE_4
from mpap_cli.evaluation.protocols import FoldPlan
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.evaluation.scoring import Evaluation, Variant
from mpap_cli.evaluation.sheets import Question
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.evaluate_text import EvaluateSummary, MethodRow
from mpap_cli.outputs.score_lines import Auc, Comparison
from mpap_cli.outputs.text_table import count


def summarize(
    evaluation: Evaluation,
    question: Question,
    variants: Sequence[Variant],
    request: SettingsRequest,
    *,
    learnt: bool,
) -> EvaluateSummary:
    """Gather the print-out.

    Parameters
    ----------
    evaluation : Evaluation
        What was found.
    question : Question
        What was asked.
    variants : sequence of Variant
        What was scored, as ``evaluation.marks`` begins.
    request : SettingsRequest
        How the settings were asked for.
    learnt : bool
        Whether there are learnt settings that the request is laid over.

    Returns
    -------
    EvaluateSummary
        Numbers and words, not laid out.
    """
    ours, others = evaluation.marks[: len(variants)], evaluation.marks[len(variants) :]
    seen = _logs_seen(question)
    held_out = evaluation.protocol != "in-sample" and not seen
    first = ours[0].row
    feature = request.feature or str(first.feature)
    same = [one for one in ours if one.row.profile == first.profile]
    alone = len(same) == 1
    bins = tuple(dict.fromkeys(one.row.bins for one in same if one.row.bins is not None))
    return EvaluateSummary(
        feature=feature,
        bins=bins,
        profile=str(first.profile),
        reason=_profile_reason(request, question, learnt=learnt),
        logs=first.logs,
        scans=evaluation.timeline.sheet.rows.n_scans,
        positives=int((evaluation.timeline.sheet.truth == 1).sum()),
        presses=first.presses,
        truth=first.truth,
        rows=tuple(_method_row(one.row, held_out=held_out) for one in same),
        target=first.target,
        comparisons=tuple(
            _comparison(one.row, held_out=held_out) for one in (*ours, *others) if one not in same
        ),
        protocol=evaluation.protocol,
        protocol_detail=_protocol_detail(evaluation),
        per_log=per_log(evaluation) if alone else None,
        visible=visible_scores(evaluation) if alone else None,
        alarmed=alarmed(evaluation),
        announced=announced(evaluation),
        best=best_below(evaluation.marks[0]) if alone else None,
        probabilities=probabilities(first) if alone else None,
        notes=(*_notes(evaluation), *seen),
    )


def _profile_reason(request: SettingsRequest, question: Question, *, learnt: bool) -> str:
    """Say why this profile."""
    if question.model is not None:
        return "that of the model"
    if request.feature is not None:
        return "because --feature was given"
    if request.bins is not None:
        return "because --bins was given"
    if request.profile is not None:
        return "as asked"
    return "as learnt" if learnt else "the default"


def _logs_seen(question: Question) -> tuple[str, ...]:
    """Say which of the logs a given model has learnt from, if any."""
    if question.model is None:
        return ()
    learnt = {(log.name, log.start_ns) for log in question.model.logs}
    seen = [log.name for log in question.logs if (log.name, log.start_ns) in learnt]
    if not seen:
        return ()
    return (f"in-sample, not held-out: the model has learnt from {', '.join(seen)}",)


def _method_row(row: AucRow, *, held_out: bool) -> MethodRow:
    """Return one line of the table; the paper's figures are those of contact, in-sample."""
    paper = None
    compares = row.profile == "paper" and row.target == "contact" and row.protocol != "given-model"
    if compares and row.feature is not None and row.bins is not None:
        paper = TABLE_4.get((row.feature, row.bins))
    name = f"{row.method} {row.feature}/{row.bins}" if row.method == "mpap" else row.method
    return MethodRow(
        method=name,
        profile=str(row.profile),
        held_out=_area(row) if held_out else Auc(),
        in_sample=row.auc_in_sample if held_out else row.auc,
        paper=paper,
        clusters=row.clusters,
        meta_points=row.meta_points,
    )


def _area(row: AucRow) -> Auc:
    """Return the area with its interval."""
    return Auc(row.auc, row.auc_low, row.auc_high)


def _comparison(row: AucRow, *, held_out: bool) -> Comparison:
    """Return what another method reached, marked where it has seen what it scores."""
    return Comparison(spoken(row) if held_out else f"{spoken(row)}, in-sample", _area(row))


def _protocol_detail(evaluation: Evaluation) -> str:
    """Say what stands behind the name of the protocol."""
    folds = evaluation.timeline.sheet.folds.plan.n_folds
    words = [evaluation.protocol, count(folds, "fold")]
    if evaluation.protocol == "blocked":
        words.append(_guard(evaluation.timeline.sheet.folds.plan))
    return ", ".join(words)


def _guard(plan: FoldPlan) -> str:
    """Return what is left out beside the blocks, which short ones make shorter."""
    guards_s = (plan.guard_ns if plan.guard_ns is not None else np.zeros(1)) / NS_PER_S
    low, high = (f"{value:.1f}".removesuffix(".0") for value in (guards_s.min(), guards_s.max()))
    return f"{high} s guard" if low == high else f"{low} to {high} s guard"


def _notes(evaluation: Evaluation) -> tuple[str, ...]:
    """Say why a number is missing."""
    notes = []
    if evaluation.reason:
        notes.append(f"held-out AUC empty: {evaluation.reason}")
    elif evaluation.interval_kind == "none":
        notes.append("no interval: fewer than five logs or stretches with presses to resample")
    return tuple(notes)
