"""When the clusters of STRAP are to be made anew (section 3.3)."""

import numpy as np

from mpap_cli.clustering.page_hinkley import PageHinkley
from mpap_cli.observations import BoolArray, Float64Array
from mpap_cli.params import StrapParams


class Restarts:
    """Watches which points are outliers, for the point at which a rebuild is due.

    Parameters
    ----------
    strap : StrapParams
        Settings.

    Notes
    -----
    A rebuild is due as soon as there were more than R = ``reservoir`` outliers since the last
    one. If that does not come within R / ``known_share`` points, the place is known: from
    then on a rebuild is due only at the end of a stretch of n points, all of them since then,
    with more than R + ``noise_share`` n outliers among them. So a known place no stretch of
    which holds more adds no exemplar, however long the stream is, whatever its outliers are;
    and where a share p above ``noise_share`` is new, the next R / (p - ``noise_share``) points
    or so call for a rebuild, and the place is learnt as the first one was. How soon a place
    is known, and whether at all, lies in the stream. ``known_share`` 0: no place is ever
    known (STRAP as published). An option adds the test of Page and Hinkley.

    Examples
    --------
    >>> restarts = Restarts(StrapParams(reservoir=2, known_share=0.3, noise_share=0.35))
    >>> one_in_five = np.arange(100) % 5 == 0
    >>> restarts.take(one_in_five, n_waiting=0), restarts.is_due
    (100, False)
    >>> restarts.take(one_in_five | True, n_waiting=2), restarts.is_due
    (4, True)
    """

    def __init__(self, strap: StrapParams) -> None:
        self._strap = strap
        self.surplus = PageHinkley(strap.noise_share, strap.reservoir, mean=0.0)
        self.rises = PageHinkley(strap.page_hinkley_delta, strap.page_hinkley_lambda)
        self.reset()

    def reset(self) -> None:
        """Begin again, as after a rebuild."""
        self.is_due = False
        self.n_points = 0
        self.surplus.reset()
        self.rises.reset()

    def resume(self, n_points: int, surplus: Float64Array, rises: Float64Array) -> None:
        """Go on from the state of another one."""
        self.n_points = n_points
        self.surplus.state, self.rises.state = surplus, rises

    def take(self, is_outlier: BoolArray, n_waiting: int) -> int:
        """Take in the next points up to the one at which a rebuild is due.

        Parameters
        ----------
        is_outlier : ndarray of shape (m,)
            Which of them fit no cluster.
        n_waiting : int
            Outliers in the reservoir.

        Returns
        -------
        int
            How many were taken in; ``is_due`` tells whether a rebuild must come now.
        """
        n_learning = self._n_until_known(len(is_outlier))
        alarms = [self._overflow(is_outlier[:n_learning], n_waiting)]
        alarm = self.surplus.first_alarm(is_outlier[n_learning:])
        alarms.append(None if alarm is None else n_learning + alarm)
        if self._strap.page_hinkley:
            alarms.append(self.rises.first_alarm(is_outlier))
        due = [alarm for alarm in alarms if alarm is not None]
        self.is_due = bool(due)
        n = min(due, default=len(is_outlier))
        self.surplus.add(is_outlier[n_learning:n])
        self.rises.add(is_outlier[:n])
        self.n_points += n
        return n

    def _n_until_known(self, most: int) -> int:
        """Return after how many more points the place is known, ``most`` or fewer."""
        if not self._strap.known_share:
            return most
        needed = int(self._strap.reservoir / self._strap.known_share) + 1
        return min(most, max(0, needed - self.n_points))

    def _overflow(self, is_outlier: BoolArray, n_waiting: int) -> int | None:
        """Return at how many of the next points there are too many outliers; None: at none."""
        outliers = np.flatnonzero(is_outlier)
        room = self._strap.reservoir - n_waiting
        return int(outliers[room]) + 1 if len(outliers) > room else None
