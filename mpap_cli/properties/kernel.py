"""A probability out of the counts of near references, the nearer the weightier."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import Float64Array, IntArray


def k_nearest(squared: Float64Array, k: int) -> IntArray:
    """Find the k smallest of each row; among equal ones those that come first.

    Parameters
    ----------
    squared : ndarray of shape (m, n)
        Without NaN.
    k : int
        1 or more; all columns are found if there are fewer.

    Returns
    -------
    ndarray of shape (m, min(k, n))
        Columns, ascending.

    Examples
    --------
    >>> k_nearest(np.array([[3.0, 1.0, 1.0, 0.0, 1.0]]), 2).tolist()
    [[1, 3]]
    """
    n = squared.shape[1]
    if n <= k:
        return np.tile(np.arange(n), (squared.shape[0], 1))
    border = np.partition(squared, k - 1, axis=1)[:, k - 1 : k]
    chosen = squared <= border
    too_many = np.flatnonzero(chosen.sum(axis=1) > k)
    ties = squared[too_many] == border[too_many]
    nearer = chosen[too_many] & ~ties
    free = k - nearer.sum(axis=1, keepdims=True)
    chosen[too_many] = nearer | (ties & (np.cumsum(ties, axis=1) <= free))
    return np.nonzero(chosen)[1].reshape(squared.shape[0], k)


@dataclass(frozen=True, slots=True)
class Kernel:
    """Width (a distance), neighbors asked, and pseudo-counts at the base rate."""

    theta: float
    neighbors: int
    prior_counts: float


def kernel_mean(
    squared: Float64Array, counts: IntArray, base_rate: float, kernel: Kernel
) -> Float64Array:
    """Return the mean of the counts of the nearest references, the nearer the weightier.

    Parameters
    ----------
    squared : ndarray of shape (m, n)
        Squared distances of m observations to n references.
    counts : ndarray of shape (n, 2)
        Negatives and positives of the references.
    base_rate : float
        Where nothing is near.
    kernel : Kernel
        Weights exp(-d^2 / 2 theta^2).

    Returns
    -------
    ndarray of shape (m,)
        Probabilities.
    """
    nearest = k_nearest(squared, kernel.neighbors)
    return mean_of_counts(
        np.take_along_axis(squared, nearest, axis=1), counts[nearest], base_rate, kernel
    )


def mean_of_counts(
    squared: Float64Array, counts: IntArray | Float64Array, base_rate: float, kernel: Kernel
) -> Float64Array:
    """Return the mean of the counts of references that were found, the nearer the weightier.

    Parameters
    ----------
    squared : ndarray of shape (m, k)
        Squared distances of m observations to k references each.
    counts : ndarray of shape (m, k, 2)
        Negatives and positives of these references.
    base_rate : float
        Where nothing is near.
    kernel : Kernel
        Weights exp(-d^2 / 2 theta^2).

    Returns
    -------
    ndarray of shape (m,)
        Probabilities.
    """
    weights = np.exp(squared / (-2.0 * kernel.theta**2))
    positive = (weights * counts[:, :, 1]).sum(axis=1) + kernel.prior_counts * base_rate
    total = (weights * counts.sum(axis=2)).sum(axis=1) + kernel.prior_counts
    return np.asarray(positive / total, dtype=np.float64)
