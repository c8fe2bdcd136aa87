"""Stretches of a log, record by record, with what still holds at the start of each."""

from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

from mpap_cli.logs.passthrough.reader import PassthroughLog
from mpap_cli.logs.passthrough.records import RawChannel, Record

MOST_TRANSFORMS = 64
"""So many different messages of a static transform topic are repeated, the latest ones."""


class Cut(NamedTuple):
    """A stretch of a log: start <= t < end, nanoseconds of log time."""

    start_ns: int
    end_ns: int


class _Latched:
    """The last messages of latched channels; of static transforms every different one.

    Several publishers share a channel of /tf_static, each with transforms of its own.
    """

    def __init__(self, channels: Sequence[RawChannel], chosen: Collection[int]) -> None:
        self._kept: dict[int, dict[bytes, Record]] = {
            number: {} for number in sorted(chosen) if channels[number].latched
        }
        self._most = {
            number: MOST_TRANSFORMS if channels[number].topic.endswith("tf_static") else 1
            for number in self._kept
        }

    @property
    def channels(self) -> Collection[int]:
        """Numbers of the latched channels."""
        return self._kept.keys()

    def note(self, record: Record) -> None:
        """Keep a record in place of what it makes obsolete."""
        kept = self._kept.get(record.channel)
        if kept is None:
            return
        kept.pop(record.payload, None)
        kept[record.payload] = record
        if len(kept) > self._most[record.channel]:
            del kept[next(iter(kept))]

    def repeated(self, stamp_ns: int) -> Iterator[Record]:
        """Yield what still holds, with that log time; all else as it was recorded."""
        for kept in self._kept.values():
            for record in kept.values():
                yield record._replace(stamp_ns=stamp_ns)


def cut_records(
    log: PassthroughLog, chosen: Collection[int], cuts: Sequence[Cut]
) -> Iterator[tuple[int, Record]]:
    """Yield the records of some channels in each cut, with the number of the cut.

    Parameters
    ----------
    log : PassthroughLog
        An open log.
    chosen : collection of int
        Numbers of its channels.
    cuts : sequence of Cut
        In time order, apart.

    Yields
    ------
    tuple of int and Record
        In log time order. A cut begins with the last messages of its latched channels
        before it, which bear the log time of its start and else are as they were recorded.
    """
    latched, behind_ns = _Latched(log.channels, chosen), None
    for number, cut in enumerate(cuts):
        if latched.channels:
            for record in log.records(latched.channels, behind_ns, cut.start_ns):
                latched.note(record)
        yield from ((number, record) for record in latched.repeated(cut.start_ns))
        for record in log.records(chosen, *cut):
            latched.note(record)
            yield number, record
        behind_ns = cut.end_ns
