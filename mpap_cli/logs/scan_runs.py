"""Runs of messages that begin alike are read at once: laser scans, stamps of headers."""

from collections import Counter
from itertools import groupby
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mpap_cli.logs.fields import (
    CDR_BYTE_ORDERS,
    LOCATED,
    FieldError,
    ScanLayout,
    TimeSource,
    locate_ranges,
    scan_view,
)
from mpap_cli.logs.raw import RawMessage, RawRun
from mpap_cli.observations import NS_PER_S, BoolArray, Float32Array, IntArray, ScanGeometry

_MAX_COMPARED = 8
_HEAD_BYTES = 16  # encapsulation or sequence number, stamp, length of the frame name
_STAMP = slice(4, 12)
_SEQUENCE = slice(4)
_BETWEEN_SCANS = slice(-20, -12)  # time_increment, scan_time
_FLOAT_BYTES = 4
_BIG = [number for number, order in CDR_BYTE_ORDERS.items() if order == "big"]


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
    kinds, layouts, skipped = _locate(run)
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
        ranges = _gather(run.records, places[rows], _FLOAT_BYTES * at.geometry.n_beams)
        floats = ranges.view(at.dtype).astype(np.float32, copy=False)
        pieces.append(ScanPiece(run.stamps_ns[rows], stamps_ns[rows], floats, at.geometry))
    return pieces, skipped


def _locate(run: RawRun) -> tuple[IntArray, list[ScanLayout], Counter[str]]:
    """Return which layout each message has, -1 for none, the layouts, and why there is none.

    One message is read, and those that begin like it have its layout. Where new layouts
    keep coming, each message is read.
    """
    from mpap_cli.logs.files import _kernels  # noqa: PLC0415  # numba is slow to import

    skipped: Counter[str] = Counter()
    layouts: list[ScanLayout] = []
    kinds = np.full(len(run), -1)
    left = np.arange(len(run))
    while left.size:
        try:
            layout = locate_ranges(run.payload(left[0]), run.topic.encoding)
        except FieldError as err:
            skipped[str(err)] += 1
            left = left[1:]
            continue
        kinds[left[0]] = len(layouts)
        layouts.append(layout)
        if len(layouts) > _MAX_COMPARED:
            left = left[1:]
            continue
        least = layout.place + _FLOAT_BYTES * layout.geometry.n_beams
        mask = _mask(layout.place, run.topic.encoding)
        alike = _kernels.find_alike(run.records, run.starts[left], run.sizes[left], least, mask)
        kinds[left[alike]] = len(layouts) - 1
        left = left[~alike]
    return kinds, layouts, skipped


def _mask(size: int, encoding: str) -> NDArray[np.uint8]:
    """Mark the bytes before the ranges that must be equal for the same layout and geometry."""
    mask = np.full(size, 255, np.uint8)
    mask[_STAMP] = mask[_BETWEEN_SCANS] = 0
    if encoding == "ros1":
        mask[_SEQUENCE] = 0
    return mask


def _gather(records: bytes, places: IntArray, n_bytes: int) -> NDArray[np.uint8]:
    from mpap_cli.logs.files import _kernels  # noqa: PLC0415  # numba is slow to import

    return _kernels.gather(records, places, n_bytes)


def header_stamps(run: RawRun) -> tuple[IntArray, BoolArray]:
    """Return the stamps inside messages that begin with std_msgs/Header.

    Parameters
    ----------
    run : RawRun
        Of encoding ``cdr`` or ``ros1``.

    Returns
    -------
    stamps_ns : ndarray of shape (n,)
        Nanoseconds.
    readable : ndarray of shape (n,)
        False where the payload is shorter than a header, or no plain CDR.
    """
    readable = run.sizes >= _HEAD_BYTES
    stamps_ns = np.zeros(len(run), np.int64)
    heads = _gather(run.records, run.starts[readable], _STAMP.stop)
    words = heads[:, _STAMP].copy().view("<u4")
    if run.topic.encoding == "cdr":
        big = np.isin(heads[:, 1], _BIG)
        words[big] = words[big].byteswap()
        readable[readable] = np.isin(heads[:, 1], list(CDR_BYTE_ORDERS))
    seconds, nanoseconds = words.astype(np.int64).T
    stamps_ns[run.sizes >= _HEAD_BYTES] = seconds * NS_PER_S + nanoseconds
    return stamps_ns, readable


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
