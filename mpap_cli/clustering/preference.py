"""Preferences of affinity propagation: rules by name, and their useful range."""

import numpy as np

from mpap_cli.observations import Float64Array
from mpap_cli.params import parse_preference

_ITEMS_OF_MEDIAN = 50


def resolve_preference(similarities: Float64Array, rule: str) -> float:
    """Turn a rule into the preference it means for these similarities (section 3.2).

    Parameters
    ----------
    similarities : ndarray of shape (n, n)
        The diagonal and forbidden pairs (``-inf``) are left out.
    rule : str
        ``median``, ``min``, ``quantile:Q``, ``range:F`` (the fraction F of the way from
        one cluster to n clusters, see :func:`preference_range`) or a number.

    Returns
    -------
    float
        Finite; 0.0 where no pair is left to go by.

    Raises
    ------
    SettingError
        If there is no such rule.

    Examples
    --------
    >>> s = np.array([[0.0, -1.0, -4.0], [-1.0, 0.0, -2.0], [-4.0, -2.0, 0.0]])
    >>> resolve_preference(s, "median"), resolve_preference(s, "min")
    (-2.0, -4.0)
    """
    name, value = parse_preference(rule)
    if name == "number":
        return value
    pairs = _off_diagonal(similarities)
    if not pairs.size:
        return 0.0
    if name == "range":
        low, high = preference_range(similarities)
        return low + value * (high - low)
    share = {"min": 0.0, "median": 0.5, "quantile": value}[name]
    return float(np.quantile(pairs, share))


def coarse_preference(similarities: Float64Array) -> float:
    """Return the preference that makes few clusters out of many exemplars.

    Parameters
    ----------
    similarities : ndarray of shape (n, n)
        As for :func:`resolve_preference`; 0 or less.

    Returns
    -------
    float
        The median times n / 50, or the median itself for up to 50 items: the number of
        clusters then hardly grows with n, as it does with the median.

    Examples
    --------
    >>> coarse_preference(np.full((100, 100), -0.5))
    -1.0
    """
    growth = max(1.0, len(similarities) / _ITEMS_OF_MEDIAN)
    return growth * resolve_preference(similarities, "median")


def preference_range(similarities: Float64Array, *, exact: bool = True) -> tuple[float, float]:
    """Preferences between which the number of clusters goes from one to n.

    Parameters
    ----------
    similarities : ndarray of shape (n, n)
        The diagonal is ignored; no forbidden pairs.
    exact : bool
        False: a lower bound of the first figure in O(n^2) steps instead of O(n^3).

    Returns
    -------
    tuple of float
        The preference at which one and two clusters have the same net similarity, and
        the one at which n - 1 and n have. Both are 0.0 for fewer than two items.

    Raises
    ------
    ValueError
        If a pair is forbidden or not a number: one cluster may then be impossible.

    Examples
    --------
    >>> x = np.array([0.0, 1.0, 3.0])
    >>> preference_range(-(x[:, None] - x) ** 2)
    (-4.0, -1.0)
    """
    n = len(similarities)
    if n < 2:  # noqa: PLR2004
        return 0.0, 0.0
    s = np.array(similarities, dtype=np.float64)
    np.fill_diagonal(s, 0.0)
    if not np.isfinite(s).all():
        msg = "similarities: a preference range needs finite similarities of all pairs"
        raise ValueError(msg)
    np.fill_diagonal(s, -np.inf)
    nearest = s.max(axis=1)
    np.fill_diagonal(s, 0.0)
    one = float(s.sum(axis=0).max())
    two = _best_pair(s) if exact else float(nearest.sum() - np.partition(nearest, 1)[:2].sum())
    return one - two, float(nearest.max())


def _best_pair(s: Float64Array) -> float:
    """Largest sum of similarities to two exemplars, over all pairs of them."""
    best = -np.inf
    for k in range(len(s) - 1):
        both = np.maximum(s[:, k, None], s[:, k + 1 :])
        # an exemplar is not represented by the other one
        own = np.maximum(s[k, k + 1 :], 0.0) + np.maximum(s[k + 1 :, k], 0.0)
        best = max(best, float((both.sum(axis=0) - own).max()))
    return best


def _off_diagonal(similarities: Float64Array) -> Float64Array:
    """Return the entries beside the diagonal, forbidden pairs left out."""
    allowed = similarities != -np.inf
    np.fill_diagonal(allowed, val=False)
    pairs: Float64Array = similarities[allowed]
    return pairs
