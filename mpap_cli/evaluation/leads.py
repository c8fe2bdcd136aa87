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
    """Predicted runs wholly outside contact with a margin of one second, and that time.

    ``alarmed_s`` of the ``seconds`` are predicted, by these runs or by those that go on into
    a contact: an alarm that never ends is one run.
    """

    runs: int
    seconds: float
    alarmed_s: float


@dataclass(frozen=True, slots=True)
class LeadSummary:
    """Announced presses of those judged, median lead and false alarms a minute.

    A missed press counts as a lead of 0 s. ``median_lead_s`` is None without a judged
    press, ``false_alarms_per_min`` and ``alarm_share`` (of that time) None without time
    outside contact.
    """

    announced: int
    judged: int
    median_lead_s: float | None
    false_alarms_per_min: float | None
    alarm_share: float | None

    @property
    def recall(self) -> float | None:
        """Share of the judged presses that were announced, None without any."""
        return self.announced / self.judged if self.judged else None


class PressJudge:
    """Scans and presses on one clock, to be judged at one threshold after the other.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Stamps of the scans, not decreasing.
    p : ndarray of shape (n,)
        Probabilities; NaN where no model spoke.
    presses : sequence of Press
        In time order.

    Examples
    --------
    >>> stamps = np.array([0, 1, 2, 3]) * NS_PER_S
    >>> p = np.array([0.0, 0.9, 0.9, 0.0])
    >>> judge = PressJudge(stamps, p, [Press(2_500_000_000, 2_600_000_000)])
    >>> judge.leads(0.2)
    [Lead(predicted=True, lead_s=1.5)]
    """

    def __init__(self, stamps_ns: IntArray, p: Float64Array, presses: Sequence[Press]) -> None:
        self._stamps_ns = stamps_ns
        self._p = p
        self._follows = np.diff(stamps_ns) <= GAP_NS
        self._starts_ns = [press.start_ns for press in presses]
        last = np.searchsorted(stamps_ns, self._starts_ns, side="right") - 1
        self._last = [
            None
            if press.held_from_start
            or index < 0
            or press.start_ns - stamps_ns[index] > GAP_NS
            or np.isnan(p[index])
            else index
            for press, index in zip(presses, last.tolist(), strict=True)
        ]
        known = ~np.isnan(p)
        self._outside = ~_in_contact(stamps_ns, presses) & known
        counted = self._outside[1:] & self._outside[:-1] & self._follows
        self._steps_s = np.where(counted, np.diff(stamps_ns) / NS_PER_S, 0.0)

    @property
    def p_at_presses(self) -> Float64Array:
        """Probability at each press that can be judged: it is announced up to that threshold."""
        return self._p[[index for index in self._last if index is not None]]

    def leads(self, threshold: float) -> list[Lead]:
        """Judge each press, where a scan with ``p >= threshold`` is predicted.

        Returns
        -------
        list of Lead
            One for each press, in their order.
        """
        predicted = self._p >= threshold
        starts = self._run_starts(predicted)
        first_of_run = np.maximum.accumulate(np.where(starts, np.arange(predicted.size), 0))
        leads = []
        for start_ns, last in zip(self._starts_ns, self._last, strict=True):
            if last is None:
                leads.append(Lead(None, None))
            elif predicted[last]:
                first_ns = int(self._stamps_ns[first_of_run[last]])
                leads.append(Lead(True, (start_ns - first_ns) / NS_PER_S))
            else:
                leads.append(Lead(False, 0.0))
        return leads

    def false_alarms(self, threshold: float) -> FalseAlarms:
        """Count the runs that lie wholly outside contact, and sum that time.

        A run that touches the second before or after a press belongs to it, however early
        it began. Time counts between scored scans that follow one another, both outside.
        """
        run, predicted = self._runs(threshold)
        touching = np.unique(run[predicted & ~self._outside])
        n_runs = int(run[-1]) if run.size else 0
        alarmed_s = float(self._steps_s @ predicted[:-1])
        return FalseAlarms(n_runs - touching.size, float(self._steps_s.sum()), alarmed_s)

    def false_runs(self, threshold: float) -> list[tuple[int, int]]:
        """Return the first scan of each of these runs, and the one behind its last."""
        run, predicted = self._runs(threshold)
        touching = np.unique(run[predicted & ~self._outside])
        rows = np.flatnonzero(predicted & ~np.isin(run, touching))
        parts = np.split(rows, np.flatnonzero(np.diff(run[rows])) + 1)
        return [(int(part[0]), int(part[-1]) + 1) for part in parts if part.size]

    def _runs(self, threshold: float) -> tuple[IntArray, BoolArray]:
        """Return the number of the last run up to each scan, and which scans are predicted."""
        predicted = self._p >= threshold
        return np.cumsum(self._run_starts(predicted)), predicted

    def _run_starts(self, predicted: BoolArray) -> BoolArray:
        """Mark the first scan of each run of predicted scans; NaN is never predicted."""
        starts = predicted.copy()
        starts[1:] &= ~(predicted[:-1] & self._follows)
        return starts


def summarize(leads: Sequence[Lead], alarms: Sequence[FalseAlarms]) -> LeadSummary:
    """Join the leads and false alarms of all logs."""
    judged = [lead.lead_s for lead in leads if lead.lead_s is not None]
    seconds = sum(part.seconds for part in alarms)
    runs = sum(part.runs for part in alarms)
    return LeadSummary(
        announced=sum(lead.predicted is True for lead in leads),
        judged=len(judged),
        median_lead_s=float(np.median(judged)) if judged else None,
        false_alarms_per_min=runs * 60 / seconds if seconds > 0 else None,
        alarm_share=sum(part.alarmed_s for part in alarms) / seconds if seconds > 0 else None,
    )


def _in_contact(stamps_ns: IntArray, presses: Sequence[Press]) -> BoolArray:
    """Mark scans in a press or within the margin of one."""
    inside = np.zeros(stamps_ns.size, dtype=np.bool_)
    for press in presses:
        first = np.searchsorted(stamps_ns, press.start_ns - MARGIN_NS, side="left")
        last = np.searchsorted(stamps_ns, press.end_ns + MARGIN_NS, side="left")
        inside[first:last] = True
    return inside
