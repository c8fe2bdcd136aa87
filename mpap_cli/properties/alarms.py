"""When to raise an alarm: by odds against the usual ones, held for a while.

A press is rare, and how rare depends on where a log was begun and cut, so no probability
suits all robots as a threshold. That an observation makes a press so many times as likely
as it is on the whole does, or that hardly anything learnt was more alarming. An alarm that
flickers is none, so it is held.
"""

import numpy as np

from mpap_cli.features.scans.temporal import SlidingMinimum
from mpap_cli.observations import Float64Array, IntArray
from mpap_cli.params import PropertyParams


def odds_of(p: Float64Array) -> Float64Array:
    """Return p / (1 - p), infinity where p is 1.

    >>> odds_of(np.array([0.2, 0.5, 1.0])).tolist()
    [0.25, 1.0, inf]
    """
    with np.errstate(divide="ignore"):
        return np.asarray(p / (1.0 - p), dtype=np.float64)


def alarm_odds(p: Float64Array, counts: IntArray, params: PropertyParams) -> float:
    """Return the odds from which an alarm begins.

    Parameters
    ----------
    p : ndarray of shape (n,)
        Probabilities as the model reads them at what it learnt.
    counts : ndarray of shape (n, 2)
        Negatives and positives that were counted there.
    params : PropertyParams
        ``alarm_lift`` and ``alarm_share``.

    Returns
    -------
    float
        ``alarm_lift`` times the odds on the whole, or those that ``alarm_share`` of what
        was counted reaches, where these are lower; NaN where the counts are of one kind.

    Examples
    --------
    >>> p, counts = np.array([0.1, 0.3]), np.array([[90, 10], [7, 3]])
    >>> [round(alarm_odds(p, counts, PropertyParams(alarm_lift=lift)), 3) for lift in (2, 9)]
    [0.268, 0.429]
    """
    negatives, positives = counts.sum(axis=0).tolist()
    if not negatives or not positives:
        return np.nan
    order = np.argsort(-p, kind="stable")
    reached = np.cumsum(counts[order].sum(axis=1))
    last = np.searchsorted(reached[:-1], params.alarm_share * (negatives + positives))
    highest = odds_of(p[order])[last]
    return float(min(params.alarm_lift * positives / negatives, highest))


def alarm_levels(stamps_ns: IntArray, odds: Float64Array, params: PropertyParams) -> Float64Array:
    """Turn the odds of the observations of one log into a level that is held.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Not decreasing.
    odds : ndarray of shape (n,)
        0 or above, of any unit; NaN where no model spoke.
    params : PropertyParams
        ``alarm_release`` and ``alarm_hold_s``.

    Returns
    -------
    ndarray of shape (n,)
        For every threshold T, ``level >= T`` is an alarm that begins with odds of T and
        ends where they were below ``alarm_release`` T for ``alarm_hold_s``. No level
        depends on what comes later. NaN where the odds are.

    Notes
    -----
    level = max(odds, min(level before, highest odds of the hold time / release)).

    Examples
    --------
    >>> stamps_ns = np.arange(6) * 10**9
    >>> params = PropertyParams(alarm_release=0.5, alarm_hold_s=1.0)
    >>> alarm_levels(stamps_ns, np.array([1.0, 4.0, 2.0, 0.5, 0.5, 0.5]), params).tolist()
    [1.0, 4.0, 4.0, 4.0, 1.0, 1.0]
    """
    unknown = np.isnan(odds)
    known = np.where(unknown, 0.0, odds)
    window = SlidingMinimum(params.alarm_hold_s, 1)
    highest = -window.push(stamps_ns, -known[:, None])[:, 0]
    levels = np.empty_like(known)
    level = 0.0
    for i, (now, held) in enumerate(
        zip(known.tolist(), (highest / params.alarm_release).tolist(), strict=True)
    ):
        level = max(now, min(level, held))
        levels[i] = level
    levels[unknown] = np.nan
    return levels
