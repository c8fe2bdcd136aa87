"""What looks back in time: minimum over the last second, approach of what is ahead.

Both go by stamps, not by numbers of scans, and keep what they need across blocks: a stream
gives the same values however it is cut.
"""

import numpy as np

from mpap_cli.features.scans.rows import _kernels
from mpap_cli.observations import NS_PER_S, Float32Array, Float64Array, IntArray

# Longer than any log, and still far from overflow when it is taken off a stamp.
_LONGEST_NS = 2**62


def to_ns(seconds: float) -> int:
    """Return a duration in nanoseconds.

    >>> to_ns(0.6)
    600000000
    """
    return round(min(seconds * NS_PER_S, _LONGEST_NS))


class SlidingMinimum:
    """Minimum of every column over the last ``window_s`` seconds.

    The row itself counts, and so does a row exactly ``window_s`` old. Memory: the rows of
    one window.

    Parameters
    ----------
    window_s : float
        Seconds, zero or above.
    n_columns : int
        Number of values in a row.

    Examples
    --------
    >>> window = SlidingMinimum(1.0, 1)
    >>> rows = np.array([[1.0], [3.0], [2.0]])
    >>> window.push(np.array([0, 10**9, 3 * 10**9]), rows).ravel().tolist()
    [1.0, 1.0, 2.0]
    """

    def __init__(self, window_s: float, n_columns: int) -> None:
        self._window_ns = to_ns(window_s)
        self._stamps_ns: IntArray = np.empty(0, np.int64)
        self._values: Float64Array = np.empty((0, n_columns), np.float64)

    def push(self, stamps_ns: IntArray, values: Float64Array) -> Float64Array:
        """Return the minima (n, n_columns) of the next rows (n, n_columns) of the stream.

        ``stamps_ns`` (n,) do not decrease, also from call to call.
        """
        n_before = self._stamps_ns.size
        stamps = np.concatenate([self._stamps_ns, stamps_ns])
        rows = np.concatenate([self._values, values])
        minima = _kernels.window_minimum(stamps, rows, n_before, self._window_ns)
        if stamps.size:
            start = np.searchsorted(stamps, stamps[-1] - self._window_ns)
            self._stamps_ns, self._values = stamps[start:].copy(), rows[start:].copy()
        return minima


class ChangeOverTime:
    """Change of a value against the one ``span_s`` seconds ago.

    Compared is the value whose stamp is nearest to ``span_s`` before (the older of two as
    near). The value itself takes part in that choice: at the start of a stream, and
    behind a gap longer than twice the span, there is nothing to compare with and the
    change is 0.

    Parameters
    ----------
    span_s : float
        Seconds, above zero.

    Examples
    --------
    >>> change = ChangeOverTime(1.0)
    >>> change.push(np.array([0, 10**9, 2 * 10**9]), np.array([4.0, 3.0, 3.5])).tolist()
    [0.0, -1.0, 0.5]
    """

    def __init__(self, span_s: float) -> None:
        self._span_ns = to_ns(span_s)
        self._stamps_ns: IntArray = np.empty(0, np.int64)
        self._values: Float64Array = np.empty(0, np.float64)

    def push(self, stamps_ns: IntArray, values: Float32Array | Float64Array) -> Float64Array:
        """Return the changes (n,) of the next values (n,) of the stream.

        ``stamps_ns`` (n,) do not decrease, also from call to call.
        """
        n_before = self._stamps_ns.size
        stamps = np.concatenate([self._stamps_ns, stamps_ns])
        rows = np.concatenate([self._values, values.astype(np.float64)])
        targets = stamps_ns - self._span_ns
        later = np.searchsorted(stamps, targets, side="left")
        earlier = np.maximum(later - 1, 0)
        takes_earlier = np.abs(targets - stamps[earlier]) <= np.abs(stamps[later] - targets)
        changes = rows[n_before:] - rows[np.where(takes_earlier, earlier, later)]
        if stamps.size:
            # The row before the span may be the nearest one to a later target.
            start = max(int(np.searchsorted(stamps, stamps[-1] - self._span_ns)) - 1, 0)
            self._stamps_ns, self._values = stamps[start:].copy(), rows[start:].copy()
        return np.asarray(changes, np.float64)
