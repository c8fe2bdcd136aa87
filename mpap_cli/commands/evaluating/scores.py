"""Scores of the first method for the print-out: log by log, of visible presses, of alarms."""

from mpap_cli.evaluation.differences import SCORED
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.operating import (
    ALARM_SHARE,
    FALSE_ALARMS_PER_MIN,
    OperatingPoint,
    most_recall,
)
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.evaluation.scoring import Evaluation
from mpap_cli.outputs.evaluate_text import Announced, BestBelow
from mpap_cli.outputs.score_lines import Against, Auc, PerLog, Probabilities, VisibleScores

SPOKEN = {
    "nearest-range": "nearest range ahead",
    "nearest-range-1s": "nearest range of the last second",
}


def spoken(row: AucRow) -> str:
    """Return the name of a method that stands beside the first."""
    if row.profile is not None:
        return f"{row.method} ({row.profile})"
    return SPOKEN.get(row.method, row.method)


def per_log(evaluation: Evaluation) -> PerLog:
    """Return the mean over logs, and the differences from the other methods."""
    row = evaluation.marks[0].row
    mean = Auc(row.auc_per_log, row.auc_per_log_low, row.auc_per_log_high)
    return PerLog(mean, evaluation.marks[0].areas.n_logs, _against(evaluation, SCORED[0]))


def visible_scores(evaluation: Evaluation) -> VisibleScores | None:
    """Return the scores of the visible presses, None if all are or none is known of."""
    first = evaluation.marks[0]
    row = first.row
    if row.visible_presses == row.presses:
        return None
    mean = Auc(row.auc_visible_per_log, row.auc_visible_per_log_low, row.auc_visible_per_log_high)
    return VisibleScores(
        presses=row.visible_presses,
        pooled=Auc(row.auc_visible, row.auc_visible_low, row.auc_visible_high),
        per_log=PerLog(mean, first.visible.n_logs, _against(evaluation, SCORED[1])),
    )


def _against(evaluation: Evaluation, scored: str) -> tuple[Against, ...]:
    """Return the mean differences per log from the other methods."""
    rows = [row for row in evaluation.differences if row.scored == scored]
    return tuple(
        Against(
            spoken(other.row),
            Auc(row.diff_per_log, row.diff_per_log_low, row.diff_per_log_high),
            row.logs,
        )
        for other, row in zip(evaluation.marks[1:], rows, strict=True)
    )


def announced(evaluation: Evaluation) -> Announced | None:
    """Return how the presses were announced, if any was judged."""
    timeline = evaluation.timeline
    if timeline.summary.judged == 0:
        return None
    return announced_at(
        OperatingPoint(timeline.threshold, timeline.summary, timeline.visible_summary)
    )


def alarmed(evaluation: Evaluation) -> Announced | None:
    """Return what the alarms of profile robust announced, if any press was judged."""
    alarms = evaluation.timeline.alarms
    if alarms is None or alarms.point.every.judged == 0:
        return None
    return announced_at(alarms.point)


def announced_at(point: OperatingPoint) -> Announced:
    """Return what one threshold announces."""
    return Announced(
        threshold=point.threshold,
        announced=point.every.announced,
        presses=point.every.judged,
        median_lead_s=point.every.median_lead_s,
        visible_announced=point.visible.announced,
        visible=point.visible.judged,
        visible_median_lead_s=point.visible.median_lead_s,
        false_alarms_per_minute=point.every.false_alarms_per_min,
        alarm_share=point.every.alarm_share,
    )


def best_below(marks: Marks) -> BestBelow | None:
    """Return what could be announced with few false alarms, None without a judged press."""
    if not marks.points:
        return None
    best = most_recall(marks.points)
    if best is None or best.every.announced == 0:
        return BestBelow(FALSE_ALARMS_PER_MIN, ALARM_SHARE, None)
    return BestBelow(FALSE_ALARMS_PER_MIN, ALARM_SHARE, announced_at(best))


def probabilities(row: AucRow) -> Probabilities:
    """Return what the probabilities of one method are worth."""
    return Probabilities(row.brier_skill, row.calibration_slope, row.calibration_intercept)
