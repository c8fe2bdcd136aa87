"""The first method scan by scan and press by press: timeline.csv and presses.csv."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.history import Presses
from mpap_cli.evaluation.leads import (
    FalseAlarms,
    Lead,
    LeadSummary,
    false_alarms,
    press_leads,
    summarise,
)
from mpap_cli.evaluation.rows import PressRow, TimelineRow
from mpap_cli.evaluation.sheets import Sheet
from mpap_cli.observations import NS_PER_S, ObservedLog, Prediction


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Timeline:
    """What was said of each scan, and of each press.

    ``held_out`` is False where only in-sample predictions were possible. ``presses`` are
    those that are scored, log by log; ``leads`` stand beside them.
    """

    logs: tuple[ObservedLog, ...]
    sheet: Sheet
    prediction: Prediction
    threshold: float
    held_out: bool
    presses: tuple[Presses, ...]
    leads: tuple[tuple[Lead, ...], ...]
    summary: LeadSummary

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
            )

    def press_rows(self) -> Iterator[PressRow]:
        """Yield the rows of presses.csv."""
        for index, log in enumerate(self.logs):
            for press, lead in zip(self.presses[index], self.leads[index], strict=True):
                yield PressRow(
                    log=log.name,
                    log_index=index,
                    start_s=(press.start_ns - log.start_ns) / NS_PER_S,
                    end_s=(press.end_ns - log.start_ns) / NS_PER_S,
                    predicted=None if lead.predicted is None else int(lead.predicted),
                    lead_s=lead.lead_s,
                )


def make_timeline(
    logs: tuple[ObservedLog, ...],
    presses: tuple[Presses | None, ...],
    sheet: Sheet,
    prediction: Prediction,
    threshold: float,
) -> Timeline:
    """Judge the presses and count the false alarms of every log that knows of presses."""
    leads: list[tuple[Lead, ...]] = []
    alarms: list[FalseAlarms] = []
    for index, known in enumerate(presses):
        inside = sheet.rows.log_index == index
        stamps_ns, p = sheet.rows.stamps_ns[inside], prediction.p_collision[inside]
        leads.append(tuple(press_leads(stamps_ns, p, known or (), threshold)))
        if known is not None:
            alarms.append(false_alarms(stamps_ns, p, known, threshold))
    return Timeline(
        logs=logs,
        sheet=sheet,
        prediction=prediction,
        threshold=threshold,
        held_out=sheet.protocol != "in-sample" and sheet.folds.plan.n_folds > 0,
        presses=tuple(known or () for known in presses),
        leads=tuple(leads),
        summary=summarise([lead for of_log in leads for lead in of_log], alarms),
    )


def _cell(value: float) -> float | None:
    """Return a number as a table takes it: None for NaN and infinity."""
    return float(value) if np.isfinite(value) else None
