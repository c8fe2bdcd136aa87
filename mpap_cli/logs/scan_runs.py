"""Laser scans of a run of messages; those that begin alike are read at once."""

from collections import Counter
from itertools import groupby
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from mpap_cli.logs.fields import LOCATED, FieldError, TimeSource, locate_ranges, scan_view
from mpap_cli.logs.layouts import gather, header_stamps, locate_alike
from mpap_cli.logs.raw import RawMessage, RawRun
from mpap_cli.observations import BoolArray, Float32Array, IntArray, ScanGeometry

_BETWEEN_SCANS = slice(-20, -12)  # time_increment, scan_time


class ScanPiece(NamedTuple):
    """Scans of one geometry that follow one another in log time.

    ``recorded_ns`` (n,) is log time, ``stamps_ns`` (n,) the time wanted; ``ranges``
    (n, n_beams) is a copy.
    """

    recorded_ns: IntArray
    stamps_ns: IntArray
    ranges: Float32Array
    geometry: ScanGeometry

    def rows(self, rows: IntArray | BoolArray | slice) -> "ScanPiece":
        """Return some of the scans."""
        recorded_ns, stamps_ns = self.recorded_ns[rows], self.stamps_ns[rows]
        return ScanPiece(recorded_ns, stamps_ns, self.ranges[rows], self.geometry)


def read_scans(
    run: RawRun, time_source: TimeSource = "log"
) -> tuple[list[ScanPiece], Counter[str]]:
    """Read stamps, ranges and geometries of laser scans.

    Parameters
    ----------
    run : RawRun
        Of sensor_msgs/LaserScan (``cdr`` or ``ros1``) or foxglove.LaserScan (``json``).
    time_source : {"log", "header"}
        Which stamps are wanted.

    Returns
    -------
    list of ScanPiece
        In log time order; cut where the geometry changes.
    Counter of str
        Messages that are malformed, by reason; `scan_view` raises FieldError for each.
    """
    if run.topic.encoding not in LOCATED:
        return _read_one_by_one(run, time_source)
    kinds, layouts, skipped = locate_alike(run, locate_ranges, [_BETWEEN_SCANS])
    kept = np.flatnonzero(kinds >= 0)
    if not kept.size:
        return [], skipped
    run, kinds = run.rows(kept), kinds[kept]
    stamps_ns = header_stamps(run)[0] if time_source == "header" else run.stamps_ns
    numbers: dict[tuple[ScanGeometry, np.dtype[np.float32]], int] = {}
    alike = [numbers.setdefault((at.geometry, at.dtype), len(numbers)) for at in layouts]
    cuts = np.flatnonzero(np.diff(np.array(alike)[kinds])) + 1
    places = run.starts + np.array([at.place for at in layouts])[kinds]
    pieces = []
    for begin, end in zip([0, *cuts], [*cuts, len(run)], strict=True):
        rows, at = slice(begin, end), layouts[kinds[begin]]
        ranges = gather(run.records, places[rows], at.n_bytes)
        floats = ranges.view(at.dtype).astype(np.float32, copy=False)
        pieces.append(ScanPiece(run.stamps_ns[rows], stamps_ns[rows], floats, at.geometry))
    return pieces, skipped


def _read_one_by_one(run: RawRun, time_source: TimeSource) -> tuple[list[ScanPiece], Counter[str]]:
    """Read scans that do not lie as numbers in their payloads."""
    skipped: Counter[str] = Counter()
    scans = []
    for number, recorded_ns in enumerate(run.stamps_ns.tolist()):
        message = RawMessage(run.topic, recorded_ns, run.payload(number))
        try:
            scans.append((recorded_ns, *scan_view(message, time_source)))
        except FieldError as err:
            skipped[str(err)] += 1
    pieces = []
    for geometry, group in groupby(scans, itemgetter(3)):
        recorded, stamped, rows, _ = zip(*group, strict=True)
        recorded_ns, stamps_ns = np.array([recorded, stamped], dtype=np.int64)
        ranges = np.array(rows, dtype=np.float32)
        pieces.append(ScanPiece(recorded_ns, stamps_ns, ranges, geometry))
    return pieces, skipped
