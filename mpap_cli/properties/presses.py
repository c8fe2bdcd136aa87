"""From bumper states to presses: half-open intervals of contact (sections 2.3 and 4.1)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.observations import NS_PER_S, Batch, BoolArray, Bump, Press, ScanBlock
from mpap_cli.params import BumperParams

BUMP_KINDS = ("level", "edge", "pulse")


@dataclass(slots=True)
class _OpenPress:
    """A press that is still on."""

    start_ns: int
    held_from_start: bool
    last_touch_ns: int


class PressTracker:
    """Turns the states of the bumper sensors of one log into presses.

    Parameters
    ----------
    kind : str
        ``level``: every message carries the whole state of its sensor; ``edge``: one
        message per change of one sensor; ``pulse``: a message exists only while
        touching, and a touch lasts ``hold_s``.
    params : BumperParams
        ``bump_merge``, ``bump_max_press`` and, for ``pulse``, ``bump_hold``.
    hold_s : float, optional
        Seconds a touch of this topic lasts (none: ``params.bump_hold``).

    Notes
    -----
    The bumper is pressed while any sensor is; a sensor is free before its first
    message. A press is [first pressed stamp, first free stamp). What lasts no time is
    nothing: a press that is released at its own stamp is not kept, and a release with
    the next press at the same stamp does not part two presses. Only the first press of
    a log can be held from its start, and only if the first message of a level sensor
    begins it, however late that comes and whatever other sensors said before: they know
    nothing of this one. An edge is the beginning itself.

    A press longer than ``bump_max_press`` is cut there, before presses are joined. Edge
    sensors that were on count as free from then on, since their release got lost;
    a level that stays on, or touches that go on, are no new press.

    Examples
    --------
    >>> tracker = PressTracker("edge", BumperParams())
    >>> tracker.add([Bump(5, "left", True), Bump(7, "right", True), Bump(8, "left", False)])
    >>> tracker.end(20)
    >>> tracker.presses
    (Press(start_ns=5, end_ns=21, held_from_start=False, released=False),)
    """

    def __init__(self, kind: str, params: BumperParams, hold_s: float | None = None) -> None:
        if kind not in BUMP_KINDS:
            msg = f"kind of bumper: found {kind}, expected one of {', '.join(BUMP_KINDS)}"
            raise ValueError(msg)
        longest = params.bump_max_press
        self._kind = kind
        self._merge_ns = _ns(params.bump_merge)
        self._max_ns = None if longest is None else _ns(longest)
        self._hold_ns = _ns(params.bump_hold if hold_s is None else hold_s)
        self._sensors: dict[str, bool] = {}
        self._open: _OpenPress | None = None
        self._closed: list[Press] = []
        self._until_ns = 0

    def add(self, bumps: Sequence[Bump]) -> None:
        """Take in states in time order, all later than those of the call before.

        Parameters
        ----------
        bumps : sequence of Bump
            Of a level or edge topic at least the first state of each sensor and every
            change; of a pulse topic every touch. States that repeat do no harm.
        """
        for bump in bumps:
            self._until_ns = bump.stamp_ns
            if self._kind != "pulse":
                self._change(bump)
            elif bump.pressed:
                self._touch(bump.stamp_ns)

    def settle(self, until_ns: int) -> None:
        """Note that no bump stamped at or before ``until_ns`` is still to come."""
        self._until_ns = max(until_ns, self._until_ns)

    def end(self, end_ns: int) -> None:
        """Close the log, whose last message is stamped ``end_ns``.

        A press that is still on ends one nanosecond later and is not released.
        """
        self._until_ns = end_ns
        if self._open is not None:
            self._join(self._closed, self._as_press(self._open))
            self._open = None

    @property
    def presses(self) -> tuple[Press, ...]:
        """All presses so far; before :meth:`end` the last one may still grow."""
        return self.recent(None)

    def recent(self, from_ns: int | None) -> tuple[Press, ...]:
        """Return the presses that last beyond ``from_ns`` (none: all), in time order."""
        first = len(self._closed)
        while first > 0 and (from_ns is None or self._closed[first - 1].end_ns > from_ns):
            first -= 1
        found = self._closed[first:]
        if self._open is not None:
            self._join(found, self._as_press(self._open))
        return tuple(found)

    def _change(self, bump: Bump) -> None:
        """Take in the state of one sensor of a level or edge topic."""
        first = bump.sensor not in self._sensors
        self._forget_lost_release(bump.stamp_ns)
        self._sensors[bump.sensor] = bump.pressed
        pressed = any(self._sensors.values())
        if pressed and self._open is None:
            held = first and self._kind == "level" and not self._closed
            self._open = _OpenPress(bump.stamp_ns, held, bump.stamp_ns)
        elif not pressed and self._open is not None:
            self._finish(self._open, bump.stamp_ns)

    def _touch(self, stamp_ns: int) -> None:
        """Take in one touch of a pulse topic."""
        if self._open is not None:
            if stamp_ns <= self._open.last_touch_ns + self._hold_ns:
                self._open.last_touch_ns = stamp_ns
                return
            self._finish(self._open, self._open.last_touch_ns + self._hold_ns)
        self._open = _OpenPress(stamp_ns, held_from_start=False, last_touch_ns=stamp_ns)

    def _forget_lost_release(self, stamp_ns: int) -> None:
        """Free all edge sensors once the press that they keep up has become too long."""
        if self._kind != "edge" or self._open is None or self._max_ns is None:
            return
        latest_ns = self._open.start_ns + self._max_ns
        if stamp_ns >= latest_ns:
            self._sensors = dict.fromkeys(self._sensors, False)
            self._finish(self._open, latest_ns)

    def _finish(self, open_press: _OpenPress, end_ns: int) -> None:
        """Close the open press at ``end_ns`` or at its longest."""
        self._join(self._closed, self._cut(open_press, end_ns))
        self._open = None

    def _join(self, presses: list[Press], press: Press) -> None:
        """Append a press, or lengthen the last closed one if it ended just before."""
        if press.end_ns <= press.start_ns:
            return
        last = self._closed[-1] if self._closed else None
        if last is not None and press.start_ns - last.end_ns < max(self._merge_ns, 1):
            presses[-1:] = [replace(last, end_ns=press.end_ns, released=press.released)]
        else:
            presses.append(press)

    def _cut(self, open_press: _OpenPress, end_ns: int) -> Press:
        """Return the press up to ``end_ns``, at most as long as ``bump_max_press``."""
        if self._max_ns is not None:
            end_ns = min(end_ns, open_press.start_ns + self._max_ns)
        return Press(open_press.start_ns, end_ns, open_press.held_from_start)

    def _as_press(self, open_press: _OpenPress) -> Press:
        """Return the open press as it is if the log ends now."""
        after_ns = max(self._until_ns, open_press.last_touch_ns) + 1
        over_ns = open_press.last_touch_ns + self._hold_ns
        if self._kind == "pulse" and over_ns <= after_ns:
            return self._cut(open_press, over_ns)
        press = self._cut(open_press, after_ns)
        return replace(press, released=press.end_ns < after_ns)


def _ns(seconds: float) -> int:
    return round(seconds * NS_PER_S)


def bumps_from_scans(
    block: ScanBlock, distance_m: float, range_max: float | None = None
) -> tuple[Bump, ...]:
    """Make bumps out of near scans (a "simulated bump", section 5.3.1).

    The bumper counts as pressed while the smallest valid range all round is below
    ``distance_m``; valid are ranges from ``range_min`` to ``range_max``.

    Parameters
    ----------
    block : ScanBlock
        Raw scans.
    distance_m : float
        Metres from the scanner, above zero.
    range_max : float, optional
        Metres; replaces the largest range that the messages state.

    Returns
    -------
    tuple of Bump
        Of one level sensor: its state at the first scan and every change after it.

    Examples
    --------
    >>> from mpap_cli.observations import ScanGeometry
    >>> geometry = ScanGeometry(2, 0.0, 0.1, range_min=0.02, range_max=5.0)
    >>> ranges = np.array([[0.0, 3.0], [0.2, 3.0], [0.1, 0.2]], dtype=np.float32)
    >>> block = ScanBlock(np.array([10, 20, 30]), ranges, geometry)
    >>> [(bump.stamp_ns, bump.pressed) for bump in bumps_from_scans(block, 0.25)]
    [(10, False), (20, True)]
    """
    largest = block.geometry.range_max if range_max is None else range_max
    valid = (block.ranges >= block.geometry.range_min) & (block.ranges <= largest)
    pressed: BoolArray = np.any(valid & (block.ranges < distance_m), axis=1)
    changed = np.ones(len(pressed), dtype=np.bool_)
    changed[1:] = pressed[1:] != pressed[:-1]
    return tuple(
        Bump(int(block.stamps_ns[row]), "", bool(pressed[row])) for row in np.flatnonzero(changed)
    )


def with_virtual_bumps(batch: Batch, distance_m: float, range_max: float | None = None) -> Batch:
    """Return the batch with the bumps of its near scans in place of its own."""
    bumps = [
        bump for block in batch.scans for bump in bumps_from_scans(block, distance_m, range_max)
    ]
    return replace(batch, bumps=tuple(bumps))
