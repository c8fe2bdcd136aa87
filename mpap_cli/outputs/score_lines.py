"""Scores in words, for the print-out of ``mpap evaluate``: areas, differences, probabilities."""

import math
from dataclasses import dataclass

MIN_LOGS = 2


@dataclass(frozen=True, slots=True)
class Auc:
    """Area under a ROC curve with its 95 % interval; None where there is none."""

    auc: float | None = None
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Comparison:
    """Another method on the same scans: its name and held-out area."""

    method: str
    held_out: Auc


@dataclass(frozen=True, slots=True)
class Against:
    """How much better the first method is than another: mean difference over some logs."""

    method: str
    difference: Auc
    logs: int


@dataclass(frozen=True, slots=True)
class PerLog:
    """The mean of the areas of some logs, and the first method against the others."""

    mean: Auc
    logs: int
    against: tuple[Against, ...] = ()


@dataclass(frozen=True, slots=True)
class VisibleScores:
    """Scores without the presses before which nothing near was seen; ``presses`` remain."""

    presses: int
    pooled: Auc
    per_log: PerLog


@dataclass(frozen=True, slots=True)
class Probabilities:
    """Whether probabilities mean what they say; None where it cannot be told."""

    brier_skill: float | None
    slope: float | None
    intercept: float | None


def short_score(score: float | None) -> str:
    """Return a score without its leading zero, as the paper's tables are quoted.

    >>> short_score(0.904), short_score(1.0), short_score(-0.25), short_score(None)
    ('.90', '1.00', '-.25', '-')
    """
    if score is None or math.isnan(score):
        return "-"
    text = f"{score:.2f}"
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


def score_text(score: float | None) -> str:
    """Return a score with its leading zero, a dash where there is none."""
    return "-" if score is None or math.isnan(score) else f"{score:.2f}"


def interval_text(auc: Auc) -> str:
    """Return the interval in brackets, nothing where there is none.

    >>> interval_text(Auc(0.05, -0.01, 0.12)), interval_text(Auc(0.05))
    ('[-.01,.12]', '')
    """
    low, high = short_score(auc.low), short_score(auc.high)
    return "" if "-" in {low, high} else f"[{low},{high}]"


def auc_text(auc: Auc) -> str:
    """Return an area and its interval.

    >>> auc_text(Auc(0.86, 0.8, 0.9)), auc_text(Auc())
    ('0.86 [.80,.90]', '-')
    """
    return " ".join(word for word in (score_text(auc.auc), interval_text(auc)) if word)


def comparison_line(comparisons: tuple[Comparison, ...]) -> str:
    """Say how other methods did on the same scans."""
    parts = [f"{other.method} {auc_text(other.held_out)}" for other in comparisons]
    return f"for comparison: {'; '.join(parts)}" if parts else ""


def per_log_line(per_log: PerLog | None) -> str:
    """Say how good the first method is log by log, and how much better than the others.

    >>> against = (Against("nearest range ahead", Auc(0.05, -0.01, 0.12), 9),)
    >>> per_log_line(PerLog(Auc(0.9, 0.8, 0.95), 9, against))
    'mean AUC of 9 logs: 0.90 [.80,.95]; against nearest range ahead: +.05 [-.01,.12] over 9 logs'
    """
    if per_log is None or per_log.logs < MIN_LOGS or per_log.mean.auc is None:
        return ""
    words = [f"mean AUC of {per_log.logs} logs: {auc_text(per_log.mean)}"]
    told = [one for one in per_log.against if one.difference.auc is not None]
    same = len({one.logs for one in told}) == 1
    parts = [_against(one, told=not same) for one in told]
    if parts:
        over = f" over {_logs(told[0].logs)}" if same else ""
        words.append(f"against {', '.join(parts)}{over}")
    return "; ".join(words)


def _against(one: Against, *, told: bool) -> str:
    """Say how much better than one other method, with its logs if these are to be told."""
    difference = one.difference.auc or 0.0
    sign = "-" if round(difference, 2) < 0 else "+"
    size = f"{sign}{short_score(abs(difference))}"
    words = [f"{one.method}:", size, interval_text(one.difference)]
    words += [f"over {_logs(one.logs)}"] if told else []
    return " ".join(word for word in words if word)


def _logs(number: int) -> str:
    return f"{number} log" if number == 1 else f"{number} logs"


def visible_line(visible: VisibleScores | None) -> str:
    """Say what remains without the presses before which nothing near was seen.

    >>> nothing = PerLog(Auc(), 0)
    >>> visible_line(VisibleScores(10, Auc(0.92, 0.82, 0.97), nothing))
    'before 10 presses something near was seen ahead; with these only: AUC 0.92 [.82,.97]'
    """
    if visible is None:
        return ""
    presses = "1 press" if visible.presses == 1 else f"{visible.presses} presses"
    seen = f"before {presses} something near was seen ahead"
    if visible.pooled.auc is None:
        return seen
    parts = [f"with these only: AUC {auc_text(visible.pooled)}", per_log_line(visible.per_log)]
    return "; ".join(part for part in (seen, *parts) if part)


def probability_line(found: Probabilities | None) -> str:
    """Say whether probabilities mean what they say.

    >>> probability_line(Probabilities(0.21, 0.9, -0.1))
    'probabilities: Brier skill 0.21, calibration slope 0.90 (1 is right), intercept -0.10'
    """
    if found is None or found.brier_skill is None:
        return ""
    words = [f"Brier skill {found.brier_skill:.2f}"]
    if found.slope is not None and found.intercept is not None:
        words.append(f"calibration slope {found.slope:.2f} (1 is right)")
        words.append(f"intercept {found.intercept:.2f}")
    return f"probabilities: {', '.join(words)}"
