"""What ``mpap evaluate`` prints: scores with protocol, truth, sample and baselines."""

from dataclasses import dataclass

from mpap_cli.outputs.score_lines import (
    Auc,
    Comparison,
    PerLog,
    Probabilities,
    VisibleScores,
    comparison_line,
    interval_text,
    per_log_line,
    probability_line,
    score_text,
    short_score,
    visible_line,
)
from mpap_cli.outputs.text_table import aligned, count

_POSITIVE_WORDS = {
    "contact": "in contact",
    "onset": "at the onset of a press",
    "early": "shortly before a press",
}
_PROTOCOL_WORDS = {
    "blocked": "held-out: every press scored by a model that never saw it",
    "leave-one-log-out": "held-out: every log scored by a model that never saw it",
    "leave-one-group-out": "held-out: every group of logs scored by a model that never saw it",
    "prequential": "held-out: every scan scored before the model learnt it",
    "given-model": "given model: scores of that one model",
}
_IN_SAMPLE = "in-sample: same scans learnt and scored; only this compares with the paper."


@dataclass(frozen=True, slots=True, kw_only=True)
class MethodRow:
    """One line of the table. ``paper`` is (indoor, outdoor) of table 4, if it is there."""

    method: str
    profile: str
    held_out: Auc
    in_sample: float | None
    paper: tuple[float, float] | None = None
    clusters: int | None = None
    meta_points: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Announced:
    """Presses that were predicted when they began, at ``p >= threshold``.

    ``visible`` of the presses were seen beforehand, ``visible_announced`` of these were
    announced; ``alarm_share`` is the alarmed share of the time outside contact.
    """

    threshold: float
    announced: int
    presses: int
    median_lead_s: float | None
    visible_announced: int
    visible: int
    visible_median_lead_s: float | None
    false_alarms_per_minute: float | None
    alarm_share: float | None = None


@dataclass(frozen=True, slots=True)
class BestBelow:
    """What could be announced at fewer false alarms a minute; None: at no threshold.

    ``alarm_share`` is how much of the time outside contact may be alarmed.
    """

    false_alarms_per_minute: float
    alarm_share: float
    announced: Announced | None


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluateSummary:
    """All that the print-out of ``mpap evaluate`` needs.

    ``reason`` says why this profile; ``positives`` counts the scans that ``target`` calls
    positive; ``protocol_detail`` is what stands in brackets (``blocked, 5 folds, 5 s
    guard``); each of ``notes`` is a line of its own.
    """

    feature: str
    bins: tuple[int, ...]
    profile: str
    reason: str
    logs: int
    scans: int
    positives: int
    presses: int
    truth: str
    rows: tuple[MethodRow, ...]
    target: str = "contact"
    comparisons: tuple[Comparison, ...] = ()
    protocol: str = "blocked"
    protocol_detail: str = ""
    per_log: PerLog | None = None
    visible: VisibleScores | None = None
    alarmed: Announced | None = None
    announced: Announced | None = None
    best: BestBelow | None = None
    probabilities: Probabilities | None = None
    notes: tuple[str, ...] = ()


def evaluate_text(summary: EvaluateSummary) -> str:
    """Lay out the print-out of ``mpap evaluate``.

    Parameters
    ----------
    summary : EvaluateSummary
        The results in numbers.

    Returns
    -------
    str
        Lines, each with its end: what was scored, the table, what it is compared with, log
        by log and without what nobody saw, the protocol, how presses were announced, what
        probabilities are worth, and the notes.
    """
    lines = [
        _heading(summary),
        *_table(summary.rows),
        comparison_line(summary.comparisons),
        per_log_line(summary.per_log),
        visible_line(summary.visible),
        _protocol(summary),
        _alarms(summary.alarmed),
        _announcement(summary.announced),
        _best(summary.best),
        probability_line(summary.probabilities),
        *summary.notes,
    ]
    return "".join(f"{line}\n" for line in lines if line)


def _heading(summary: EvaluateSummary) -> str:
    """Say what was scored, on what."""
    bins = " and ".join(str(n) for n in summary.bins)
    name = "all features" if summary.feature == "all" else summary.feature
    target = summary.target.partition(":")[0]
    parts = (
        count(summary.logs, "log"),
        count(summary.scans, "scan"),
        f"{summary.positives:,} {_POSITIVE_WORDS[target]}",
        count(summary.presses, "press"),
    )
    ending = "" if target == "contact" else f"; target: {summary.target}"
    return (
        f"{name}, {bins} bin{'' if summary.bins == (1,) else 's'}, "
        f"profile {summary.profile} ({summary.reason}). "
        f"{', '.join(parts)}; truth: {summary.truth}{ending}"
    )


def _table(rows: tuple[MethodRow, ...]) -> list[str]:
    """Lay out the table of methods."""
    header = (
        "method",
        "profile",
        "held-out AUC",
        "[95 %]",
        "in-sample AUC",
        "paper's Table 4",
        "clusters",
        "meta-points",
    )
    return aligned([header, *(_cells(row) for row in rows)])


def _cells(row: MethodRow) -> tuple[str, ...]:
    """Return the cells of one method."""
    paper = "-"
    if row.paper is not None:
        paper = f"{short_score(row.paper[0])} in / {short_score(row.paper[1])} out"
    return (
        row.method,
        row.profile,
        score_text(row.held_out.auc),
        interval_text(row.held_out) or "-",
        score_text(row.in_sample),
        paper,
        "-" if row.clusters is None else str(row.clusters),
        "-" if row.meta_points is None else str(row.meta_points),
    )


def _protocol(summary: EvaluateSummary) -> str:
    """Say how the scores came about."""
    detail = f" ({summary.protocol_detail})" if summary.protocol_detail else ""
    words = _PROTOCOL_WORDS.get(summary.protocol)
    sentences = [] if words is None else [f"{words}{detail}."]
    if summary.protocol == "in-sample" or any(row.in_sample is not None for row in summary.rows):
        sentences.append(_IN_SAMPLE)
    return " ".join(sentences)


def _alarms(alarmed: Announced | None) -> str:
    """Say what the alarms announced, and how much of the time they last."""
    if alarmed is None:
        return ""
    share = alarmed.alarm_share
    text = f"alarms: {_announced(alarmed)}"
    return text if share is None else f"{text}, alarmed {100 * share:.0f} % of the time"


def _announcement(announced: Announced | None) -> str:
    """Say how many presses were predicted, how early, and at what price."""
    if announced is None:
        return ""
    return f"at p >= {announced.threshold:g}: {_announced(announced)}"


def _announced(found: Announced) -> str:
    """Say it without the threshold."""
    parts = [f"{found.announced} of {count(found.presses, 'press')} announced"]
    if found.median_lead_s is not None:
        parts.append(f"median lead {found.median_lead_s:.1f} s")
    if found.visible_median_lead_s is not None and found.visible < found.presses:
        lead = f"median lead {found.visible_median_lead_s:.1f} s"
        parts.append(f"of {found.visible} visible ones {found.visible_announced}, {lead}")
    if found.false_alarms_per_minute is not None:
        parts.append(f"{found.false_alarms_per_minute:.1f} false alarms a minute")
    return ", ".join(parts)


def _best(best: BestBelow | None) -> str:
    """Say what the best threshold would be, had one known these scores."""
    if best is None:
        return ""
    number = best.false_alarms_per_minute
    alarms = f"{number:g} false alarm{'' if number == 1 else 's'} a minute"
    limit = f"fewer than {alarms}, alarmed less than {100 * best.alarm_share:g} % of the time"
    if best.announced is None:
        return f"no threshold announces a press with {limit}"
    at = f"at p >= {best.announced.threshold:.3g}"
    return f"{at}: {_announced(best.announced)} (the best on these scores with {limit})"
