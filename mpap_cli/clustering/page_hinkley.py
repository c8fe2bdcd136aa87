"""Tests of Page and Hinkley: has the share of outliers risen? (section 3.3)."""

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array


class PageHinkley:
    """Watches a stream of zeros and ones for a rise of its mean.

    Parameters
    ----------
    delta : float
        Rise of the share that is tolerated.
    threshold : float
        Sum of rises above it that is an alarm (lambda).
    mean : float, optional
        What a rise is counted from; None: the mean of the stream so far.

    Notes
    -----
    m_t = sum of (x - mean - delta); an alarm is m_t - min m > threshold, where m_0 = 0 counts
    too. STRAP's own statistic is another one; the paper names none. With a given mean that is
    Page's test: there is an alarm once some stretch of n values up to now sums up to more than
    threshold + (mean + delta) n.

    Examples
    --------
    >>> watch = PageHinkley(delta=0.0, threshold=1.0)
    >>> watch.add(np.zeros(50, np.bool_))
    >>> watch.first_alarm(np.ones(5, np.bool_))
    2
    """

    def __init__(self, delta: float, threshold: float, mean: float | None = None) -> None:
        self._delta = delta
        self._threshold = threshold
        self._mean = mean
        self.reset()

    def reset(self) -> None:
        """Forget the stream."""
        self.state = np.zeros(4)

    @property
    def state(self) -> Float64Array:
        """Length and sum of the stream, m_t and its minimum (4,)."""
        return self._state.copy()

    @state.setter
    def state(self, values: Float64Array) -> None:
        self._state = np.array(values, np.float64)

    def first_alarm(self, values: BoolArray) -> int | None:
        """Return at how many of the next values there is an alarm first; None: at none."""
        m, least = self._followed(values)[2:]
        alarms = np.flatnonzero(m - least > self._threshold)
        return int(alarms[0]) + 1 if alarms.size else None

    def add(self, values: BoolArray) -> None:
        """Take in the next values."""
        if values.size:
            self._state = np.array([column[-1] for column in self._followed(values)])

    def _followed(
        self, values: BoolArray
    ) -> tuple[Float64Array, Float64Array, Float64Array, Float64Array]:
        """Return the state after each of the values; sums run from first to last."""
        n, total, m, least = self._state
        lengths = n + np.arange(1.0, values.size + 1)
        totals = total + np.cumsum(values)
        means = totals / lengths if self._mean is None else self._mean
        rises = values - means - self._delta
        followed = np.cumsum(np.concatenate([[m], rises]))[1:]
        minima = np.minimum.accumulate(np.concatenate([[least], followed]))[1:]
        return lengths, totals, followed, minima
