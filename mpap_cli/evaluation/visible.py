"""Which presses the scanner could have foreseen: something near was seen ahead just before.

A hand, a foot or a low thing closes a bumper without any sign in the scans. No method that
looks at scans can announce such a press, so recall and areas are told with and without.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.evaluation.history import Presses
from mpap_cli.features.scans.scan_bins import beam_bearings
from mpap_cli.features.scans.scan_cleaning import clean_ranges, range_limits
from mpap_cli.observations import (
    NS_PER_S,
    Float64Array,
    IntArray,
    ObservedLog,
    ScanBlock,
    ScanGeometry,
)
from mpap_cli.params import EvaluationParams, ScanParams

BEFORE_NS = NS_PER_S
# A quartile of fewer presses is one of their extremes.
MIN_PRESSES = 4
_ANGLE_TOLERANCE = 1e-6

Visible = tuple[bool | None, ...]
Scanner = tuple[float, int]


@dataclass(frozen=True, slots=True, eq=False)
class BeforePresses:
    """What was seen before the m presses of one log.

    ``nearest_m`` (m,) is the nearest return ahead in the last second up to each onset:
    infinity where there was none, NaN without any scan, or where the press was on from
    the start. ``scanner`` tells scanners of one kind from those of another.
    """

    scanner: Scanner | None
    nearest_m: Float64Array


def visible_presses(
    logs: Sequence[ObservedLog],
    presses: Sequence[Presses | None],
    scan: ScanParams,
    params: EvaluationParams,
) -> tuple[Visible, ...]:
    """Tell for each press whether something near was seen before it.

    Parameters
    ----------
    logs : sequence of ObservedLog
        Their scans are read where there are presses.
    presses : sequence of tuple of Press, or None
        Presses of each log, in time order.
    scan : ScanParams
        How ranges are cleaned.
    params : EvaluationParams
        ``visible_m``, ``visible_margin_m``, ``visible_deg``.

    Returns
    -------
    tuple of tuple of (bool or None)
        One for each press; None where no scan was made in the second before it, or it was
        on from the start.

    Notes
    -----
    A press is visible if a return nearer than a limit lay within ``visible_deg`` of
    straight ahead in the second up to its onset. The limit is ``visible_m``, or more for a
    scanner that sits farther from the bumper: the lower quartile of the nearest returns
    before all presses of that kind of scanner, and ``visible_margin_m``. The quartile needs
    four presses, and holds as long as a quarter of them were visible.
    """
    found = [
        nearest_before(log, known or (), scan, params.visible_deg)
        for log, known in zip(logs, presses, strict=True)
    ]
    of_scanner: dict[Scanner | None, list[Float64Array]] = defaultdict(list)
    for one in found:
        of_scanner[one.scanner].append(one.nearest_m)
    limits = {
        scanner: visible_limit(np.concatenate(parts), params)
        for scanner, parts in of_scanner.items()
    }
    return tuple(
        tuple(
            None if math.isnan(nearest) else nearest < limits[one.scanner]
            for nearest in one.nearest_m.tolist()
        )
        for one in found
    )


def visible_limit(nearest_m: Float64Array, params: EvaluationParams) -> float:
    """Return below which range a press counts as visible, in metres.

    Parameters
    ----------
    nearest_m : ndarray of shape (m,)
        Nearest return before each press of one kind of scanner, as in
        :class:`BeforePresses`.
    params : EvaluationParams
        ``visible_m`` and ``visible_margin_m``.

    Examples
    --------
    A scanner half a metre behind the bumper, and one press by a foot:

    >>> nearest_m = np.array([0.7, 0.65, 0.7, 0.9, 3.0])
    >>> round(visible_limit(nearest_m, EvaluationParams()), 2)
    0.9
    """
    known = nearest_m[~np.isnan(nearest_m)]
    if known.size < MIN_PRESSES:
        return params.visible_m
    quartile = float(np.quantile(known, 0.25, method="lower"))
    if math.isinf(quartile):
        return params.visible_m
    return max(params.visible_m, quartile + params.visible_margin_m)


def nearest_before(
    log: ObservedLog, presses: Presses, scan: ScanParams, within_deg: float
) -> BeforePresses:
    """Find the nearest return ahead in the second before each press of one log.

    Parameters
    ----------
    log : ObservedLog
        Read once, not at all without presses.
    presses : tuple of Press
        In time order.
    scan : ScanParams
        How ranges are cleaned; what returns nothing is never near.
    within_deg : float
        Half of the angle about straight ahead.

    Raises
    ------
    UsageError
        If no maximum range is known.
    """
    nearest = np.full(len(presses), np.nan)
    scanner: Scanner | None = None
    if not presses:
        return BeforePresses(scanner, nearest)
    starts = np.array([press.start_ns for press in presses], dtype=np.int64)
    for block in log.blocks():
        scanner = scanner or kind_of(block.geometry)
        first = np.searchsorted(block.stamps_ns, starts - BEFORE_NS, side="left")
        after = np.searchsorted(block.stamps_ns, starts, side="right")
        for index in np.flatnonzero(after > first).tolist():
            rows = np.arange(first[index], after[index])
            seen = _nearest_ahead(block, rows, log, scan, within_deg)
            nearest[index] = np.fmin(nearest[index], seen)
    held = np.array([press.held_from_start for press in presses])
    nearest[held] = np.nan
    return BeforePresses(scanner, nearest)


def _nearest_ahead(
    block: ScanBlock, rows: IntArray, log: ObservedLog, scan: ScanParams, within_deg: float
) -> float:
    """Return the nearest return ahead in some scans of a block, infinity without any."""
    limits = range_limits(block.geometry, replace(scan, no_return="max"), log.range_max)
    bearings = np.abs(beam_bearings(block.geometry, log.forward_rad))
    ahead = bearings <= math.radians(within_deg) + _ANGLE_TOLERANCE
    if not ahead.any():
        return math.inf
    nearest = float(clean_ranges(block.ranges[rows][:, ahead], limits).min())
    return nearest if nearest < limits.cap else math.inf


def kind_of(geometry: ScanGeometry) -> Scanner:
    """Tell kinds of scanners apart by range and field; the number of beams may vary."""
    field = geometry.n_beams * abs(geometry.angle_increment)
    return (round(geometry.range_max, 2), round(math.degrees(field) / 10))
