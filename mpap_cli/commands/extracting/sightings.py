"""What was seen in each cell of time while a model learnt logs, and how much of it was new."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.commands.inputs.meeting import Met
from mpap_cli.evaluation.coverage import Sightings
from mpap_cli.evaluation.keeping import Moment
from mpap_cli.observations import BoolArray, Float32Array, Float64Array, IntArray
from mpap_cli.params import MetaPointParams

_MOST_ROWS = 1 << 20
_SHOWN = 2


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """Sightings of n_places; ``ids`` (n_places,) are those of what took each in last.

    ``exemplars`` (n_places, d) are the first observations there; all zero where such a one
    is forgotten.
    """

    sightings: Sightings
    ids: IntArray
    exemplars: Float32Array

    def shown_in(self, cells: BoolArray) -> Float32Array:
        """Return what some of the cells (n,) show, (m, d) in their order, at most twice each."""
        rows = np.repeat(cells, np.diff(self.sightings.starts))
        times = np.minimum(self.sightings.counts[rows], _SHOWN)
        shown = self.exemplars[np.repeat(self.sightings.places[rows], times)]
        kept: Float32Array = shown[shown.any(axis=1)]
        return kept


class SightingsLog:
    """Gathers sightings; memory grows with what is seen anew in each second.

    Parameters
    ----------
    cell_ns : int
        So long is a stretch that is kept or not as a whole.
    radius : float
        Observations so near to the first one of a place are seen there.
    """

    def __init__(self, cell_ns: int, radius: float) -> None:
        self._cell_ns = cell_ns
        self._radius = radius
        self._places: MetaPoints | None = None
        self._ids = np.zeros(0, np.int64)
        self._rows: list[IntArray] = [np.zeros((3, 0), np.int64)]
        self._n_rows, self._limit = 0, _MOST_ROWS
        self._first_ns: list[int] = []
        self._first_cell: list[int] = []
        self._lengths: list[IntArray] = []
        self._n_observed: list[Float64Array] = []
        self._n_novel: list[Float64Array] = []

    def begin_log(self, first_ns: int, behind_ns: int) -> None:
        """Begin the next log, of which that stretch counts."""
        starts = np.arange(first_ns, behind_ns, self._cell_ns)
        self._first_cell.append(sum(map(len, self._lengths)))
        self._first_ns.append(first_ns)
        self._lengths.append(np.diff(starts, append=behind_ns))
        self._n_observed.append(np.zeros(starts.size))
        self._n_novel.append(np.zeros(starts.size))

    def add(self, met: Met) -> None:
        """Count observations of the log that has begun."""
        n_cells = self._lengths[-1].size
        cells = np.clip((met.stamps_ns - self._first_ns[-1]) // self._cell_ns, 0, n_cells - 1)
        each = met.ids.shape[1]
        self._n_observed[-1] += np.bincount(cells, minlength=n_cells) * each
        self._n_novel[-1] += np.bincount(cells, met.novel.sum(axis=1), n_cells)
        of_each = np.repeat(cells + self._first_cell[-1], each)
        new = np.ones(of_each.size, np.bool_) if met.unknown is None else met.unknown.ravel()
        features = met.features.reshape(of_each.size, -1)[new]
        places = self._places_of(features, np.repeat(met.stamps_ns, each)[new])
        self._ids[places] = met.ids.ravel()[new]
        self._append(_counted(of_each[new], places))

    def _places_of(self, features: Float32Array, stamps_ns: IntArray) -> IntArray:
        """Return the places of observations; one that is near none makes a new one."""
        if self._places is None:
            params = MetaPointParams(theta=self._radius, reference="exemplar", min_points=2)
            self._places = MetaPoints(params, features.shape[1])
        places, _ = self._places.add_data_points(features, stamps_ns)
        missing = places.max(initial=-1) + 1 - self._ids.size
        if missing > 0:
            more = max(int(missing), self._ids.size)
            self._ids = np.concatenate([self._ids, np.full(more, -1, np.int64)])
        return places

    def _append(self, rows: IntArray) -> None:
        """Keep rows (3, n) of cell, id and count; where there are many, join those of one thing."""
        self._rows.append(rows)
        self._n_rows += rows.shape[1]
        if self._n_rows > self._limit:
            self._rows = [self._joined()]
            self._n_rows = self._rows[0].shape[1]
            self._limit = max(_MOST_ROWS, 2 * self._n_rows)

    def _joined(self) -> IntArray:
        """Return one row for each thing that was seen in a cell."""
        cells, ids, counts = np.concatenate(self._rows, axis=1)
        return _counted(cells, ids, counts)

    def seen(self) -> "Seen":
        """Return what was seen that was not known before."""
        cells, ids, counts = self._joined()
        known, places = np.unique(ids, return_inverse=True)
        lengths = np.concatenate(self._lengths)
        logs = np.repeat(np.arange(len(self._lengths)), [len(part) for part in self._lengths])
        starts = np.searchsorted(cells, np.arange(lengths.size + 1))
        sightings = Sightings(starts, places.astype(np.int64), counts, logs, lengths)
        if self._places is None:
            return Seen(sightings, known, np.zeros((0, 0), np.float32))
        rows = self._places.rows_of(known)
        exemplars = np.where(rows[:, None] >= 0, self._places.exemplars[rows], np.float32(0))
        return Seen(sightings, self._ids[known], exemplars)

    def novel_moments(self, share: float) -> list[Moment]:
        """Return the cells of which at least that share was new as it came."""
        moments = []
        parts = zip(self._first_ns, self._lengths, self._n_novel, self._n_observed, strict=True)
        for index, (first_ns, lengths, n_novel, n_observed) in enumerate(parts):
            shares = n_novel / np.maximum(n_observed, 1)
            for cell in np.flatnonzero((shares >= share) & (n_novel > 0)).tolist():
                start_ns = first_ns + cell * self._cell_ns
                end_ns = start_ns + int(lengths[cell])
                moments.append(Moment(index, start_ns, end_ns, float(shares[cell])))
        return moments

    def bounds_of(self, log_index: int, first: int, behind: int) -> tuple[int, int]:
        """Return where cells of a log begin and end; they count over all logs."""
        start_ns = self._first_ns[log_index] + (first - self._first_cell[log_index]) * self._cell_ns
        length_ns = self._lengths[log_index][
            first - self._first_cell[log_index] : behind - self._first_cell[log_index]
        ].sum()
        return start_ns, start_ns + int(length_ns)


def _counted(cells: IntArray, ids: IntArray, counts: IntArray | None = None) -> IntArray:
    """Count how often each id is in each cell: (3, n), ascending."""
    if not cells.size:
        return np.zeros((3, 0), np.int64)
    order = np.lexsort((ids, cells))
    cells, ids = cells[order], ids[order]
    counts = np.ones(cells.size, np.int64) if counts is None else counts[order]
    first = np.concatenate([[True], (cells[1:] != cells[:-1]) | (ids[1:] != ids[:-1])])
    starts = np.flatnonzero(first)
    return np.stack([cells[starts], ids[starts], np.add.reduceat(counts, starts)])
