"""The first method scan by scan and press by press: timeline.csv and presses.csv."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mpap_cli.evaluation.alarms import Alarms, make_alarms
from mpap_cli.evaluation.history import Presses
from mpap_cli.evaluation.leads import Lead, LeadSummary
from mpap_cli.evaluation.operating import operating_point
from mpap_cli.evaluation.rows import PressRow, TimelineRow
from mpap_cli.evaluation.sheets import Question, Sheet
from mpap_cli.evaluation.visible import Visible
from mpap_cli.observations import NS_PER_S, ObservedLog, Prediction
from mpap_cli.params import Settings


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Timeline:
    """What was said of each scan, and of each press.

    ``held_out`` is False where only in-sample predictions were possible. ``presses`` are
    those that are scored, log by log; ``leads`` and ``visible`` stand beside them.
    ``visible_summary`` is of the visible ones. ``alarms`` are those of profile robust, None
    under profile paper.
    """

    logs: tuple[ObservedLog, ...]
    sheet: Sheet
    prediction: Prediction
    threshold: float
    held_out: bool
    presses: tuple[Presses, ...]
    leads: tuple[tuple[Lead, ...], ...]
    visible: tuple[Visible, ...]
    summary: LeadSummary
    visible_summary: LeadSummary
    alarms: Alarms | None

    def rows(self) -> Iterator[TimelineRow]:
        """Yield the rows of timeline.csv."""
        found, scans = self.prediction, self.sheet.rows
        for i in range(scans.n_scans):
            log_index, stamp_ns = int(scans.log_index[i]), int(scans.stamps_ns[i])
            log = self.logs[log_index]
            known = bool(found.cluster[i] >= 0)
            p = _cell(found.p_collision[i])
            yield TimelineRow(
                log=log.name,
                log_index=log_index,
                time_s=(stamp_ns - log.start_ns) / NS_PER_S,
                stamp_ns=stamp_ns,
                cluster=int(found.cluster[i]) if known else None,
                p_cluster=_cell(found.p_cluster[i]),
                p_collision=p,
                predicted=None if p is None else int(p >= self.threshold),
                truth=int(self.sheet.truth[i]) if self.sheet.truth[i] >= 0 else None,
                distance=_cell(found.distance[i]),
                novel=None if np.isnan(found.distance[i]) else int(found.novel[i]),
                alarm=None if self.alarms is None else self.alarms.at(i),
            )

    def press_rows(self) -> Iterator[PressRow]:
        """Yield the rows of presses.csv."""
        alarm_leads = iter(self.alarms.leads if self.alarms is not None else ())
        for index, log in enumerate(self.logs):
            beside = (self.presses[index], self.leads[index], self.visible[index])
            for press, lead, visible in zip(*beside, strict=True):
                alarm = next(alarm_leads, None)
                yield PressRow(
                    log=log.name,
                    log_index=index,
                    start_s=(press.start_ns - log.start_ns) / NS_PER_S,
                    end_s=(press.end_ns - log.start_ns) / NS_PER_S,
                    predicted=None if lead.predicted is None else int(lead.predicted),
                    lead_s=lead.lead_s,
                    visible=None if visible is None else int(visible),
                    alarm_lead_s=None if alarm is None else alarm.lead_s,
                )


def make_timeline(
    question: Question, sheet: Sheet, prediction: Prediction, settings: Settings
) -> Timeline:
    """Judge the presses and count the false alarms of every log that knows of presses."""
    robust = settings.profile == "robust"
    presses = tuple(known or () for known in question.scored_presses())
    logs = sheet.announcing
    judge = logs.judge(prediction.p_collision)
    leads = judge.leads(question.threshold)
    point = operating_point(judge, logs.visible, question.threshold)
    first = np.cumsum([0, *(len(of_log) for of_log in presses)]).tolist()
    return Timeline(
        logs=question.logs,
        sheet=sheet,
        prediction=prediction,
        threshold=question.threshold,
        held_out=sheet.protocol != "in-sample" and sheet.folds.plan.n_folds > 0,
        presses=presses,
        leads=tuple(tuple(leads[at:to]) for at, to in pairwise(first)),
        visible=question.seen_presses(),
        summary=point.every,
        visible_summary=point.visible,
        alarms=make_alarms(sheet, prediction.alarm, settings.properties) if robust else None,
    )


def _cell(value: float) -> float | None:
    """Return a number as a table takes it: None for NaN and infinity."""
    return float(value) if np.isfinite(value) else None
