"""The alarms of profile robust, held against the presses that followed."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.leads import Lead
from mpap_cli.evaluation.operating import OperatingPoint, operating_point
from mpap_cli.evaluation.sheets import Sheet
from mpap_cli.observations import Float64Array
from mpap_cli.params import PropertyParams
from mpap_cli.properties.alarms import alarm_levels

# Odds against those from which an alarm begins.
BEGINS = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Alarms:
    """What the alarms announced.

    ``levels`` (n,) of the n scans, an alarm from 1 up, are NaN where no model spoke;
    ``leads`` are of all presses, log by log; the ``point`` sums them up.
    """

    levels: Float64Array
    leads: tuple[Lead, ...]
    point: OperatingPoint

    def at(self, scan: int) -> int | None:
        """Return whether there is an alarm at a scan, 1 or 0; None where no model spoke."""
        level = self.levels[scan]
        return None if np.isnan(level) else int(level >= BEGINS)


def make_alarms(sheet: Sheet, odds: Float64Array, params: PropertyParams) -> Alarms:
    """Raise the alarms log by log, and judge them.

    Parameters
    ----------
    sheet : Sheet
        n scans, and the presses that are announced or not.
    odds : ndarray of shape (n,)
        Of each scan, against those from which the model that tests it raises an alarm.
    params : PropertyParams
        ``alarm_release`` and ``alarm_hold_s``.
    """
    levels = np.full(odds.size, np.nan)
    for log in np.unique(sheet.rows.log_index):
        inside = sheet.rows.log_index == log
        levels[inside] = alarm_levels(sheet.rows.stamps_ns[inside], odds[inside], params)
    judge = sheet.announcing.judge(levels)
    leads = tuple(judge.leads(BEGINS))
    point = operating_point(judge, sheet.announcing.visible, BEGINS)
    return Alarms(levels, leads, point)
