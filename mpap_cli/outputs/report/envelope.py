"""A long curve thinned to as many stretches as a screen can show, block by block."""

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array

MOST_STRETCHES = 4096
_FIRST_WIDTH_S = 0.02


class Envelope:
    """The highest value of each stretch of time, and which flags were up in it.

    Stretches become twice as wide when there are more than 4,096 of them, so memory stays flat.

    Parameters
    ----------
    name : str
        What the curve is of.
    n_flags : int
        Flags beside each value.

    Examples
    --------
    >>> envelope = Envelope("log", n_flags=1)
    >>> envelope.add(np.array([0.0, 1.0]), np.array([0.5, 0.25]), np.array([[True], [False]]))
    >>> times, highest, flags = envelope.curve()
    >>> highest.tolist(), flags[:, 0].tolist()
    ([0.5, 0.25], [True, False])
    """

    def __init__(self, name: str, n_flags: int) -> None:
        self.name = name
        self.width_s = _FIRST_WIDTH_S
        self._highest: dict[int, float] = {}
        self._flags: dict[int, BoolArray] = {}
        self._none = np.zeros(n_flags, dtype=bool)

    def add(self, times_s: Float64Array, values: Float64Array, flags: BoolArray) -> None:
        """Add values (n,), NaN where there is none, and flags (n, n_flags) at times (n,)."""
        while float(np.ptp(times_s)) > self.width_s * MOST_STRETCHES:
            self._widen()
        places = np.floor(times_s / self.width_s).astype(np.int64)
        order = np.argsort(places, kind="stable")
        found, starts = np.unique(places[order], return_index=True)
        highest = np.fmax.reduceat(values[order], starts)
        raised = np.logical_or.reduceat(flags[order], starts, axis=0)
        for place, value, up in zip(found.tolist(), highest.tolist(), raised, strict=True):
            self._note(place, value, up)
        while len(self._highest) > MOST_STRETCHES:
            self._widen()

    def _note(self, place: int, value: float, up: BoolArray) -> None:
        self._highest[place] = float(np.fmax(self._highest.get(place, np.nan), value))
        self._flags[place] = self._flags.get(place, self._none) | up

    def _widen(self) -> None:
        """Join neighbors two by two."""
        highest, flags = self._highest, self._flags
        self.width_s *= 2
        self._highest, self._flags = {}, {}
        for place, value in highest.items():
            self._note(place // 2, value, flags[place])

    def curve(self) -> tuple[Float64Array, Float64Array, BoolArray]:
        """Return starts (k,) of the stretches in seconds, highest values (k,), flags."""
        places = sorted(self._highest)
        times = np.array(places, dtype=np.float64) * self.width_s
        highest = np.array([self._highest[place] for place in places])
        return times, highest, np.array([self._flags[place] for place in places])

    def spans(self, raised: BoolArray) -> list[tuple[float, float]]:
        """Return from when to when a flag (k,) of :meth:`curve` was up, in seconds."""
        times, _, _ = self.curve()
        edges = np.flatnonzero(np.diff(np.concatenate(([False], raised, [False])).astype(np.int8)))
        return [
            (round(float(times[first]), 3), round(float(times[last - 1] + self.width_s), 3))
            for first, last in edges.reshape(-1, 2)
        ]
