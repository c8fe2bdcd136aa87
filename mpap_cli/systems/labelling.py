"""Labels of one log while it is replayed: presses, the queue, settled labels (Figure 1)."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Generic, Protocol, TypeVar

from mpap_cli.observations import Bump, Int8Array, ObservedLog, Press
from mpap_cli.params import BumperParams
from mpap_cli.properties.labels import NO_LABEL
from mpap_cli.properties.presses import PressTracker

_START, _END = attrgetter("start_ns"), attrgetter("end_ns")


@dataclass(frozen=True, slots=True)
class LogSource:
    """A log that a model has learnt from.

    ``n_observations`` are its scans or images; ``n_presses`` is None if it has no bumper.
    """

    name: str
    start_ns: int
    end_ns: int
    n_observations: int
    n_presses: int | None
    bump_source: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LogStart:
    """What is known of a log before it is replayed.

    ``name`` is its base name and ``start_ns`` the stamp of its first message;
    ``forward_rad`` and ``range_max`` go to the features. Labels come from bumps of
    ``bump_kind`` (level, edge, pulse; a touch of a pulse lasts ``hold_s``) or from
    ``presses`` that are known already; with neither there are none. ``bump_source``
    says in words where they come from.
    """

    name: str
    start_ns: int
    forward_rad: float = 0.0
    range_max: float | None = None
    bump_kind: str | None = None
    hold_s: float | None = None
    presses: tuple[Press, ...] | None = None
    bump_source: str = "none"

    @classmethod
    def of(cls, log: ObservedLog) -> "LogStart":
        """Return the start of a log whose presses are known already."""
        return cls(
            name=log.name,
            start_ns=log.start_ns,
            forward_rad=log.forward_rad,
            range_max=log.range_max,
            presses=log.presses,
            bump_source=log.bump_source,
        )

    def source(
        self, end_ns: int, n_observations: int, presses: tuple[Press, ...] | None
    ) -> LogSource:
        """Return what is remembered of the log when it has been learnt."""
        return LogSource(
            name=self.name,
            start_ns=self.start_ns,
            end_ns=end_ns,
            n_observations=n_observations,
            n_presses=None if presses is None else len(presses),
            bump_source=self.bump_source,
        )

    @property
    def has_labels(self) -> bool:
        """Whether anything tells of presses."""
        return self.bump_kind is not None or self.presses is not None


class _Settled(Protocol):
    """Observations with labels that do not change any more."""

    @property
    def labels(self) -> Int8Array: ...


SettledT_co = TypeVar("SettledT_co", bound=_Settled, covariant=True)


class WaitingLabels(Protocol[SettledT_co]):
    """Observations that wait until the presses around them are known."""

    @property
    def needs_presses_from_ns(self) -> int | None:
        """Presses that end at or before this stamp do not matter (None: none does)."""

    def settle(self, presses: Sequence[Press], until_ns: int) -> SettledT_co:
        """Let go what does not change by anything after ``until_ns``."""

    def end(self, presses: Sequence[Press]) -> SettledT_co:
        """Let go everything."""


class LogLabeller(Generic[SettledT_co]):
    """Labels the observations of one log as soon as the presses around them are known.

    Parameters
    ----------
    start : LogStart
        Tells where presses come from.
    bumper : BumperParams
        How bumper messages become presses.
    queue : WaitingLabels
        Where the observations wait.
    """

    def __init__(
        self, start: LogStart, bumper: BumperParams, queue: WaitingLabels[SettledT_co]
    ) -> None:
        self._start = start
        self._queue = queue
        self._tracker: PressTracker | None = None
        if start.presses is None and start.bump_kind is not None:
            self._tracker = PressTracker(start.bump_kind, bumper, start.hold_s)

    @property
    def presses(self) -> tuple[Press, ...] | None:
        """Presses so far; None if the log has no bumper."""
        return self._start.presses if self._tracker is None else self._tracker.presses

    def settle(self, bumps: Sequence[Bump], until_ns: int) -> SettledT_co:
        """Take in the bumps up to ``until_ns`` and return what is settled by them."""
        if self._tracker is not None:
            self._tracker.add(bumps)
            self._tracker.settle(until_ns)
        if not self._start.has_labels:
            return self._end_queue()
        return self._queue.settle(self._presses_that_matter(until_ns), until_ns)

    def end(self, end_ns: int) -> SettledT_co:
        """Close the log, whose last message is stamped ``end_ns``, and return the rest."""
        if self._tracker is not None:
            self._tracker.end(end_ns)
        return self._end_queue()

    def _end_queue(self) -> SettledT_co:
        settled = self._queue.end(self._presses_that_matter())
        if not self._start.has_labels:
            settled.labels[:] = NO_LABEL
        return settled

    def _presses_that_matter(self, until_ns: int | None = None) -> tuple[Press, ...]:
        """Return the presses near the observations that wait, none that begin later."""
        from_ns = self._queue.needs_presses_from_ns
        if from_ns is None:
            return ()
        if self._tracker is not None:
            return self._tracker.recent(from_ns)
        presses = self._start.presses or ()
        first = bisect_right(presses, from_ns, key=_END)
        last = len(presses) if until_ns is None else bisect_right(presses, until_ns, key=_START)
        return presses[first:last]
