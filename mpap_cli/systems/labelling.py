"""Labels of one log while it is replayed: presses, the queue, settled labels (Figure 1)."""

from collections.abc import Sequence
from dataclasses import dataclass

from mpap_cli.observations import Bump, IntArray, ObservedLog, Press
from mpap_cli.params import Settings
from mpap_cli.properties.counts import LabelQueue, SettledLabels
from mpap_cli.properties.labels import NO_LABEL
from mpap_cli.properties.presses import PressTracker


@dataclass(frozen=True, slots=True)
class LogSource:
    """A log that a model has learnt from; ``n_presses`` is None if it has no bumper."""

    name: str
    start_ns: int
    end_ns: int
    n_scans: int
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

    def source(self, end_ns: int, n_scans: int, presses: tuple[Press, ...] | None) -> LogSource:
        """Return what is remembered of the log when it has been learnt."""
        return LogSource(
            name=self.name,
            start_ns=self.start_ns,
            end_ns=end_ns,
            n_scans=n_scans,
            n_presses=None if presses is None else len(presses),
            bump_source=self.bump_source,
        )

    @property
    def has_labels(self) -> bool:
        """Whether anything tells of presses."""
        return self.bump_kind is not None or self.presses is not None


class LogLabeller:
    """Labels the observations of one log as soon as the presses around them are known."""

    def __init__(self, settings: Settings, start: LogStart) -> None:
        self._start = start
        self._queue = LabelQueue(settings.properties, settings.bumper)
        self._tracker: PressTracker | None = None
        if start.presses is None and start.bump_kind is not None:
            self._tracker = PressTracker(start.bump_kind, settings.bumper, start.hold_s)

    @property
    def presses(self) -> tuple[Press, ...] | None:
        """Presses so far; None if the log has no bumper."""
        return self._start.presses if self._tracker is None else self._tracker.presses

    def add(self, stamps_ns: IntArray, ids: IntArray) -> None:
        """Let observations, both arrays of shape (n,), wait for their labels."""
        self._queue.add(stamps_ns, ids)

    def settle(self, bumps: Sequence[Bump], until_ns: int) -> SettledLabels:
        """Take in the bumps up to ``until_ns`` and return what is settled by them."""
        if self._tracker is not None:
            self._tracker.add(bumps)
            self._tracker.settle(until_ns)
        if not self._start.has_labels:
            return self._end_queue()
        return self._queue.settle(self._presses_that_matter(), until_ns)

    def end(self, end_ns: int) -> SettledLabels:
        """Close the log, whose last message is stamped ``end_ns``, and return the rest."""
        if self._tracker is not None:
            self._tracker.end(end_ns)
        return self._end_queue()

    def _end_queue(self) -> SettledLabels:
        settled = self._queue.end(self._presses_that_matter())
        if not self._start.has_labels:
            settled.labels[:] = NO_LABEL
        return settled

    def _presses_that_matter(self) -> tuple[Press, ...]:
        """Return the presses near the observations that wait."""
        if self._tracker is None:
            return self._start.presses or ()
        return self._tracker.recent(self._queue.needs_presses_from_ns)
