"""How sure an area under the curve is: bootstrap of logs, or of segments of time.

Scans that follow one another are alike, so single scans are never resampled. Methods are
compared on the same resamples: their difference is far surer than either area.
"""

from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.roc import Scored
from mpap_cli.observations import Float64Array, IntArray

PERCENTILES = (2.5, 97.5)
MIN_LOGS = 5

Interval = tuple[float, float] | tuple[None, None]
NO_INTERVAL: Interval = (None, None)


@dataclass(frozen=True, slots=True, eq=False)
class UnitPairs:
    """Pairs between units, so that a resample is a weighted sum.

    Both are (n_units, n_units): entry (i, j) holds the pairs of a positive of unit i and a
    negative of unit j in one fold, those in the right ``ordered`` (ties one half), and all.
    """

    ordered: Float64Array
    pairs: Float64Array

    def areas(self, weights: Float64Array) -> Float64Array:
        """Return the area of each resample, (n_resamples,); NaN where it holds no pair."""
        n_ordered = np.sum((weights @ self.ordered) * weights, axis=1)
        n_pairs = np.sum((weights @ self.pairs) * weights, axis=1)
        areas = np.full(n_pairs.size, np.nan)
        np.divide(n_ordered, n_pairs, out=areas, where=n_pairs > 0)
        return areas


def unit_pairs(scored: Scored, unit: IntArray, n_units: int) -> UnitPairs:
    """Sum the pairs between units.

    Parameters
    ----------
    scored : Scored
        Scores, truth and fold of n scans.
    unit : ndarray of shape (n,)
        The log or segment of each scan, in [0, n_units).
    n_units : int
        Number of units.
    """
    ordered = np.zeros((n_units, n_units))
    pairs = np.zeros((n_units, n_units))
    for fold in scored.two_class_folds():
        inside = scored.fold == fold
        score, positive, part = scored.score[inside], scored.positive[inside], unit[inside]
        found, found_unit = score[positive], part[positive]
        per_unit = np.bincount(found_unit, minlength=n_units)
        for other in np.unique(part[~positive]):
            negatives = np.sort(score[~positive & (part == other)])
            below = np.searchsorted(negatives, found, side="left")
            up_to = np.searchsorted(negatives, found, side="right")
            ordered[:, other] += np.bincount(found_unit, (below + up_to) / 2, minlength=n_units)
            pairs[:, other] += per_unit * negatives.size
    return UnitPairs(ordered, pairs)


def resample_weights(n_units: int, n_resamples: int, seed: int) -> Float64Array:
    """Draw how often each unit is in each resample: (n_resamples, n_units).

    Equal seeds draw the same units, whatever is scored.
    """
    generator = np.random.default_rng(seed)
    drawn = generator.integers(n_units, size=(n_resamples, n_units))
    place = drawn + n_units * np.arange(n_resamples)[:, None]
    counts = np.bincount(place.ravel(), minlength=n_resamples * n_units)
    return counts.reshape(n_resamples, n_units).astype(np.float64)


def percentile_interval(values: Float64Array) -> Interval:
    """95 % interval of what resamples gave, NaN left out; empty without any.

    >>> percentile_interval(np.array([0.0, np.nan, 1.0]))
    (0.025, 0.975)
    """
    known = values[~np.isnan(values)]
    if known.size == 0:
        return NO_INTERVAL
    low, high = np.percentile(known, PERCENTILES)
    return float(low), float(high)


def log_mean_interval(of_log: Float64Array, n_resamples: int, seed: int) -> Interval:
    """95 % interval of a mean over logs by a bootstrap of logs.

    Parameters
    ----------
    of_log : ndarray of shape (n_logs,)
        One figure a log, NaN where it is not defined.
    n_resamples, seed : int
        Number of resamples, and the seed of the draws.

    Returns
    -------
    tuple of (float or None)
        Low and high; None with fewer than five logs where the figure is defined. All logs
        are drawn, so that every figure is resampled alike; the mean is over those drawn
        that have it.
    """
    known = ~np.isnan(of_log)
    if np.sum(known) < MIN_LOGS:
        return NO_INTERVAL
    weights = resample_weights(of_log.size, n_resamples, seed)[:, known]
    drawn = weights.sum(axis=1)
    means = np.full(n_resamples, np.nan)
    np.divide(weights @ of_log[known], drawn, out=means, where=drawn > 0)
    return percentile_interval(means)
