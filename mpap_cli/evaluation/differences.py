"""How much better the first method is than each other, over the same logs.

Methods are compared on the logs that both can be scored on and on the same resamples, so
that what makes a log hard cancels out.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.areas import Areas, mean_known
from mpap_cli.evaluation.intervals import (
    NO_INTERVAL,
    Interval,
    log_mean_interval,
    percentile_interval,
)
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.rows import DifferenceRow

SCORED = ("all presses", "visible presses")


@dataclass(frozen=True, slots=True)
class Difference:
    """Area of one method less that of another, with 95 % intervals.

    ``logs`` hold both classes for both; ``per_log`` is the mean over them, ``pooled`` is
    of the areas over the pairs within each model.
    """

    logs: int
    per_log: float | None
    per_log_interval: Interval
    pooled: float | None
    pooled_interval: Interval


def difference(first: Areas, other: Areas) -> Difference:
    """Compare two methods.

    Parameters
    ----------
    first, other : Areas
        Of the same logs and the same resampling.

    Returns
    -------
    Difference
        Empty where one of the areas is; intervals too where nothing can be resampled, or
        the difference per log has fewer than five logs.
    """
    of_log = first.of_log - other.of_log
    how = first.resampling
    pooled = None
    if first.pooled is not None and other.pooled is not None:
        pooled = first.pooled - other.pooled
    return Difference(
        logs=int(np.sum(~np.isnan(of_log))),
        per_log=mean_known(of_log),
        per_log_interval=log_mean_interval(of_log, how.n_resamples, how.seed),
        pooled=pooled,
        pooled_interval=_pooled_interval(first, other),
    )


def _pooled_interval(first: Areas, other: Areas) -> Interval:
    """Resample the same units for both."""
    if first.pairs is None or other.pairs is None:
        return NO_INTERVAL
    weights = first.resampling.weights()
    return percentile_interval(first.pairs.areas(weights) - other.pairs.areas(weights))


def difference_rows(marks: Sequence[Marks]) -> Iterator[DifferenceRow]:
    """Yield the rows of differences.csv: the first method against each of the others.

    First with all presses, then without those before which nothing near was seen.
    """
    first = marks[0]
    for scored in SCORED:
        for other in marks[1:]:
            pair = (first, other)
            areas = [one.areas if scored == SCORED[0] else one.visible for one in pair]
            yield _row(first, other, difference(*areas), scored)


def _row(first: Marks, other: Marks, found: Difference, scored: str) -> DifferenceRow:
    """Lay out one row."""
    ours, theirs = first.row, other.row
    return DifferenceRow(
        method=ours.method,
        feature=ours.feature,
        bins=ours.bins,
        profile=ours.profile,
        against=theirs.method,
        against_feature=theirs.feature,
        against_bins=theirs.bins,
        against_profile=theirs.profile,
        target=ours.target,
        protocol=ours.protocol,
        truth=ours.truth,
        scored=scored,
        logs=found.logs,
        diff_per_log=found.per_log,
        diff_per_log_low=found.per_log_interval[0],
        diff_per_log_high=found.per_log_interval[1],
        diff=found.pooled,
        diff_low=found.pooled_interval[0],
        diff_high=found.pooled_interval[1],
    )
