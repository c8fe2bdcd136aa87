"""Which stretches of logs are kept: windows about moments, merged, within a budget."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import attrgetter

from mpap_cli.observations import NS_PER_S


@dataclass(frozen=True, slots=True)
class Moment:
    """A stretch of one log that is worth keeping, start <= t < end in log time.

    Of two, that with the greater ``score`` is worth more; ``cluster`` is what was seen
    in it, None where that is not known.
    """

    log_index: int
    start_ns: int
    end_ns: int
    score: float
    cluster: int | None = None

    @property
    def length_ns(self) -> int:
        """How long it is."""
        return self.end_ns - self.start_ns


@dataclass(frozen=True, slots=True)
class Margins:
    """What is kept before and after a moment, nanoseconds."""

    before_ns: int
    after_ns: int

    @classmethod
    def of_seconds(cls, before_s: float, after_s: float) -> "Margins":
        """Take both in seconds."""
        return cls(round(before_s * NS_PER_S), round(after_s * NS_PER_S))


Bounds = Sequence[tuple[int, int]]
"""First stamp of each log, and the one behind its last."""


def widen(moments: Sequence[Moment], margins: Margins, bounds: Bounds) -> list[Moment]:
    """Add the margins to moments, as far as their logs reach.

    Examples
    --------
    >>> widen([Moment(0, 50, 60, 1.0)], Margins(20, 5), [(40, 100)])
    [Moment(log_index=0, start_ns=40, end_ns=65, score=1.0, cluster=None)]
    """
    widened = []
    for moment in moments:
        first_ns, behind_ns = bounds[moment.log_index]
        start_ns = max(moment.start_ns - margins.before_ns, first_ns)
        end_ns = min(max(moment.end_ns, moment.start_ns + 1) + margins.after_ns, behind_ns)
        if start_ns < end_ns:
            widened.append(replace(moment, start_ns=start_ns, end_ns=end_ns))
    return widened


def merge(moments: Sequence[Moment]) -> list[Moment]:
    """Join moments that overlap or touch; the best of them gives score and cluster.

    Examples
    --------
    >>> merge([Moment(0, 5, 9, 0.5), Moment(0, 0, 6, 0.9, 3)])
    [Moment(log_index=0, start_ns=0, end_ns=9, score=0.9, cluster=3)]
    """
    joined: list[Moment] = []
    for moment in sorted(moments, key=attrgetter("log_index", "start_ns", "end_ns")):
        last = joined[-1] if joined else None
        if last is None or last.log_index != moment.log_index or last.end_ns < moment.start_ns:
            joined.append(moment)
            continue
        best = max(last, moment, key=attrgetter("score"))
        joined[-1] = replace(best, start_ns=last.start_ns, end_ns=max(last.end_ns, moment.end_ns))
    return joined


def best_within(moments: Sequence[Moment], budget_ns: int) -> list[Moment]:
    """Keep the moments of the highest score that fit into a budget together; merged.

    Parameters
    ----------
    moments : sequence of Moment
        With their margins.
    budget_ns : int
        How long what is kept may be; what overlaps counts once.

    Returns
    -------
    list of Moment
        In the order of logs and time. One that does not fit is passed over.
    """
    kept: list[Moment] = []
    length_ns = 0
    for moment in sorted(moments, key=_rank):
        with_it = merge([*kept, moment])
        longer_ns = sum(one.length_ns for one in with_it)
        if longer_ns <= budget_ns:
            kept, length_ns = with_it, longer_ns
        if length_ns == budget_ns:
            break
    return kept


def _rank(moment: Moment) -> tuple[float, int, int]:
    """Order moments: the best first, of equals the earliest."""
    return -moment.score, moment.log_index, moment.start_ns


def by_log(moments: Sequence[Moment]) -> Iterator[tuple[int, list[Moment]]]:
    """Yield the moments of each log that has any, in order."""
    for index, group in groupby(moments, key=attrgetter("log_index")):
        yield index, list(group)
