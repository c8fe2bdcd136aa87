"""Whether a probability means what it says: Brier score, reliability, recalibration."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array

N_BINS = 10
# The log odds of 0 and 1 are infinite.
MOST_CERTAIN = 0.001
MAX_STEPS = 50
CONVERGED = 1e-9


@dataclass(frozen=True, slots=True)
class ReliabilityBin:
    """Scans whose probability lies in [low, high): their number and means.

    ``mean_p`` and ``share_positive`` are None in an empty bin. The last bin holds 1.
    """

    low: float
    high: float
    scans: int
    mean_p: float | None
    share_positive: float | None


@dataclass(frozen=True, slots=True)
class Calibration:
    """Scores of probabilities.

    ``brier`` is the mean squared error; ``brier_skill`` is one minus its ratio to that of
    the base rate (None with one class); ``ece`` is the mean distance between probability
    and frequency over ten bins of equal width, weighted by their scans. ``slope`` and
    ``intercept`` are those of :func:`recalibration`.
    """

    brier: float
    brier_skill: float | None
    ece: float
    slope: float | None
    intercept: float | None
    bins: tuple[ReliabilityBin, ...]


def calibration(p: Float64Array, positive: BoolArray) -> Calibration | None:
    """Score probabilities against what happened.

    Parameters
    ----------
    p : ndarray of shape (n,)
        Probabilities in [0, 1].
    positive : ndarray of shape (n,)
        Truth.

    Returns
    -------
    Calibration or None
        None without any scan.

    Examples
    --------
    >>> score = calibration(np.array([0.5, 0.5]), np.array([True, False]))
    >>> score.brier, score.brier_skill, score.ece
    (0.25, 0.0, 0.0)
    """
    if p.size == 0:
        return None
    brier = float(np.mean((p - positive) ** 2))
    base = float(positive.mean())
    of_base = base * (1 - base)
    bins = _reliability(p, positive)
    gaps = [
        entry.scans * abs(entry.mean_p - entry.share_positive)
        for entry in bins
        if entry.mean_p is not None and entry.share_positive is not None
    ]
    slope, intercept = recalibration(p, positive) or (None, None)
    return Calibration(
        brier=brier,
        brier_skill=1 - brier / of_base if of_base > 0 else None,
        ece=sum(gaps) / p.size,
        slope=slope,
        intercept=intercept,
        bins=bins,
    )


def recalibration(p: Float64Array, positive: BoolArray) -> tuple[float, float] | None:
    """Slope and intercept of the log odds of what happened on those that were said.

    Parameters
    ----------
    p : ndarray of shape (n,)
        Probabilities in [0, 1], brought into [.001, .999].
    positive : ndarray of shape (n,)
        Truth.

    Returns
    -------
    (float, float) or None
        Slope and intercept of the logistic regression of the truth on log(p / (1 - p)),
        without any penalty: 1 and 0 where probabilities mean what they say. A slope below
        1: they lie too far from the base rate; at slope 1 an intercept below 0: they are
        too high. None where a threshold parts the classes, or all are equally probable.

    Notes
    -----
    Cox (1958), Two further applications of a model for binary regression. By Newton's
    method; steps are halved where they would not climb.

    Examples
    --------
    Of the scans said to be at .2, two in five are positive:

    >>> p = np.repeat([0.2, 0.8], 5)
    >>> positive = np.array([1, 1, 0, 0, 0, 1, 1, 1, 0, 0]) == 1
    >>> slope, intercept = recalibration(p, positive)
    >>> round(slope, 3), round(abs(intercept), 3)
    (0.292, 0.0)
    """
    said = np.clip(p, MOST_CERTAIN, 1 - MOST_CERTAIN)
    log_odds = np.log(said / (1 - said))
    if not _overlap(log_odds[positive], log_odds[~positive]):
        return None
    regressors = np.stack([np.ones(p.size), log_odds], axis=1)
    found = np.array([0.0, 1.0])
    height = _log_likelihood(regressors @ found, positive)
    for _ in range(MAX_STEPS):
        fitted = 1 / (1 + np.exp(-(regressors @ found)))
        slopes = regressors.T @ (positive - fitted)
        bend = (regressors * (fitted * (1 - fitted))[:, None]).T @ regressors
        step = np.linalg.solve(bend, slopes)
        while (higher := _log_likelihood(regressors @ (found + step), positive)) < height:
            step /= 2
        found, height = found + step, higher
        if np.max(np.abs(step)) < CONVERGED:
            break
    return float(found[1]), float(found[0])


def _overlap(found: Float64Array, others: Float64Array) -> bool:
    """Tell whether a best slope exists: no threshold parts the classes, even with ties."""
    if found.size == 0 or others.size == 0:
        return False
    return bool(found.min() < others.max() and others.min() < found.max())


def _log_likelihood(log_odds: Float64Array, positive: BoolArray) -> float:
    """Return the log likelihood of the truth."""
    return float(np.sum(positive * log_odds - np.logaddexp(0.0, log_odds)))


def _reliability(p: Float64Array, positive: BoolArray) -> tuple[ReliabilityBin, ...]:
    """Mean probability and frequency in each of ten bins of equal width."""
    place = np.minimum((p * N_BINS).astype(np.int64), N_BINS - 1)
    scans = np.bincount(place, minlength=N_BINS)
    sum_p = np.bincount(place, p, minlength=N_BINS)
    hits = np.bincount(place, positive, minlength=N_BINS)
    return tuple(
        ReliabilityBin(
            low=j / N_BINS,
            high=(j + 1) / N_BINS,
            scans=int(n),
            mean_p=float(sum_p[j] / n) if n else None,
            share_positive=float(hits[j] / n) if n else None,
        )
        for j, n in enumerate(scans)
    )
