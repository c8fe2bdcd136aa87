"""How sure an area under the curve is: bootstrap of logs, or of segments of time.

Scans that follow one another are alike, so single scans are never resampled.
"""

import numpy as np

from mpap_cli.evaluation.roc import Scored
from mpap_cli.observations import Float64Array, IntArray

PERCENTILES = (2.5, 97.5)


def unit_pairs(scored: Scored, unit: IntArray, n_units: int) -> tuple[Float64Array, Float64Array]:
    """Sum the pairs between units, so that a resample is a weighted sum.

    Parameters
    ----------
    scored : Scored
        Scores, truth and fold of n scans.
    unit : ndarray of shape (n,)
        The log or segment of each scan, in [0, n_units).
    n_units : int
        Number of units.

    Returns
    -------
    ordered, pairs : ndarray of shape (n_units, n_units)
        Entry (i, j) holds the pairs of a positive of unit i and a negative of unit j in
        one fold: those in the right order (ties one half), and all.
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
    return ordered, pairs


def resample_weights(n_units: int, n_resamples: int, seed: int) -> IntArray:
    """Draw how often each unit is in each resample: (n_resamples, n_units)."""
    generator = np.random.default_rng(seed)
    drawn = generator.integers(n_units, size=(n_resamples, n_units))
    rows = np.repeat(np.arange(n_resamples), n_units)
    weights = np.zeros((n_resamples, n_units), dtype=np.int64)
    np.add.at(weights, (rows, drawn.ravel()), 1)
    return weights


def area_interval(
    scored: Scored, unit: IntArray | None, n_resamples: int, seed: int
) -> tuple[float, float] | None:
    """95 % interval of the area under the curve by a bootstrap of units.

    Parameters
    ----------
    scored : Scored
        Scores, truth and fold of n scans.
    unit : ndarray of shape (n,) or None
        The unit of each scan (:func:`mpap_cli.evaluation.protocols.bootstrap_units`).
    n_resamples : int
        Number of resamples.
    seed : int
        Seed of the draws; equal seeds draw the same units for every method.

    Returns
    -------
    (float, float) or None
        None where there are no units or no resample holds a pair. Resamples without a
        pair are left out.
    """
    if unit is None or unit.size == 0:
        return None
    n_units = int(unit.max()) + 1
    ordered, pairs = unit_pairs(scored, unit, n_units)
    weights = resample_weights(n_units, n_resamples, seed).astype(np.float64)
    n_ordered = np.sum((weights @ ordered) * weights, axis=1)
    n_pairs = np.sum((weights @ pairs) * weights, axis=1)
    usable = n_pairs > 0
    if not usable.any():
        return None
    low, high = np.percentile(n_ordered[usable] / n_pairs[usable], PERCENTILES)
    return float(low), float(high)
