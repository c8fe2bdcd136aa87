"""What ``evaluate`` prints, gathered from an evaluation."""

from collections.abc import Sequence

from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.paper_tables import TABLE_4
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.evaluation.scoring import Evaluation, Variant
from mpap_cli.outputs.evaluate_text import (
    Announced,
    Auc,
    Comparison,
    EvaluateSummary,
    MethodRow,
    count,
)

SPOKEN = {
    "nearest-range": "nearest range ahead",
    "nearest-range-1s": "nearest range of the last second",
}


def summarise(
    evaluation: Evaluation,
    variants: Sequence[Variant],
    request: SettingsRequest,
    *,
    given: bool,
) -> EvaluateSummary:
    """Gather the print-out.

    Parameters
    ----------
    evaluation : Evaluation
        What was found.
    variants : sequence of Variant
        What was scored, as ``evaluation.marks`` begins.
    request : SettingsRequest
        How the settings were asked for.
    given : bool
        Whether logs were given, not taken from what was learnt last.

    Returns
    -------
    EvaluateSummary
        Numbers and words, not laid out.
    """
    ours, others = evaluation.marks[: len(variants)], evaluation.marks[len(variants) :]
    first = ours[0].row
    feature = request.feature or str(first.feature)
    same = [one for one in ours if one.row.profile == first.profile]
    bins = tuple(dict.fromkeys(one.row.bins for one in same if one.row.bins is not None))
    return EvaluateSummary(
        feature=feature,
        bins=bins,
        profile=str(first.profile),
        reason=_profile_reason(request, given=given),
        logs=first.logs,
        scans=evaluation.timeline.sheet.rows.n_scans,
        positives=int((evaluation.timeline.sheet.truth == 1).sum()),
        presses=first.presses,
        truth=first.truth,
        rows=tuple(_method_row(one.row) for one in same),
        target=first.target,
        comparisons=(
            *(
                Comparison(f"{one.row.method} ({one.row.profile})", _auc(one.row))
                for one in ours
                if one not in same
            ),
            *(_comparison(one) for one in others),
        ),
        protocol=evaluation.protocol,
        protocol_detail=_protocol_detail(evaluation, variants[0]),
        announced=_announced(evaluation),
        notes=_notes(evaluation),
    )


def _profile_reason(request: SettingsRequest, *, given: bool) -> str:
    """Say why this profile."""
    if request.feature is not None:
        return "because --feature was given"
    if request.bins is not None:
        return "because --bins was given"
    if request.profile is not None:
        return "as asked"
    return "as learnt" if request.says_nothing and not given else "the default"


def _method_row(row: AucRow) -> MethodRow:
    """Return one line of the table."""
    paper = None
    if row.profile == "paper" and row.feature is not None and row.bins is not None:
        paper = TABLE_4.get((row.feature, row.bins))
    name = f"{row.method} {row.feature}/{row.bins}" if row.method == "mpap" else row.method
    return MethodRow(
        method=name,
        profile=str(row.profile),
        held_out=_auc(row),
        in_sample=row.auc if row.protocol == "in-sample" else row.auc_in_sample,
        paper=paper,
        clusters=row.clusters,
        meta_points=row.meta_points,
    )


def _auc(row: AucRow) -> Auc:
    """Return the held-out area; there is none in-sample."""
    if row.protocol == "in-sample":
        return Auc()
    return Auc(row.auc, row.auc_low, row.auc_high)


def _comparison(marks: Marks) -> Comparison:
    """Return what a baseline reached."""
    name = SPOKEN.get(marks.row.method, marks.row.method)
    return Comparison(name, Auc(marks.row.auc, marks.row.auc_low, marks.row.auc_high))


def _protocol_detail(evaluation: Evaluation, variant: Variant) -> str:
    """Say what stands behind the name of the protocol."""
    folds = evaluation.timeline.sheet.folds.plan.n_folds
    words = [evaluation.protocol, count(folds, "fold")]
    if evaluation.protocol == "blocked":
        words.append(f"{variant.settings.evaluation.guard_s:g} s guard")
    return ", ".join(words)


def _announced(evaluation: Evaluation) -> Announced | None:
    """Return how the presses were announced, if any was judged."""
    summary = evaluation.timeline.summary
    if summary.judged == 0:
        return None
    return Announced(
        threshold=evaluation.timeline.threshold,
        announced=summary.announced,
        presses=summary.judged,
        median_lead_s=summary.median_lead_s,
        false_alarms_per_minute=summary.false_alarms_per_min,
    )


def _notes(evaluation: Evaluation) -> tuple[str, ...]:
    """Say why a number is missing."""
    notes = []
    if evaluation.reason:
        notes.append(f"held-out AUC empty: {evaluation.reason}")
    elif evaluation.interval_kind == "none":
        notes.append("no interval: fewer than five logs or stretches with presses to resample")
    return tuple(notes)
