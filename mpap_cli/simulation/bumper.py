"""A bumper ring of three switches that is not always right: late, stuck or silent."""

import heapq
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation.robot import STEP_NS, Contact

_LEFT_FROM_RAD = 0.35
_BOTH_WITHIN_RAD = 0.12
_SHORTEST_S = 0.15


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """Shares of contacts that the bumper tells late, holds on to, or misses."""

    late: float = 0.12
    held: float = 0.08
    missed: float = 0.05


@dataclass(frozen=True, slots=True, order=True)
class SwitchChange:
    """One switch closes or opens."""

    stamp_ns: int
    sensor: str
    pressed: bool


class Bumper:
    """Turns contacts into switch changes.

    Parameters
    ----------
    start_ns : int
        Stamp of step 0.
    seed : int
        Of delays and faults.
    faults : Faults
        How often it is wrong.
    """

    def __init__(self, start_ns: int, seed: int, faults: Faults) -> None:
        self._start_ns = start_ns
        self._faults = faults
        self._rng = np.random.default_rng((seed, 4))
        self._edges: list[tuple[int, int, str]] = []
        self._closed: dict[str, int] = {}

    def touch(self, contact: Contact) -> None:
        """Take up a contact; its changes come out of ``changes`` in time."""
        # a fixed number of draws, so that one contact's fate does not change the next one's
        fate, delay, release, extra, second = self._rng.random(5)
        faults = self._faults
        start_s, end_s = delay * 0.03, release * 0.08
        if fate < faults.missed:
            return
        if fate < faults.missed + faults.late:
            start_s = 0.1 + 0.5 * delay
        elif fate < faults.missed + faults.late + faults.held:
            end_s += 1.5 + 4.5 * extra
        start_ns = self._start_ns + contact.start_step * STEP_NS + _in_ns(start_s)
        end_ns = self._start_ns + contact.end_step * STEP_NS + _in_ns(end_s)
        end_ns = max(end_ns, start_ns + _in_ns(_SHORTEST_S))
        first, other = _sensors(contact.bearing_rad)
        self._press(first, start_ns, end_ns)
        if other is not None:
            later = _in_ns(0.03 + 0.09 * second)
            self._press(other, start_ns + later, end_ns + later // 2)

    def changes(self, until_ns: int) -> list[SwitchChange]:
        """Return the changes before a moment that were not returned yet, in time order."""
        changes = []
        while self._edges and self._edges[0][0] < until_ns:
            stamp_ns, step, sensor = heapq.heappop(self._edges)
            before = self._closed.get(sensor, 0)
            self._closed[sensor] = before + step
            if (before > 0) != (before + step > 0):
                changes.append(SwitchChange(stamp_ns, sensor, before + step > 0))
        return changes

    def _press(self, sensor: str, start_ns: int, end_ns: int) -> None:
        heapq.heappush(self._edges, (start_ns, 1, sensor))
        heapq.heappush(self._edges, (end_ns, -1, sensor))


def _sensors(bearing_rad: float) -> tuple[str, str | None]:
    """Return the switch that closes first and, near the edge of two, the other."""
    side = "left" if bearing_rad > 0 else "right"
    off = abs(bearing_rad) - _LEFT_FROM_RAD
    first, other = (side, "center") if off > 0 else ("center", side)
    return first, other if abs(off) < _BOTH_WITHIN_RAD else None


def _in_ns(seconds: float) -> int:
    return round(seconds * NS_PER_S)
