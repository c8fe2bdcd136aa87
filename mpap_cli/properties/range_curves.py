"""Probability over one nearest range: the nearer, the more probable, never the contrary.

Many dimensions see what a scan looks like; one dimension alone knows its few contacts far
better. The kernel read-out and these curves are joined by their log odds. A range is an
angle here: that of the block (range, slack) of an embedded histogram.
"""

from collections.abc import Sequence

import numpy as np

from mpap_cli.observations import Float64Array, FloatArray, IntArray
from mpap_cli.properties.kernel import Kernel

N_ANGLES = 64


def block_angles(points: FloatArray, column: int) -> Float64Array:
    """Return the angle (n,) between the two columns, range and slack, from ``column`` on.

    In [0, pi / 2]: the nearer, the larger.

    Examples
    --------
    >>> block_angles(np.array([[0.6, 0.8], [0.8, 0.6]]), 0).round(2).tolist()
    [0.64, 0.93]
    """
    block = points[:, column : column + 2].astype(np.float64)
    return np.asarray(np.arctan2(block[:, 0], block[:, 1]), dtype=np.float64)


def read_range_curve(
    at: Float64Array, angles: Float64Array, counts: IntArray, base_rate: float, kernel: Kernel
) -> Float64Array:
    """Read the probability of observations off the counts of references by one range alone.

    Parameters
    ----------
    at : ndarray of shape (m,)
        Angles of the observations.
    angles : ndarray of shape (n,)
        Angles of the references; at least one.
    counts : ndarray of shape (n, 2)
        Negatives and positives of the references.
    base_rate : float
        Where nothing is near.
    kernel : Kernel
        Its width and pseudo-counts; all references are asked.

    Returns
    -------
    ndarray of shape (m,)
        Probabilities that do not fall with the angle.

    Notes
    -----
    At 64 angles from the least to the greatest of the references their counts weigh
    exp(-d^2 / 2 theta^2), where d^2 = 1 - cos(difference) is equation 7 of two such
    blocks. Isotonic regression, weighted by what was counted, makes the curve rise;
    between the angles it is linear, beyond them constant.
    """
    grid = np.linspace(angles.min(), angles.max(), N_ANGLES)
    squared = 1.0 - np.cos(grid[:, None] - angles)
    weighted = np.exp(squared / (-2.0 * kernel.theta**2)) @ counts
    total = weighted.sum(axis=1) + kernel.prior_counts
    raw = (weighted[:, 1] + kernel.prior_counts * base_rate) / total
    return np.interp(at, grid, rising(raw, total))


def rising(values: Float64Array, weights: Float64Array) -> Float64Array:
    """Return the nearest values, by weighted squares, that do not fall (isotonic regression).

    Parameters
    ----------
    values, weights : ndarray of shape (n,)
        Weights above 0.

    Examples
    --------
    >>> rising(np.array([1.0, 3.0, 2.0, 4.0]), np.ones(4)).tolist()
    [1.0, 2.5, 2.5, 4.0]
    """
    pools: list[tuple[float, float, int]] = []
    for value, weight in zip(values.tolist(), weights.tolist(), strict=True):
        pool = (value, weight, 1)
        while pools and pools[-1][0] >= pool[0]:
            mean, before, size = pools.pop()
            both = before + pool[1]
            pool = ((mean * before + pool[0] * pool[1]) / both, both, size + pool[2])
        pools.append(pool)
    return np.repeat([mean for mean, _, _ in pools], [size for _, _, size in pools])


def join(read: Float64Array, curves: Sequence[Float64Array], share: float) -> Float64Array:
    """Join a read-out and the curves: log odds, the curves together weigh ``share``.

    Parameters
    ----------
    read : ndarray of shape (m,)
        Probabilities above 0 and below 1.
    curves : sequence of ndarray of shape (m,)
        The same of one curve each; at least one.
    share : float
        In [0, 1].

    Examples
    --------
    >>> join(np.array([0.5]), [np.array([0.8])], 0.5).round(3).tolist()
    [0.667]
    """
    of_curves = np.mean([_log_odds(curve) for curve in curves], axis=0)
    together = (1 - share) * _log_odds(read) + share * of_curves
    return np.asarray(1.0 / (1.0 + np.exp(-together)), dtype=np.float64)


def _log_odds(p: Float64Array) -> Float64Array:
    odds: Float64Array = np.log(p) - np.log1p(-p)
    return odds
