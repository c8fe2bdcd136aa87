"""Laser scans of a run of messages; those that begin alike are read at once."""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from mpap_cli.logs.fields import (
    LOCATED,
    FieldError,
    ScanLayout,
    TimeSource,
    locate_ranges,
    scan_view,
)
from mpap_cli.logs.layouts import gather, gather_into, header_stamps, locate_alike
from mpap_cli.logs.raw import RawMessage, RawRun
from mpap_cli.observations import BoolArray, Float32Array, IntArray, ScanGeometry

_BETWEEN_SCANS = slice(-20, -12)  # time_increment, scan_time
_NATIVE = np.dtype(np.float32)


class Payloads(NamedTuple):
    """Ranges that lie in memory as they were recorded, from ``places`` (n,) on."""

    records: bytes
    places: IntArray

    def write(self, rows: Float32Array) -> None:
        """Copy them into rows (n, n_beams)."""
        gather_into(self.records, self.places, rows.view(np.uint8))


class ScanPiece(NamedTuple):
    """Scans of one geometry that follow one another in log time.

    ``recorded_ns`` (n,) is log time, ``stamps_ns`` (n,) the time wanted; ``held`` are the
    ranges (n, n_beams), or where they lie: then they are copied once, when it is known where to.
    """

    recorded_ns: IntArray
    stamps_ns: IntArray
    held: Float32Array | Payloads
    geometry: ScanGeometry

    @property
    def ranges(self) -> Float32Array:
        """The ranges (n, n_beams)."""
        if not isinstance(self.held, Payloads):
            return self.held
        ranges = np.empty((len(self.stamps_ns), self.geometry.n_beams), np.float32)
        self.held.write(ranges)
        return ranges

    def rows(self, rows: IntArray | BoolArray | slice) -> "ScanPiece":
        """Return some of the scans."""
        held = self.held
        some = held._replace(places=held.places[rows]) if isinstance(held, Payloads) else held[rows]
        return ScanPiece(self.recorded_ns[rows], self.stamps_ns[rows], some, self.geometry)

    def write(self, rows: Float32Array) -> None:
        """Copy the ranges into rows (n, n_beams)."""
        if isinstance(self.held, Payloads):
            self.held.write(rows)
        else:
            rows[:] = self.held


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
    if skipped:
        kept = np.flatnonzero(kinds >= 0)
        run, kinds = run.rows(kept), kinds[kept]
    stamps_ns = header_stamps(run)[0] if time_source == "header" else run.stamps_ns
    pieces = []
    for rows, at in _rows_alike(kinds, layouts):
        places = run.starts[rows] + np.array([one.place for one in layouts])[kinds[rows]]
        held: Float32Array | Payloads = Payloads(run.records, places)
        # whoever holds memory for little of it holds too much
        if at.dtype != _NATIVE or 2 * places.size * at.n_bytes < len(run.records):
            ranges = gather(run.records, places, at.n_bytes)
            held = ranges.view(at.dtype).astype(np.float32, copy=False)
        pieces.append(ScanPiece(run.stamps_ns[rows], stamps_ns[rows], held, at.geometry))
    return pieces, skipped


def _rows_alike(
    kinds: IntArray, layouts: Sequence[ScanLayout]
) -> Iterator[tuple[slice, ScanLayout]]:
    """Yield the rows that follow one another with one geometry and byte order, and a layout."""
    numbers: dict[tuple[ScanGeometry, np.dtype[np.float32]], int] = {}
    alike = [numbers.setdefault((at.geometry, at.dtype), len(numbers)) for at in layouts]
    cuts = [0, len(kinds)] if len(kinds) else []
    if len(numbers) > 1:
        changes = np.flatnonzero(np.diff(np.array(alike)[kinds])) + 1
        cuts[1:1] = changes.tolist()
    for begin, end in pairwise(cuts):
        yield slice(begin, end), layouts[kinds[begin]]


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
