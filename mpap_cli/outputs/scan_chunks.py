"""Many blocks of scans as three arrays, whatever their geometries, and back."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from mpap_cli.observations import Float32Array, Float64Array, IntArray, ScanBlock, ScanGeometry

_RUN_COLUMNS = 7


@dataclass(frozen=True, slots=True, eq=False)
class ScanChunk:
    """Blocks one after the other.

    ``stamps_ns`` (n,) int64 and ``ranges`` (sum of beams,) float32 of all scans; ``runs``
    (blocks, 7) float64: scans, beams, angle_min, angle_increment, range_min, range_max and
    the index of the frame_id, which together say how to cut the other two.
    """

    stamps_ns: IntArray
    ranges: Float32Array
    runs: Float64Array


class ChunkParts(NamedTuple):
    """The arrays of a chunk, each in pieces that follow one another."""

    stamps_ns: list[IntArray]
    ranges: list[Float32Array]
    runs: list[Float64Array]


class ChunkPacker:
    """Collects blocks until there are enough for a chunk.

    ``frames`` lists the frame_ids met so far; ``n_bytes`` is what waits.
    """

    def __init__(self) -> None:
        self.frames: list[str] = []
        self.n_bytes = 0
        self._stamps: list[IntArray] = []
        self._ranges: list[Float32Array] = []
        self._runs: list[tuple[float, ...]] = []

    def add(self, block: ScanBlock) -> None:
        """Copy a block; one without scans leaves no trace."""
        if block.stamps_ns.size == 0:
            return
        geometry = block.geometry
        if geometry.frame_id not in self.frames:
            self.frames.append(geometry.frame_id)
        self._stamps.append(block.stamps_ns.astype(np.int64))
        self._ranges.append(block.ranges.astype(np.float32, order="C").reshape(-1))
        self._runs.append(
            (
                block.stamps_ns.size,
                geometry.n_beams,
                geometry.angle_min,
                geometry.angle_increment,
                geometry.range_min,
                geometry.range_max,
                self.frames.index(geometry.frame_id),
            )
        )
        self.n_bytes += block.ranges.nbytes + block.stamps_ns.nbytes

    def take(self) -> ChunkParts:
        """Return what waits, and forget it; no arrays if nothing does."""
        runs = [np.array(self._runs, dtype=np.float64)] if self._runs else []
        parts = ChunkParts(self._stamps, self._ranges, runs)
        self._stamps, self._ranges, self._runs = [], [], []
        self.n_bytes = 0
        return parts


def make_chunk(arrays: Sequence[NDArray[Any]], n_frames: int) -> ScanChunk:
    """Check arrays that come from a file, stamps_ns, ranges and runs.

    Raises
    ------
    ValueError
        If they have other types or shapes, do not fit each other, or go back in time
        within a block.
    """
    stamps_ns, ranges, runs = arrays
    types = [array.dtype.str for array in (stamps_ns, ranges, runs)]
    if types != ["<i8", "<f4", "<f8"] or (stamps_ns.ndim, ranges.ndim) != (1, 1):
        _reject("types")
    if runs.ndim != 2 or runs.shape[1] != _RUN_COLUMNS:  # noqa: PLR2004  # a table
        _reject("runs")
    n_scans, n_beams, frame = runs[:, 0], runs[:, 1], runs[:, 6]
    # compared as floats: what is larger than the arrays must not become an integer
    good = (
        ((n_scans >= 1) & (n_scans <= stamps_ns.size)).all()
        and ((n_beams >= 0) & (n_beams <= ranges.size)).all()
        and ((frame >= 0) & (frame < n_frames)).all()
        and np.isfinite(runs[:, 2:4]).all()
    )
    if not good:
        _reject("runs")
    if n_scans.sum() != stamps_ns.size or n_scans @ n_beams != ranges.size:
        _reject("sizes")
    back = np.flatnonzero(np.diff(stamps_ns) < 0) + 1
    if not np.isin(back, n_scans.cumsum()).all():
        _reject("stamps")
    return ScanChunk(stamps_ns, ranges, runs)


def _reject(what: str) -> NoReturn:
    msg = f"the {what} of a chunk of scans cannot be right"
    raise ValueError(msg)


def unpack(chunk: ScanChunk, frames: list[str]) -> Iterator[ScanBlock]:
    """Yield the blocks of a chunk, as they were added."""
    scan, value = 0, 0
    for run in chunk.runs.tolist():
        n_scans, n_beams = int(run[0]), int(run[1])
        geometry = ScanGeometry(
            n_beams, run[2], run[3], run[4], run[5], frame_id=frames[int(run[6])]
        )
        ranges = chunk.ranges[value : value + n_scans * n_beams].reshape(n_scans, n_beams)
        yield ScanBlock(chunk.stamps_ns[scan : scan + n_scans], ranges, geometry)
        scan += n_scans
        value += n_scans * n_beams
