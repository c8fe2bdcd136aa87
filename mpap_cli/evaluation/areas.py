"""The area under the curve of one method: pooled within its models, and log by log."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.intervals import (
    NO_INTERVAL,
    Interval,
    UnitPairs,
    log_mean_interval,
    percentile_interval,
    resample_weights,
    unit_pairs,
)
from mpap_cli.evaluation.roc import Scored, area_under_curve, areas_of_logs
from mpap_cli.observations import Float64Array, IntArray


@dataclass(frozen=True, slots=True)
class Resampling:
    """How intervals are made: numbers of logs and of units, resamples and their seed."""

    n_logs: int
    n_units: int
    n_resamples: int
    seed: int

    def weights(self) -> Float64Array:
        """Return how often each unit is drawn, the same for every method."""
        return resample_weights(self.n_units, self.n_resamples, self.seed)


@dataclass(frozen=True, slots=True, eq=False)
class Areas:
    """Areas of one method over one choice of scans; None and NaN where there is none.

    ``pooled`` is over the pairs within each model; ``of_log`` (n_logs,) has one area a
    log; ``pairs`` is what an interval of ``pooled`` resamples, None: nothing.
    """

    pooled: float | None
    of_log: Float64Array
    pairs: UnitPairs | None
    resampling: Resampling

    @property
    def n_logs(self) -> int:
        """Number of logs that hold both classes."""
        return int(np.sum(~np.isnan(self.of_log)))

    @property
    def per_log(self) -> float | None:
        """Mean of the areas of the logs that hold both classes."""
        return mean_known(self.of_log)

    def pooled_interval(self) -> Interval:
        """Return the 95 % interval of the pooled area."""
        if self.pairs is None:
            return NO_INTERVAL
        return percentile_interval(self.pairs.areas(self.resampling.weights()))

    def per_log_interval(self) -> Interval:
        """Return the 95 % interval of the mean over logs, empty with fewer than five."""
        how = self.resampling
        return log_mean_interval(self.of_log, how.n_resamples, how.seed)


def measure_areas(
    scored: Scored, log: IntArray, unit: IntArray | None, resampling: Resampling
) -> Areas:
    """Measure the areas of n scans.

    Parameters
    ----------
    scored : Scored
        Scores, truth and fold of n scans.
    log : ndarray of shape (n,)
        Log of each scan.
    unit : ndarray of shape (n,) or None
        What an interval of the pooled area resamples
        (:func:`mpap_cli.evaluation.protocols.bootstrap_units`).
    resampling : Resampling
        How.
    """
    return Areas(
        pooled=area_under_curve(scored),
        of_log=areas_of_logs(scored, log, resampling.n_logs),
        pairs=None if unit is None else unit_pairs(scored, unit, resampling.n_units),
        resampling=resampling,
    )


def mean_known(values: Float64Array) -> float | None:
    """Return the mean of what is not NaN, None without any.

    >>> mean_known(np.array([0.5, np.nan, 1.0]))
    0.75
    """
    known = values[~np.isnan(values)]
    return float(known.mean()) if known.size else None
