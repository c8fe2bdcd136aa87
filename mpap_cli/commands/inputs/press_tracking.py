"""The presses of a log while it is replayed, where nothing is learnt from them."""

from mpap_cli.commands.inputs.sources import Source
from mpap_cli.observations import Batch, Press
from mpap_cli.params import BumperParams
from mpap_cli.properties.presses import PressTracker


class LogPresses:
    """Takes the bumps of one log and tells its presses.

    Parameters
    ----------
    source : Source
        The log, and where its presses come from.
    params : BumperParams
        How bumps become presses.
    """

    def __init__(self, source: Source, params: BumperParams) -> None:
        self._source = source
        kind = source.start.bump_kind
        self._tracker: PressTracker | None = None
        if kind is not None and source.start.presses is None:
            self._tracker = PressTracker(kind, params, source.start.hold_s)

    def add(self, batch: Batch) -> None:
        """Take in the bumps of the next batch."""
        if self._tracker is not None:
            self._tracker.add(batch.bumps)
            self._tracker.settle(batch.until_ns)

    def end(self) -> tuple[Press, ...] | None:
        """Return the presses of the whole log; None without a bumper."""
        if self._tracker is None:
            return self._source.start.presses
        self._tracker.end(self._source.replay.end_ns)
        return self._tracker.presses
