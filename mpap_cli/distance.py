"""Equation 7 as a Euclidean distance, and the similarities that come from distances.

A histogram becomes a point of length 1, the square roots of its shares; equation 7 is
then the Euclidean distance of two such points divided by the square root of two.
Distances grow with difference, similarities fall: :func:`similarities` is the one place
that turns the former into the latter.
"""

import numpy as np
from numpy.typing import ArrayLike

from mpap_cli.errors import SettingError
from mpap_cli.observations import Float64Array, FloatArray

ZERO_MASS = 1e-12
# The matrix of their pairs takes 3.2 GB, and affinity propagation four of it.
MOST_CLUSTERED = 20_000
# Up to so many differences numpy is done before scipy would be imported.
_FEW_STEPS = 1 << 20


def embed(histograms: ArrayLike) -> FloatArray:
    """Turn histograms into points of length 1: u = sqrt(H / sum H) (equation 7).

    Parameters
    ----------
    histograms : array_like of shape (..., b)
        Values of the bins, finite, 0 or more; not necessarily of unit mass.

    Returns
    -------
    ndarray of shape (..., b + 1)
        float32 if that is what came, else float64. The added last coordinate is 1 where
        the mass of a histogram is at most 1e-12 (all else 0 there) and 0 elsewhere, so
        that an empty histogram equals other empty ones and is at distance 1 of the rest.

    Raises
    ------
    ValueError
        If a value is negative or not finite; equation 7 has no meaning there.

    Examples
    --------
    >>> embed([[1.0, 3.0], [0.0, 0.0]]).round(3).tolist()
    [[0.5, 0.866, 0.0], [0.0, 0.0, 1.0]]
    """
    given = np.asarray(histograms)
    values = given.astype(np.float64)
    bad = int(np.count_nonzero(~(np.isfinite(values) & (values >= 0))))
    if bad:
        msg = f"histograms: {bad} of {values.size} values are negative or not finite"
        raise ValueError(msg)
    mass = values.sum(axis=-1, keepdims=True)
    empty = mass <= ZERO_MASS
    shares = np.where(empty, 0.0, values / np.where(empty, 1.0, mass))
    points = np.concatenate([np.sqrt(shares), empty.astype(np.float64)], axis=-1)
    return points.astype(np.float32) if given.dtype == np.float32 else points


def squared_distances(
    points: FloatArray, others: FloatArray, *, normalized: bool = True
) -> Float64Array:
    """Squared distances between all pairs of two sets of points.

    Parameters
    ----------
    points, others : ndarray of shape (n, d) and (m, d)
        Embedded histograms, or any points if not ``normalized``.
    normalized : bool
        Whether half of the squared Euclidean distance is meant (equation 7), or all of it.

    Returns
    -------
    ndarray of shape (n, m)
        float64, 0 or more; exactly 0 for equal rows, since it is summed from differences
        (one minus a product would leave rounding errors below and above zero).

    Examples
    --------
    >>> u = embed([[1.0, 0.0], [0.0, 5.0], [2.0, 0.0]])
    >>> squared_distances(u[:1], u).tolist()
    [[0.0, 1.0, 0.0]]
    """
    left, right = np.asarray(points, np.float64), np.asarray(others, np.float64)
    small = left.size * len(right) <= _FEW_STEPS
    squared = _sums_of_squares(left, right) if small else _cdist(left, right)
    if normalized:
        squared *= 0.5
    return squared


def _sums_of_squares(points: Float64Array, others: Float64Array) -> Float64Array:
    """Sum the squared differences from the first coordinate to the last, as cdist does."""
    squared = np.zeros((len(points), len(others)))
    for x, y in zip(points.T, others.T, strict=True):
        step = x[:, None] - y
        squared += step * step
    return squared


def _cdist(points: Float64Array, others: Float64Array) -> Float64Array:
    from scipy.spatial.distance import cdist  # noqa: PLC0415  # slow to import

    squared: Float64Array = cdist(points, others, "sqeuclidean")
    return squared


def distance(point: FloatArray, other: FloatArray) -> float:
    """Distance of two embedded histograms, in [0, 1] (equation 7).

    Examples
    --------
    >>> round(distance(embed([1.0, 1.0]), embed([1.0, 0.0])), 6)
    0.541196
    """
    squared = squared_distances(np.atleast_2d(point), np.atleast_2d(other))
    return float(np.sqrt(squared[0, 0]))


def similarities(
    points: FloatArray, rule: str = "neg-squared", *, normalized: bool = True
) -> Float64Array:
    """Similarities of all pairs of points for affinity propagation (section 3.2).

    Parameters
    ----------
    points : ndarray of shape (n, d)
        Embedded histograms, or any points if not ``normalized``.
    rule : str
        ``neg-squared``: s = -d^2; ``neg-distance``: s = -d.
    normalized : bool
        As in :func:`squared_distances`.

    Returns
    -------
    ndarray of shape (n, n)
        float64, 0 or less, zeros on the diagonal.

    Raises
    ------
    SettingError
        If the points are more than memory can take pairs of.

    Examples
    --------
    >>> similarities(embed([[1.0, 0.0], [0.0, 1.0]])).tolist()
    [[0.0, -1.0], [-1.0, 0.0]]
    """
    if len(points) > MOST_CLUSTERED:
        msg = (
            f"clustering: found {len(points):,} points, at most {MOST_CLUSTERED:,} can be compared "
            "with one another; make theta (scans) or eps (images) larger"
        )
        raise SettingError(msg)
    squared = squared_distances(points, points, normalized=normalized)
    if rule == "neg-distance":
        np.sqrt(squared, out=squared)
    return np.subtract(0.0, squared, out=squared)
