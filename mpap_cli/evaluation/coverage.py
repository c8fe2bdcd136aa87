"""The few stretches of logs from which most of what is new in them can be learnt.

What a model makes of a stretch are the places that were seen in it: meta-points of scans,
exemplars of patches. A place is worth as many observations as it explains in all of the
logs, and it is learnt from the first of them; so the stretches are chosen greedily by what
they explain that no chosen one does, for each second that they cost.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array, IntArray

Explain = Callable[[BoolArray], BoolArray]

_ROUNDS = 10


@dataclass(frozen=True, slots=True, eq=False)
class Sightings:
    """What was seen in n cells of time, one log after the other.

    ``starts`` (n + 1,): the sightings of a cell are the rows between two of these;
    ``places`` (m,) tells what was seen, 0 up to below the number of places, each once a
    cell, and ``counts`` (m,) how often. ``log_index`` (n,) is the log of a cell,
    ``length_ns`` (n,) its length.
    """

    starts: IntArray
    places: IntArray
    counts: IntArray
    log_index: IntArray
    length_ns: IntArray

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return self.length_ns.size


@dataclass(frozen=True, slots=True, eq=False)
class Chosen:
    """What was chosen of n cells.

    ``kept`` (n,); ``gains`` (n,) is the share of all that is new which a cell added when it
    was chosen, and ``best`` (n,) the place that added most of it, -1 for none.
    """

    kept: BoolArray
    gains: Float64Array
    best: IntArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """How cells are chosen.

    ``before`` and ``after`` a chosen cell so many are kept within its log. Kept cells last
    ``budget_ns`` together. A cell teaches what it shows if the ``context`` cells before it
    are kept too, or the log begins there; a place is learnt after ``enough`` sightings.
    """

    before: int
    after: int
    budget_ns: int
    context: int
    enough: int


def choose_cells(
    sightings: Sightings, weight: Float64Array, asked: Asked, explain: Explain | None = None
) -> Chosen:
    """Choose cells with those about them, until nothing new fits into the budget.

    Parameters
    ----------
    sightings : Sightings
        Of n cells.
    weight : ndarray of shape (n_places,)
        How many observations each place explains; 0 for what was known before.
    asked : Asked
        Margins and budget.
    explain : callable, optional
        Tells which places a model explains (n_places,) that learnt from some of the cells
        (n,). It is asked after every tenth of the budget; without it a place is explained
        after enough sightings.

    Returns
    -------
    Chosen

    Notes
    -----
    What a cell adds only shrinks as others are chosen, and what it costs only changes
    beside them, so a value on the heap is made anew when it comes to the top. A model may
    still not explain a place that was seen, since what it learns lies elsewhere.
    """
    cover, spent_ns = _Cover(sightings, weight, asked), 0
    n_rounds = 1 if explain is None else _ROUNDS
    for number in range(1, n_rounds + 1):
        queue, round_ns = _Queue(cover, asked), asked.budget_ns * number // n_rounds
        while (cell := queue.best(asked.budget_ns - spent_ns)) is not None:
            window = cover.window(cell)
            spent_ns += cover.keep(window)
            if spent_ns >= round_ns:
                break
            queue.push_about(window)
        if explain is not None:
            cover.explain(explain)
    return cover.chosen


class _Cover:
    """What is kept, and what the kept cells explain."""

    def __init__(self, sightings: Sightings, weight: Float64Array, asked: Asked) -> None:
        n = sightings.n_cells
        self.chosen = Chosen(np.zeros(n, np.bool_), np.zeros(n), np.full(n, -1, np.int64))
        self._seen = sightings
        self._weight = weight
        self._total = max(float(weight.sum()), 1.0)
        self._asked = asked
        self._times = np.zeros(weight.size)
        self._taught = np.zeros(n, np.bool_)
        log_index, cells = sightings.log_index, np.arange(n)
        self._begin = np.searchsorted(log_index, log_index, side="left")
        end = np.searchsorted(log_index, log_index, side="right")
        self._first = np.maximum(cells - asked.before, self._begin)
        self._behind = np.minimum(cells + asked.after + 1, end)
        self._end = end

    def window(self, cell: int) -> range:
        """Return the cells that are kept together with one."""
        return range(self._first[cell], self._behind[cell])

    def value(self, cell: int) -> tuple[float, int]:
        """Return what the window of a cell adds for each nanosecond, and what it costs."""
        window = self.window(cell)
        cost_ns = self._cost_ns(window)
        return (self._gain(self._teaching(window)) / cost_ns if cost_ns else 0.0), cost_ns

    def keep(self, window: range) -> int:
        """Keep a window; return what it costs."""
        cost_ns, teaching = self._cost_ns(window), self._teaching(window)
        self.chosen.kept[window.start : window.stop] = True
        for cell in teaching.tolist():
            self._take(cell)
        return cost_ns

    def explain(self, explain: Explain) -> None:
        """Let a model tell what is explained, in place of the number of sightings."""
        self._times[:] = np.where(explain(self._taught), self._asked.enough, 0.0)

    def _cost_ns(self, window: range) -> int:
        part = slice(window.start, window.stop)
        return int(self._seen.length_ns[part][~self.chosen.kept[part]].sum())

    def _teaching(self, window: range) -> IntArray:
        """Return the cells that teach what they show once a window is kept, and did not before.

        What is shown in a cell depends on those before it, as far as features look back.
        """
        stop = min(window.stop + self._asked.context, int(self._end[window.start]))
        cells = np.arange(window.start, stop)
        low = max(window.start - self._asked.context, 0)
        kept = self.chosen.kept[low:stop].copy()
        kept[window.start - low : window.stop - low] = True
        teaches = kept[cells - low] & ~self._taught[cells]
        for back in range(1, self._asked.context + 1):
            earlier = cells - back
            teaches &= (earlier < self._begin[cells]) | kept[np.maximum(earlier - low, 0)]
        return cells[teaches]

    def _gain(self, cells: IntArray) -> float:
        """Return what cells add together."""
        rows = _rows(self._seen.starts, cells)
        if not rows.size:
            return 0.0
        places, inverse = np.unique(self._seen.places[rows], return_inverse=True)
        before = self._times[places]
        after = np.minimum(
            before + np.bincount(inverse, self._seen.counts[rows]), self._asked.enough
        )
        return float(self._weight[places] @ (after - before)) / self._asked.enough

    def _take(self, cell: int) -> None:
        """Count what a cell shows, and note what it added."""
        rows = slice(self._seen.starts[cell], self._seen.starts[cell + 1])
        places = self._seen.places[rows]
        before = self._times[places]
        self._times[places] = np.minimum(before + self._seen.counts[rows], self._asked.enough)
        gains = self._weight[places] * (self._times[places] - before) / self._asked.enough
        self._taught[cell] = True
        if gains.any():
            self.chosen.gains[cell] = gains.sum() / self._total
            self.chosen.best[cell] = places[gains.argmax()]


def _rows(starts: IntArray, cells: IntArray) -> IntArray:
    """Return the rows of some cells."""
    if not cells.size:
        return cells
    return np.concatenate([np.arange(starts[cell], starts[cell + 1]) for cell in cells.tolist()])


class _Queue:
    """Cells by what their windows add for each nanosecond that they cost."""

    def __init__(self, cover: _Cover, asked: Asked) -> None:
        self._cover = cover
        self._n_cells = cover.chosen.kept.size
        self._reach = asked.before + asked.after + asked.context + 1
        self._heap = [(-cover.value(cell)[0], cell) for cell in range(self._n_cells)]
        heapq.heapify(self._heap)

    def best(self, left_ns: int) -> int | None:
        """Take out the best cell that costs no more than is left; None if none adds anything."""
        while self._heap:
            _, cell = heapq.heappop(self._heap)
            value, cost_ns = self._cover.value(cell)
            if value <= 0 or cost_ns > left_ns:
                continue
            if self._heap and -value > self._heap[0][0]:
                heapq.heappush(self._heap, (-value, cell))
                continue
            return cell
        return None

    def push_about(self, window: range) -> None:
        """Value anew the cells whose windows a kept one has made cheaper, or worth more."""
        for cell in range(
            max(0, window.start - self._reach), min(self._n_cells, window.stop + self._reach)
        ):
            value, _ = self._cover.value(cell)
            if value > 0:
                heapq.heappush(self._heap, (-value, cell))
