"""Operating points: what each threshold announces, how early, and at what price.

Thresholds are read off the scores that they are judged on, so the best row is the best
that could have been chosen; a threshold to be used has to be chosen on other logs.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.history import Presses
from mpap_cli.evaluation.leads import LeadSummary, PressJudge, summarize
from mpap_cli.evaluation.rows import AucRow, OperatingRow
from mpap_cli.evaluation.visible import Visible
from mpap_cli.observations import NS_PER_S, Float64Array, IntArray, Press

# Longer than any run, margin or look-back of one log reaches into the next.
PAUSE_NS = 10 * NS_PER_S
N_QUANTILES = 101
MAX_PRESS_THRESHOLDS = 201
FALSE_ALARMS_PER_MIN = 1.0
# One alarm a minute that lasts six seconds; without it an alarm that never ends is best.
ALARM_SHARE = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class JoinedLogs:
    """Scans and presses of several logs, one after the other with a pause between.

    ``scans`` (k,) are the rows of the scans of logs that know of presses and
    ``stamps_ns`` (k,) their stamps on a common clock, on which ``presses`` lie too;
    ``visible`` stands beside these.
    """

    scans: IntArray
    stamps_ns: IntArray
    presses: Presses
    visible: Visible

    def judge(self, p: Float64Array) -> PressJudge:
        """Judge the presses by the probabilities of all n scans."""
        return PressJudge(self.stamps_ns, p[self.scans], self.presses)


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """What ``p >= threshold`` announces of all presses, and of the visible ones."""

    threshold: float
    every: LeadSummary
    visible: LeadSummary


def join_logs(
    log_index: IntArray,
    stamps_ns: IntArray,
    presses: Sequence[Presses | None],
    visible: Sequence[Visible],
) -> JoinedLogs:
    """Put logs on one clock, so that a threshold is judged on all of them at once.

    Parameters
    ----------
    log_index, stamps_ns : ndarray of shape (n,)
        Log and stamp of each scan, log by log, stamps not decreasing within one.
    presses : sequence of tuple of Press, or None
        Presses of each log; one without any knowledge of presses is left out.
    visible : sequence of tuple of (bool or None)
        Beside the presses.
    """
    scans, stamps = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    moved, told = list[Press](), list[bool | None]()
    end_ns = 0
    for index, known in enumerate(presses):
        rows = np.flatnonzero(log_index == index)
        if known is None:
            continue
        bounds = stamps_ns[rows[[0, -1]]].tolist() if rows.size else []
        bounds += [bound for press in known for bound in (press.start_ns, press.end_ns)]
        by_ns = end_ns + PAUSE_NS - min(bounds, default=0)
        scans.append(rows)
        stamps.append(stamps_ns[rows] + by_ns)
        moved += [_moved(press, by_ns) for press in known]
        told += visible[index]
        end_ns = max(bounds, default=0) + by_ns
    return JoinedLogs(np.concatenate(scans), np.concatenate(stamps), tuple(moved), tuple(told))


def operating_points(logs: JoinedLogs, p: Float64Array) -> tuple[OperatingPoint, ...]:
    """Judge the presses at many thresholds.

    Parameters
    ----------
    logs : JoinedLogs
        Scans and presses.
    p : ndarray of shape (n,)
        Probabilities of all scans, NaN where no model spoke.

    Returns
    -------
    tuple of OperatingPoint
        Thresholds descending: every one at which the recall changes, and the percentiles
        of the probabilities. Nothing without a press to judge.
    """
    judge = logs.judge(p)
    thresholds = _thresholds(judge.p_at_presses, p[logs.scans])
    return tuple(operating_point(judge, logs.visible, one) for one in thresholds)


def operating_point(judge: PressJudge, visible: Visible, threshold: float) -> OperatingPoint:
    """Judge the presses, of which some were visible, at one threshold."""
    leads, alarms = judge.leads(threshold), [judge.false_alarms(threshold)]
    seen = [lead for lead, one in zip(leads, visible, strict=True) if one]
    return OperatingPoint(threshold, summarize(leads, alarms), summarize(seen, alarms))


def _thresholds(at_presses: Float64Array, p: Float64Array) -> list[float]:
    """Return the thresholds worth a row, descending; none without a press to judge."""
    if at_presses.size == 0:
        return []
    at_presses = np.unique(at_presses)
    if at_presses.size > MAX_PRESS_THRESHOLDS:
        places = np.linspace(0, at_presses.size - 1, MAX_PRESS_THRESHOLDS).round()
        at_presses = at_presses[places.astype(np.int64)]
    shares = np.linspace(0, 1, N_QUANTILES)
    percentiles = np.quantile(p[~np.isnan(p)], shares, method="higher")
    found: list[float] = np.unique(np.concatenate((at_presses, percentiles)))[::-1].tolist()
    return found


def most_recall(
    points: Sequence[OperatingPoint], below_per_min: float = FALSE_ALARMS_PER_MIN
) -> OperatingPoint | None:
    """Return the point with most recall at fewer false alarms than so many a minute.

    Points that raise the alarm for a tenth of the time outside contact or more are left out.

    Parameters
    ----------
    points : sequence of OperatingPoint
        Of one method.
    below_per_min : float
        False alarms a minute that are too many.

    Returns
    -------
    OperatingPoint or None
        The one that announces most of the visible presses, then of all; then with the
        longer median lead, then with fewer false alarms. None if every one has too many.
    """
    allowed = [
        point
        for point in points
        if point.every.judged
        and point.every.false_alarms_per_min is not None
        and point.every.false_alarms_per_min < below_per_min
        and (point.every.alarm_share or 0.0) < ALARM_SHARE
    ]
    return max(allowed, key=_goodness, default=None)


def operating_rows(row: AucRow, points: Sequence[OperatingPoint]) -> Iterator[OperatingRow]:
    """Yield the rows of operating.csv of the method of one row of auc.csv."""
    for point in points:
        yield OperatingRow(
            method=row.method,
            feature=row.feature,
            bins=row.bins,
            profile=row.profile,
            target=row.target,
            protocol=row.protocol,
            threshold=point.threshold,
            presses=point.every.judged,
            announced=point.every.announced,
            recall=point.every.recall,
            median_lead_s=point.every.median_lead_s,
            visible_presses=point.visible.judged,
            visible_announced=point.visible.announced,
            visible_recall=point.visible.recall,
            visible_median_lead_s=point.visible.median_lead_s,
            false_alarms_per_min=point.every.false_alarms_per_min,
            alarm_share=point.every.alarm_share,
        )


def _goodness(point: OperatingPoint) -> tuple[float, ...]:
    """Order points: the best is the greatest."""
    return (
        point.visible.announced,
        point.every.announced,
        point.visible.median_lead_s or 0.0,
        point.every.median_lead_s or 0.0,
        -(point.every.false_alarms_per_min or 0.0),
    )


def _moved(press: Press, by_ns: int) -> Press:
    """Move a press on the clock."""
    bounds = (press.start_ns + by_ns, press.end_ns + by_ns)
    return Press(*bounds, press.held_from_start, press.released)
