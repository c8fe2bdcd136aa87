"""ROC curves and the area under them, within one fold's model only (section 5.2).

Two folds are two models: one that learnt from few contacts says less than one that
learnt from many, so a score of the one is never compared with a score of the other.
"""

from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Scored:
    """Scans that are scored: ``score`` (n,), ``positive`` (n,) and the ``fold`` (n,)."""

    score: Float64Array
    positive: BoolArray
    fold: IntArray

    def within(self, fold: int) -> tuple[Float64Array, BoolArray]:
        """Return scores and truth of one fold."""
        inside = self.fold == fold
        return self.score[inside], self.positive[inside]

    def two_class_folds(self) -> IntArray:
        """Return the folds that hold positives and negatives, ascending."""
        return np.intersect1d(self.fold[self.positive], self.fold[~self.positive])


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Corners of a ROC curve, each (m,), from (0, 0) to (1, 1).

    A scan with ``score >= threshold`` is called positive; NaN in an average of models.
    """

    threshold: Float64Array
    fpr: Float64Array
    tpr: Float64Array

    def area(self) -> float:
        """Return the area under the curve by the trapezoid rule."""
        widths = np.diff(self.fpr)
        heights = (self.tpr[1:] + self.tpr[:-1]) / 2
        return float(widths @ heights)


def ordered_pairs(scores: Float64Array, positive: BoolArray) -> float:
    """Count the (positive, negative) pairs in the right order, ties as one half.

    Parameters
    ----------
    scores : ndarray of shape (n,)
        Scores of one model, not NaN.
    positive : ndarray of shape (n,)
        Truth.

    Returns
    -------
    float
        Between 0 and positives times negatives, a multiple of one half.

    Examples
    --------
    >>> ordered_pairs(np.array([0.1, 0.4, 0.4]), np.array([False, True, False]))
    1.5
    """
    negatives = np.sort(scores[~positive])
    found = scores[positive]
    below = np.searchsorted(negatives, found, side="left")
    up_to = np.searchsorted(negatives, found, side="right")
    return float((below.sum() + up_to.sum()) / 2)


def area_under_curve(scored: Scored) -> float | None:
    """Share of the (positive, negative) pairs of one fold that are in the right order.

    Returns
    -------
    float or None
        In [0, 1], over the pairs of all folds; None without any pair. With one fold it
        is the usual area under the curve.

    Examples
    --------
    Each model orders its own scans without a fault, whatever its general level:

    >>> score = np.array([0.1, 0.2, 0.8, 0.9])
    >>> positive = np.array([False, True, False, True])
    >>> area_under_curve(Scored(score, positive, np.array([0, 0, 1, 1])))
    1.0
    >>> area_under_curve(Scored(score, positive, np.zeros(4, dtype=np.int64)))
    0.75
    """
    ordered = 0.0
    n_pairs = 0
    for fold in scored.two_class_folds():
        scores, positive = scored.within(fold)
        ordered += ordered_pairs(scores, positive)
        n_pairs += _n_pairs(positive)
    return ordered / n_pairs if n_pairs else None


def areas_of_logs(scored: Scored, log_index: IntArray, n_logs: int) -> Float64Array:
    """Area of each log, (n_logs,); NaN where a log lacks one of the classes.

    Within a log that several folds share, pairs still stay within their fold.
    """
    areas = np.full(n_logs, np.nan)
    for log in np.unique(log_index):
        inside = log_index == log
        part = Scored(scored.score[inside], scored.positive[inside], scored.fold[inside])
        area = area_under_curve(part)
        if area is not None:
            areas[log] = area
    return areas


def fold_curve(scores: Float64Array, positive: BoolArray) -> Curve:
    """ROC curve of one model, a corner at every distinct score (Fig. 10).

    Raises
    ------
    ValueError
        If there is one class only.
    """
    n_positives = int(positive.sum())
    n_negatives = positive.size - n_positives
    if min(n_positives, n_negatives) == 0:
        msg = "a ROC curve needs positives and negatives"
        raise ValueError(msg)
    order = np.argsort(-scores, kind="stable")
    ordered = scores[order]
    last_of_score = np.append(np.flatnonzero(np.diff(ordered)), positive.size - 1)
    hits = np.cumsum(positive[order])[last_of_score]
    false_alarms = last_of_score + 1 - hits
    return Curve(
        threshold=np.concatenate(([np.inf], ordered[last_of_score])),
        fpr=np.concatenate(([0.0], false_alarms / n_negatives)),
        tpr=np.concatenate(([0.0], hits / n_positives)),
    )


def roc_curve(scored: Scored) -> Curve | None:
    """Pair-weighted average of the folds' curves; its area is :func:`area_under_curve`.

    With one scored fold the curve is that fold's, with its thresholds. Several are
    averaged vertically: at each false positive rate the mean of the true positive rates.
    """
    folds = scored.two_class_folds()
    curves = [fold_curve(*scored.within(fold)) for fold in folds]
    if len(curves) < 2:  # noqa: PLR2004  # one curve needs no average
        return curves[0] if curves else None
    weights = np.array([_n_pairs(scored.within(fold)[1]) for fold in folds], dtype=np.float64)
    weights /= weights.sum()
    grid = np.unique(np.concatenate([curve.fpr for curve in curves]))
    bounds = [_tpr_bounds(curve, grid) for curve in curves]
    low = weights @ np.stack([bound[0] for bound in bounds])
    high = weights @ np.stack([bound[1] for bound in bounds])
    # Rounding of the weights may leave the last corner a hair off 1.
    high[-1] = 1.0
    fpr = np.repeat(grid, 2)
    tpr = np.minimum(np.maximum.accumulate(np.stack((low, high), axis=1).ravel()), 1.0)
    fresh = np.concatenate(([True], (np.diff(fpr) > 0) | (np.diff(tpr) > 0)))
    fpr, tpr = fpr[fresh], tpr[fresh]
    return Curve(np.full(fpr.size, np.nan), fpr, tpr)


def average_precision(scored: Scored) -> float | None:
    """Average precision of each fold's model, weighted by the fold's positives.

    Precision is taken at every distinct score, without interpolation. Folds with one
    class only are left out, as in the area under the curve.
    """
    total = 0.0
    n_positives = 0
    for fold in scored.two_class_folds():
        scores, positive = scored.within(fold)
        curve = fold_curve(scores, positive)
        hits = curve.tpr * positive.sum()
        called = hits + curve.fpr * (positive.size - positive.sum())
        total += float(np.diff(hits) @ (hits[1:] / called[1:]))
        n_positives += int(positive.sum())
    return total / n_positives if n_positives else None


def _n_pairs(positive: BoolArray) -> int:
    n_positives = int(positive.sum())
    return n_positives * (positive.size - n_positives)


def _tpr_bounds(curve: Curve, grid: Float64Array) -> tuple[Float64Array, Float64Array]:
    """Lowest and highest true positive rate of a curve at each rate of the grid."""
    rates, first = np.unique(curve.fpr, return_index=True)
    last = np.append(first[1:], curve.fpr.size) - 1
    low, high = curve.tpr[first], curve.tpr[last]
    at = np.searchsorted(rates, grid, side="right") - 1
    following = np.minimum(at + 1, rates.size - 1)
    width = np.where(following > at, rates[following] - rates[at], 1.0)
    share = (grid - rates[at]) / width
    between = high[at] + share * (low[following] - high[at])
    exact = grid == rates[at]
    return np.where(exact, low[at], between), np.where(exact, high[at], between)
