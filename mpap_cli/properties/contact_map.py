"""From the probability of an onset to that of a contact: a strictly rising map.

Onsets are rarer than contacts, and the counts of contacts are distorted by long holds.
So onsets rank the observations, and contacts only say how large the probabilities are.
"""

from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import Float64Array, IntArray

SMALLEST_SLOPE = 0.05
_RIDGE = 1.0
_ROUNDS = 100
_TOLERANCE = 1e-10


@dataclass(frozen=True, slots=True)
class ContactMap:
    """p' = sigmoid(slope * logit(p) + offset), with a slope above zero.

    Examples
    --------
    >>> ContactMap(1.0, 0.0).apply(np.array([0.0, 0.25, 1.0])).tolist()
    [0.0, 0.25, 1.0]
    """

    slope: float = 1.0
    offset: float = 0.0

    def apply(self, probabilities: Float64Array) -> Float64Array:
        """Map probabilities of any shape; 0, 1 and NaN stay what they are."""
        inner = (probabilities > 0) & (probabilities < 1)
        mapped = probabilities.copy()
        mapped[inner] = _sigmoid(self.slope * _logit(probabilities[inner]) + self.offset)
        return mapped


def fit_contact_map(probabilities: Float64Array, counts: IntArray) -> ContactMap:
    """Fit the map by logistic regression on counts, drawn a little towards no change.

    Parameters
    ----------
    probabilities : ndarray of shape (n,)
        Probability of an onset as the model reads it at n points.
    counts : ndarray of shape (n, 2)
        Negative and positive contact labels at these points.

    Returns
    -------
    ContactMap
        The map without change if there are not both kinds of labels.

    Notes
    -----
    The prior, half the squared step away from slope 1 and offset 0, keeps the fit finite
    where the labels are separable. A slope below 0.05 (probabilities that say nothing
    about contact, or the contrary) is held there, so that the order never turns.

    Examples
    --------
    >>> fitted = fit_contact_map(np.array([0.1, 0.2]), np.array([[800, 200], [600, 400]]))
    >>> fitted.apply(np.array([0.1, 0.2])).round(2).tolist()
    [0.2, 0.4]
    """
    usable = (probabilities > 0) & (probabilities < 1) & (counts.sum(axis=1) > 0)
    used = counts[usable].astype(np.float64)
    if not used.size or used.sum(axis=0).min() == 0:
        return ContactMap()
    x = _logit(probabilities[usable])
    slope, offset = _newton(x, used, free_slope=True, start=(1.0, 0.0))
    if slope < SMALLEST_SLOPE:
        slope, offset = _newton(x, used, free_slope=False, start=(SMALLEST_SLOPE, 0.0))
    return ContactMap(slope, offset)


def _newton(
    x: Float64Array, counts: Float64Array, *, free_slope: bool, start: tuple[float, float]
) -> tuple[float, float]:
    """Minimise the loss by Newton's steps, each halved until the loss falls."""
    theta = np.array(start)
    design = np.stack([x if free_slope else np.zeros_like(x), np.ones_like(x)], axis=1)
    total, positive = counts.sum(axis=1), counts[:, 1]
    loss = _loss(theta, x, counts)
    for _ in range(_ROUNDS):
        p = _sigmoid(theta[0] * x + theta[1])
        gradient = design.T @ (total * p - positive)
        gradient += _RIDGE * (theta - (1.0, 0.0)) * (float(free_slope), 1.0)
        hessian = (design.T * (total * p * (1 - p))) @ design + _RIDGE * np.eye(2)
        step = np.linalg.solve(hessian, gradient)
        while np.abs(step).max() > _TOLERANCE and _loss(theta - step, x, counts) > loss:
            step = step / 2
        if np.abs(step).max() <= _TOLERANCE:
            break
        theta = theta - step
        loss = _loss(theta, x, counts)
    return float(theta[0]), float(theta[1])


def _loss(theta: Float64Array, x: Float64Array, counts: Float64Array) -> float:
    """Negative log likelihood plus the prior."""
    z = theta[0] * x + theta[1]
    likelihood = counts[:, 1] @ np.logaddexp(0, -z) + counts[:, 0] @ np.logaddexp(0, z)
    return float(likelihood + _RIDGE / 2 * ((theta - (1.0, 0.0)) ** 2).sum())


def _logit(p: Float64Array) -> Float64Array:
    odds: Float64Array = np.log(p) - np.log1p(-p)
    return odds


def _sigmoid(z: Float64Array) -> Float64Array:
    """Return 1 / (1 + exp(-z)) without overflow."""
    small = np.exp(-np.abs(z))
    p: Float64Array = np.where(z >= 0, 1.0, small) / (1.0 + small)
    return p
