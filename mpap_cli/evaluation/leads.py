"""How early presses are announced, and how often nothing follows (section 5.2, Fig. 9).

A scan is predicted when its probability reaches the threshold; predicted scans that
follow one another are a run. Where scans are more than two seconds apart a run ends.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import NS_PER_S, BoolArray, Float64Array, IntArray, Press

GAP_NS = 2 * NS_PER_S
MARGIN_NS = NS_PER_S


@dataclass(frozen=True, slots=True)
class Lead:
    """What was said before one press.

    ``predicted`` tells whether a run of predicted scans reached the onset, ``lead_s`` how
    long before the onset that run began (0 if none). Both are None where no scan was
    scored in the two seconds before the onset, or the press was on from the start.
    """

    predicted: bool | None
    lead_s: float | None


@dataclass(frozen=True, slots=True)
class FalseAlarms:
    """Predicted runs wholly outside contact with a margin of one second, and that time."""

    runs: int
    seconds: float


@dataclass(frozen=True, slots=True)
class LeadSummary:
    """Announced presses of those judged, median lead and false alarms a minute.

    A missed press counts as a lead of 0 s. ``median_lead_s`` is None without a judged
    press, ``false_alarms_per_min`` None without time outside contact.
    """

    announced: int
    judged: int
    median_lead_s: float | None
    false_alarms_per_min: float | None


def press_leads(
    stamps_ns: IntArray, p: Float64Array, presses: Sequence[Press], threshold: float
) -> list[Lead]:
    """Judge each press of one log.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Stamps of the scans, not decreasing.
    p : ndarray of shape (n,)
        Probabilities; NaN where no model spoke.
    presses : sequence of Press
        Presses of the log.
    threshold : float
        A scan with ``p >= threshold`` is predicted.

    Returns
    -------
    list of Lead
        One for each press, in their order.

    Examples
    --------
    >>> stamps = np.array([0, 1, 2, 3]) * NS_PER_S
    >>> p = np.array([0.0, 0.9, 0.9, 0.0])
    >>> press_leads(stamps, p, [Press(2_500_000_000, 2_600_000_000)], 0.2)
    [Lead(predicted=True, lead_s=1.5)]
    """
    predicted = p >= threshold
    starts = _run_starts(stamps_ns, predicted, np.isnan(p))
    first_of_run = np.maximum.accumulate(np.where(starts, np.arange(p.size), 0))
    leads = []
    for press in presses:
        last = int(np.searchsorted(stamps_ns, press.start_ns, side="right")) - 1
        near = last >= 0 and press.start_ns - stamps_ns[last] <= GAP_NS
        if press.held_from_start or not near or np.isnan(p[last]):
            leads.append(Lead(None, None))
        elif predicted[last]:
            first_ns = int(stamps_ns[first_of_run[last]])
            leads.append(Lead(True, (press.start_ns - first_ns) / NS_PER_S))
        else:
            leads.append(Lead(False, 0.0))
    return leads


def false_alarms(
    stamps_ns: IntArray, p: Float64Array, presses: Sequence[Press], threshold: float
) -> FalseAlarms:
    """Count the runs of one log that lie wholly outside contact, and sum that time.

    Parameters are those of :func:`press_leads`. A run that touches the second before or
    after a press belongs to it, however early it began. Time counts between scored scans
    that follow one another, both outside.
    """
    unknown = np.isnan(p)
    predicted = p >= threshold
    outside = ~_in_contact(stamps_ns, presses) & ~unknown
    starts = _run_starts(stamps_ns, predicted, unknown)
    run = np.cumsum(starts)[predicted] - 1
    touching = np.bincount(run, ~outside[predicted], minlength=int(starts.sum()))
    steps = np.diff(stamps_ns)
    counted = outside[1:] & outside[:-1] & (steps <= GAP_NS)
    return FalseAlarms(int(np.sum(touching == 0)), float(steps[counted].sum() / NS_PER_S))


def summarise(leads: Sequence[Lead], alarms: Sequence[FalseAlarms]) -> LeadSummary:
    """Join the leads and false alarms of all logs."""
    judged = [lead.lead_s for lead in leads if lead.lead_s is not None]
    seconds = sum(part.seconds for part in alarms)
    runs = sum(part.runs for part in alarms)
    return LeadSummary(
        announced=sum(lead.predicted is True for lead in leads),
        judged=len(judged),
        median_lead_s=float(np.median(judged)) if judged else None,
        false_alarms_per_min=runs * 60 / seconds if seconds > 0 else None,
    )


def _run_starts(stamps_ns: IntArray, predicted: BoolArray, unknown: BoolArray) -> BoolArray:
    """Mark the first scan of each run of predicted scans."""
    starts = predicted & ~unknown
    follows = predicted[:-1] & (np.diff(stamps_ns) <= GAP_NS)
    starts[1:] &= ~follows
    return starts


def _in_contact(stamps_ns: IntArray, presses: Sequence[Press]) -> BoolArray:
    """Mark scans in a press or within the margin of one."""
    inside = np.zeros(stamps_ns.size, dtype=np.bool_)
    for press in presses:
        first = np.searchsorted(stamps_ns, press.start_ns - MARGIN_NS, side="left")
        last = np.searchsorted(stamps_ns, press.end_ns + MARGIN_NS, side="left")
        inside[first:last] = True
    return inside
