"""What became of ids that were given out: clusters merge, outliers join clusters."""

import numpy as np

from mpap_cli.observations import IntArray

_SMALLEST_CAPACITY = 1024


class Lineage:
    """Follows ids through rebuilds; 8 bytes for each id ever given out.

    Parameters
    ----------
    living : ndarray of shape (n,)
        Ids that are in use already, ascending.
    next_id : int
        The id that is given out next; above all of these.

    Examples
    --------
    >>> lineage = Lineage()
    >>> lineage.issue(3).tolist()
    [0, 1, 2]
    >>> lineage.replace(np.array([1, 2]), np.array([0, 0]))
    >>> lineage.current(np.array([2, 0, 7])).tolist()
    [0, 0, -1]
    """

    def __init__(self, living: IntArray | None = None, next_id: int = 0) -> None:
        self._living = np.zeros(0, np.int64) if living is None else living.copy()
        self.next_id = next_id
        self._first_issued = next_id
        # places of ids: first those that were living at the start, then those given out
        self._n_places = len(self._living)
        self._heirs = np.arange(self._n_places)

    def issue(self, n: int) -> IntArray:
        """Give out n new ids."""
        needed = self._n_places + n
        if needed > len(self._heirs):
            grown = np.arange(max(2 * needed, _SMALLEST_CAPACITY))
            grown[: self._n_places] = self._heirs[: self._n_places]
            self._heirs = grown
        first = self.next_id
        self.next_id += n
        self._n_places = needed
        return np.arange(first, self.next_id)

    def replace(self, ids: IntArray, heirs: IntArray) -> None:
        """Let known ids (n,) be replaced by other known ones (n,)."""
        self._heirs[self._places(ids)] = self._places(heirs)

    def current(self, ids: IntArray) -> IntArray:
        """Return what stands for these ids now, -1 for ids that are not known."""
        given = np.asarray(ids, np.int64)
        places = self._places(given)
        known = places >= 0
        found = places[known]
        while True:
            heirs = self._heirs[found]
            if np.array_equal(heirs, found):
                break
            found = heirs
        out = np.full(given.shape, -1, np.int64)
        n_living = len(self._living)
        after = found >= n_living
        now = found + (self._first_issued - n_living)
        now[~after] = self._living[found[~after]]
        out[known] = now
        return out

    def _places(self, ids: IntArray) -> IntArray:
        """Return the places of ids, -1 for those that are not known."""
        n_living = len(self._living)
        places = ids - self._first_issued + n_living
        old = ids < self._first_issued
        if old.any():
            found = np.searchsorted(self._living, ids[old])
            there = found < n_living
            there[there] = self._living[found[there]] == ids[old][there]
            places[old] = np.where(there, found, -1)
        return np.where(places < self._n_places, places, -1)
