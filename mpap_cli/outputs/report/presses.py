"""The section of presses: when the bumper was hit, and what was seen before."""

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from markupsafe import Markup

from mpap_cli.errors import ModelError
from mpap_cli.observations import NS_PER_S, IntArray, ObservedLog
from mpap_cli.outputs.recording import RECORDING_NAME, read_recording
from mpap_cli.outputs.report.drawings import scan_svg
from mpap_cli.outputs.report.runs import MOST_SIGNS, Row, Runs, number
from mpap_cli.outputs.scan_views import SeenScan, common_scale, see

MOST_DRAWN = 60
_BEFORE_S = (1.0, 0.0)
_SAME_PRESS_S = 0.05


@dataclass(frozen=True, slots=True)
class PressView:
    """One press: where, whether it was announced, and drawings of the scans before it."""

    log: str
    start_s: float
    end_s: float
    announced: str
    is_announced: bool
    drawings: tuple[tuple[str, Markup], ...]


def press_views(runs: Runs) -> list[PressView]:
    """Return the first 60 presses that were evaluated last, with what was seen before them."""
    rows = list(islice(runs.rows("evaluate", "presses.csv"), MOST_DRAWN))
    path = runs.path("learn", RECORDING_NAME)
    seen: dict[tuple[int, float], SeenScan] = {}
    if rows and path is not None:
        try:
            seen = _seen_before(path, rows)
        except ModelError as err:
            runs.problems.append(str(err))
    top_m = common_scale(list(seen.values())) if seen else 1.0
    return [_view(row, place, seen, top_m) for place, row in enumerate(rows)]


def lead_of(row: Row) -> float:
    """Return how early a press was announced, by an alarm where there are any; 0: not at all.

    >>> lead_of({"lead_s": "0.5", "alarm_lead_s": "0.0"}), lead_of({"lead_s": "0.5"})
    (0.0, 0.5)
    """
    leads = [number(row.get(column, "")) for column in ("alarm_lead_s", "lead_s")]
    return next((lead for lead in leads if lead is not None), 0.0)


def _view(row: Row, place: int, seen: dict[tuple[int, float], SeenScan], top_m: float) -> PressView:
    """Put together what is shown of one press."""
    lead = lead_of(row)
    drawings = tuple(
        (words, scan_svg(one.angles, one.ranges, top_m, f"scan {words}"))
        for before, words in zip(_BEFORE_S, ("1 s before", "at the press"), strict=True)
        if (one := seen.get((place, before))) is not None
    )
    return PressView(
        log=row["log"][:MOST_SIGNS],
        start_s=float(row["start_s"]),
        end_s=float(row["end_s"]),
        announced=f"announced {lead:.1f} s before" if lead else "not announced",
        is_announced=lead > 0,
        drawings=drawings,
    )


def _seen_before(path: Path, rows: list[Row]) -> dict[tuple[int, float], SeenScan]:
    """Return the scan nearest to each moment, by number of the press and seconds before it."""
    found: dict[tuple[int, float], SeenScan] = {}
    for log in read_recording(path):
        wanted = [
            (place, before, log.start_ns + round((float(row["start_s"]) - before) * NS_PER_S))
            for place, row in enumerate(rows)
            if row["log"] == log.name and _is_press_of(log, float(row["start_s"]))
            for before in _BEFORE_S
        ]
        if wanted:
            stamps_ns = np.array([stamp_ns for _, _, stamp_ns in wanted], dtype=np.int64)
            scans = _nearest(log, stamps_ns)
            found |= {
                (place, before): scan
                for (place, before, _), scan in zip(wanted, scans, strict=True)
                if scan is not None
            }
    return found


def _is_press_of(log: ObservedLog, start_s: float) -> bool:
    """Tell whether a log, and not only one of the same name, has a press at that time."""
    starts_s = [(press.start_ns - log.start_ns) / NS_PER_S for press in log.presses or ()]
    return any(abs(start_s - other) < _SAME_PRESS_S for other in starts_s)


def _nearest(log: ObservedLog, stamps_ns: IntArray) -> list[SeenScan | None]:
    """Return the scans of a log that lie nearest to some stamps, within half a second."""
    best = np.full(stamps_ns.size, NS_PER_S // 2, dtype=np.int64)
    scans: list[SeenScan | None] = [None] * stamps_ns.size
    for block in log.blocks():
        if block.stamps_ns.size == 0:
            continue
        distances = np.abs(block.stamps_ns[None, :] - stamps_ns[:, None])
        nearest = distances.argmin(axis=1)
        for place in np.flatnonzero(distances.min(axis=1) < best):
            index = int(nearest[place])
            best[place] = distances[place, index]
            ranges = block.ranges[index]
            scans[place] = see(ranges, block.geometry, log.forward_rad, log.range_max)
    return scans
