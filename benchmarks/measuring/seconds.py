"""CPU time that keeps the time on the clock beside it."""

from typing import Self


class Seconds(float):
    """A CPU time, or what was made of one by a factor or a sum; ``clock`` goes along.

    Examples
    --------
    >>> taken = 1000 * Seconds(0.5, 0.75) / 2
    >>> taken, taken.clock
    (250.0, 375.0)
    """

    __slots__ = ("clock",)
    clock: float

    def __new__(cls, cpu: float, clock: float) -> Self:
        """Make one of both times."""
        made = super().__new__(cls, cpu)
        made.clock = clock
        return made

    def __mul__(self, factor: float) -> "Seconds":
        """Return so many times both."""
        return Seconds(float(self) * factor, self.clock * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: float) -> "Seconds":
        """Return both by a divisor."""
        return Seconds(float(self) / divisor, self.clock / divisor)

    def __add__(self, other: float) -> "Seconds":
        """Return the sums; what has no clock counts alike on both."""
        clock = other.clock if isinstance(other, Seconds) else other
        return Seconds(float(self) + float(other), self.clock + clock)

    __radd__ = __add__
