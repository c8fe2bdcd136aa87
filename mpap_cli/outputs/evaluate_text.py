"""What ``mpap evaluate`` prints: scores with protocol, truth, sample and baselines."""

import math
from dataclasses import dataclass

from mpap_cli.outputs.text_table import aligned

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


@dataclass(frozen=True, slots=True)
class Auc:
    """Area under a ROC curve with its 95 % interval; None where there is none."""

    auc: float | None = None
    low: float | None = None
    high: float | None = None


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


@dataclass(frozen=True, slots=True)
class Comparison:
    """Another method on the same scans: its name and held-out area."""

    method: str
    held_out: Auc


@dataclass(frozen=True, slots=True, kw_only=True)
class Announced:
    """Presses that were predicted when they began, at ``p >= threshold``."""

    threshold: float
    announced: int
    presses: int
    median_lead_s: float | None
    false_alarms_per_minute: float | None


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
    announced: Announced | None = None
    notes: tuple[str, ...] = ()


def count(number: int, word: str) -> str:
    """Return a number with its noun.

    >>> count(1, "press"), count(9640, "scan")
    ('1 press', '9,640 scans')
    """
    plural = word + ("es" if word.endswith(("s", "ch")) else "s")
    return f"{number:,} {word if number == 1 else plural}"


def short_score(score: float | None) -> str:
    """Return a score without its leading zero, as the paper's tables are quoted.

    >>> short_score(0.904), short_score(1.0), short_score(None)
    ('.90', '1.00', '-')
    """
    if score is None or math.isnan(score):
        return "-"
    return f"{score:.2f}".removeprefix("0")


def _score(score: float | None) -> str:
    return "-" if score is None or math.isnan(score) else f"{score:.2f}"


def _interval(held_out: Auc) -> str:
    """Return the interval in brackets, nothing where there is none."""
    low, high = short_score(held_out.low), short_score(held_out.high)
    return "" if "-" in {low, high} else f"[{low},{high}]"


def evaluate_text(summary: EvaluateSummary) -> str:
    """Lay out the print-out of ``mpap evaluate``.

    Parameters
    ----------
    summary : EvaluateSummary
        The results in numbers.

    Returns
    -------
    str
        Lines, each with its end: what was scored, the table, what it is compared with, the
        protocol, how presses were announced, and the notes.
    """
    lines = [
        _heading(summary),
        *_table(summary.rows),
        _comparison(summary.comparisons),
        _protocol(summary),
        _announcement(summary.announced),
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
        _score(row.held_out.auc),
        _interval(row.held_out) or "-",
        _score(row.in_sample),
        paper,
        "-" if row.clusters is None else str(row.clusters),
        "-" if row.meta_points is None else str(row.meta_points),
    )


def _comparison(comparisons: tuple[Comparison, ...]) -> str:
    """Say how other methods did on the same scans."""
    parts = []
    for other in comparisons:
        words = (other.method, _score(other.held_out.auc), _interval(other.held_out))
        parts.append(" ".join(word for word in words if word))
    return f"for comparison: {'; '.join(parts)}" if parts else ""


def _protocol(summary: EvaluateSummary) -> str:
    """Say how the scores came about."""
    detail = f" ({summary.protocol_detail})" if summary.protocol_detail else ""
    words = _PROTOCOL_WORDS.get(summary.protocol)
    sentences = [] if words is None else [f"{words}{detail}."]
    if summary.protocol == "in-sample" or any(row.in_sample is not None for row in summary.rows):
        sentences.append(_IN_SAMPLE)
    return " ".join(sentences)


def _announcement(announced: Announced | None) -> str:
    """Say how many presses were predicted, how early, and at what price."""
    if announced is None:
        return ""
    parts = [f"{announced.announced} of {count(announced.presses, 'press')} announced"]
    if announced.median_lead_s is not None:
        parts.append(f"median lead {announced.median_lead_s:.1f} s")
    if announced.false_alarms_per_minute is not None:
        parts.append(f"{announced.false_alarms_per_minute:.1f} false alarms a minute")
    return f"at p >= {announced.threshold:g}: {', '.join(parts)}"
