"""Whether a probability means what it says: Brier score, its skill, reliability."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array

N_BINS = 10


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
    and frequency over ten bins of equal width, weighted by their scans.
    """

    brier: float
    brier_skill: float | None
    ece: float
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
    return Calibration(
        brier=brier,
        brier_skill=1 - brier / of_base if of_base > 0 else None,
        ece=sum(gaps) / p.size,
        bins=bins,
    )


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
