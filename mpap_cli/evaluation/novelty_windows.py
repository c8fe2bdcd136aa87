"""Counts of observations in windows of log time, the bins behind novelty.csv (section 5.3)."""

import numpy as np

from mpap_cli.observations import IntArray

# Columns of a table of bins.
BIN, OBSERVATIONS, NOVEL, UNKNOWN, CLUSTERS = range(5)


class LogCounts:
    """What was counted in one log, in bins as long as the step of the windows.

    ``bins`` are the rows of a table with the columns ``BIN`` (number of the bin, counted
    from the first observation), ``OBSERVATIONS``, ``NOVEL``, ``UNKNOWN`` and ``CLUSTERS``
    (-1: not counted); bins without observation are not there.
    """

    def __init__(self, name: str, start_ns: int) -> None:
        self.name = name
        self.start_ns = start_ns
        self.first_ns = 0
        self.latest_ns = 0
        self.has_unknown = True
        self.bins: list[list[int]] = []

    def times_of(self, stamps_ns: IntArray) -> IntArray:
        """Return the stamps (n,), none before an earlier one."""
        if not self.bins:
            self.first_ns = self.latest_ns = int(stamps_ns[0])
        times_ns = np.maximum.accumulate(np.maximum(stamps_ns, self.latest_ns))
        self.latest_ns = int(times_ns[-1])
        return np.asarray(times_ns, dtype=np.int64)

    def append(self, table: IntArray) -> None:
        """Add bins (m, 5), of which the first may be the last one there is."""
        for row in table.tolist():
            if self.bins and self.bins[-1][BIN] == row[BIN]:
                last = self.bins[-1]
                for column in (OBSERVATIONS, NOVEL, UNKNOWN):
                    last[column] += row[column]
                last[CLUSTERS] = row[CLUSTERS]
            else:
                self.bins.append(row)


def sum_windows(table: IntArray, width: int, step: int) -> IntArray:
    """Sum bins (m, 5) in windows of ``width`` bins that begin every ``step`` bins.

    Parameters
    ----------
    table : ndarray of shape (m, 5)
        Bins of one log, at least one, ascending.
    width, step : int
        In bins; ``step`` divides ``width``.

    Returns
    -------
    ndarray of shape (k, 5)
        The same columns: the first bin of a window, then its sums; the number of clusters
        is that of its last bin. Windows begin at bin 0, and the last one is the first
        that holds the last bin; those without an observation are left out.

    Examples
    --------
    >>> bins = np.array([[0, 36, 36, 0, 1], [2, 36, 0, 0, 3]])
    >>> sum_windows(bins, width=2, step=1).tolist()
    [[0, 36, 36, 0, 1], [1, 36, 0, 0, 3]]
    """
    bins = table[:, BIN]
    last_start = max(0, -((width - 1 - int(bins[-1])) // step))
    near = bins[:, None] // step - np.arange(width // step)
    starts = np.unique(near[(near >= 0) & (near <= last_start)]) * step
    first = np.searchsorted(bins, starts)
    after = np.searchsorted(bins, starts + width)
    sums = np.zeros((len(table) + 1, table.shape[1]), dtype=np.int64)
    np.cumsum(table, axis=0, out=sums[1:])
    found = sums[after] - sums[first]
    found[:, BIN] = starts
    found[:, CLUSTERS] = table[after - 1, CLUSTERS]
    return np.asarray(found, dtype=np.int64)
