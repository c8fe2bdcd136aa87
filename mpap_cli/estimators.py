"""Estimators for scikit-learn: affinity propagation and meta-point affinity propagation.

They fit wherever scikit-learn's clusterers do: pipelines, grid searches, ``clone``.
"""

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, ClusterMixin
from sklearn.neighbors import NearestNeighbors
from sklearn.utils.validation import check_is_fitted, validate_data

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.distance import similarities
from mpap_cli.observations import Float32Array, Float64Array, IntArray
from mpap_cli.params import AffinityParams, MetaPointParams

__all__ = ["AffinityPropagation", "MetaPointAffinityPropagation"]

_NEIGHBOR, _NEAR_SHARE, _MOST_SAMPLED = 5, 0.7, 1000


class AffinityPropagation(ClusterMixin, BaseEstimator):  # type: ignore[misc]  # sklearn has no types
    """Affinity propagation over all points (section 3.2; Frey and Dueck 2007).

    Parameters
    ----------
    preference : str or float, default="median"
        Self-similarity: median, min, quantile:Q, range:F or a number.
    damping : float, default=0.9
        Share of the old message that is kept, 0.5 up to below 1.
    max_iter, convergence_iter : int, default=1000, 50
        Most iterations of one run, and how many without a change end it.
    random_state : int, default=0
        Seed of the jitter that breaks ties.

    Attributes
    ----------
    labels_ : ndarray of shape (n,)
        Cluster of each point.
    cluster_centers_indices_ : ndarray of shape (k,)
        Rows of the exemplars.
    cluster_centers_ : ndarray of shape (k, d)
        The exemplars.
    n_iter_ : int
        Iterations.
    converged_ : bool
        Whether the last run ended by itself.

    Examples
    --------
    >>> x = np.array([[0.0], [0.1], [0.2], [5.0], [5.1], [5.2]])
    >>> AffinityPropagation().fit_predict(x).tolist()
    [0, 0, 0, 1, 1, 1]
    """

    def __init__(
        self,
        *,
        preference: str | float = "median",
        damping: float = 0.9,
        max_iter: int = 1000,
        convergence_iter: int = 50,
        random_state: int = 0,
    ) -> None:
        self.preference = preference
        self.damping = damping
        self.max_iter = max_iter
        self.convergence_iter = convergence_iter
        self.random_state = random_state

    def fit(self, X: ArrayLike, y: object = None) -> Self:  # noqa: ARG002, N803  # sklearn's names
        """Cluster points (n, d); ``y`` is not looked at."""
        points = validate_data(self, X, dtype=np.float64)
        s = similarities(points, "neg-squared", normalized=False)
        params = _affinity(self)
        found = affinity_propagation(s, resolve_preference(s, params.preference), params)
        self.labels_ = found.labels
        self.cluster_centers_indices_ = found.exemplars
        self.cluster_centers_ = points[found.exemplars]
        self.n_iter_, self.converged_ = found.n_iter, found.converged
        return self

    def predict(self, X: ArrayLike) -> IntArray:  # noqa: N803  # sklearn's name
        """Return the cluster (m,) of the exemplar nearest to each point (m, d)."""
        check_is_fitted(self)
        points = validate_data(self, X, dtype=np.float64, reset=False)
        return _nearest(points, self.cluster_centers_)


class MetaPointAffinityPropagation(ClusterMixin, BaseEstimator):  # type: ignore[misc]
    """Meta-point affinity propagation, one point after the other (section 3.4, Algorithm 1).

    Points come in any number of calls of ``partial_fit``; memory grows with what is seen
    anew, not with the points.

    Parameters
    ----------
    theta : float, default=None
        Radius of a meta-point. None: the distance within which 70 % of the points of the
        first call have their fifth neighbor.
    min_points : int, default=2
        Points that make a noise-point a cluster-point.
    preference : str or float, default="median"
        Self-similarity of cluster-points, as in :class:`AffinityPropagation`.
    damping, max_iter, convergence_iter, random_state
        As in :class:`AffinityPropagation`.

    Attributes
    ----------
    labels_ : ndarray of shape (n,)
        Cluster of each point of the last call; -1 where no cluster-point is known.
    cluster_centers_ : ndarray of shape (k, d)
        Means of the exemplars among the cluster-points.
    theta_ : float
        Radius in use.
    n_iter_ : int
        Iterations over the cluster-points, 1 at least.
    n_meta_points_, n_cluster_points_ : int
        What is remembered, and how much of it was seen often enough.

    Notes
    -----
    Coordinates are kept as float32; clusters are numbered anew at each call.

    Examples
    --------
    >>> x = np.array([[0.0], [0.1], [1.0], [1.1], [7.0], [7.1], [8.0], [8.1]])
    >>> MetaPointAffinityPropagation(theta=0.5).fit_predict(x).tolist()
    [0, 0, 0, 0, 1, 1, 1, 1]
    """

    def __init__(  # noqa: PLR0913  # scikit-learn wants every setting here
        self,
        *,
        theta: float | None = None,
        min_points: int = 2,
        preference: str | float = "median",
        damping: float = 0.9,
        max_iter: int = 1000,
        convergence_iter: int = 50,
        random_state: int = 0,
    ) -> None:
        self.theta = theta
        self.min_points = min_points
        self.preference = preference
        self.damping = damping
        self.max_iter = max_iter
        self.convergence_iter = convergence_iter
        self.random_state = random_state

    def fit(self, X: ArrayLike, y: object = None) -> Self:  # noqa: N803  # sklearn's names
        """Forget what was known and cluster points (n, d) in their order."""
        if self.__sklearn_is_fitted__():
            del self._points
        return self.partial_fit(X, y)

    def partial_fit(self, X: ArrayLike, y: object = None) -> Self:  # noqa: ARG002, N803
        """Add points (n, d) in their order to those known, and cluster anew."""
        is_first = not self.__sklearn_is_fitted__()
        points: Float32Array = validate_data(self, X, dtype=np.float32, reset=is_first)
        if is_first:
            self.theta_ = _theta_of(points) if self.theta is None else self.theta
            params = MetaPointParams(theta=self.theta_, min_points=self.min_points)
            self._points = MetaPoints(params, points.shape[1], normalized=False)
            self._n_seen = 0
        stamps_ns = np.arange(self._n_seen, self._n_seen + len(points))
        self._points.add_data_points(points, stamps_ns)
        self._n_seen += len(points)
        self._cluster()
        self.labels_ = self.predict(X)
        return self

    def _cluster(self) -> None:
        """Run affinity propagation over the cluster-points."""
        found = self._points.cluster(_affinity(self))
        references = self._points.references()[self._points.is_cluster_point]
        self._references, self._clusters = references.astype(np.float64), found.labels
        self.cluster_centers_ = self._references[found.exemplars]
        self.n_iter_ = max(1, found.n_iter)
        self.n_meta_points_ = self._points.n_points
        self.n_cluster_points_ = len(references)

    def predict(self, X: ArrayLike) -> IntArray:  # noqa: N803  # sklearn's name
        """Return the cluster (m,) of the cluster-point nearest to each point (m, d), -1: none."""
        check_is_fitted(self)
        points = validate_data(self, X, dtype=np.float32, reset=False)
        if not self.n_cluster_points_:
            return np.full(len(points), -1, dtype=np.int64)
        rows = _nearest(points.astype(np.float64), self._references)
        return np.asarray(self._clusters[rows], dtype=np.int64)

    def __sklearn_is_fitted__(self) -> bool:
        return "_points" in vars(self)


def _affinity(estimator: Any) -> AffinityParams:
    """Return the settings of an estimator; a wrong one raises a ValueError."""
    return AffinityParams(
        damping=estimator.damping,
        max_iter=estimator.max_iter,
        convergence_iter=estimator.convergence_iter,
        preference=str(estimator.preference),
        seed=estimator.random_state,
    )


def _theta_of(points: Float32Array) -> float:
    """Return the distance within which 70 % of the points have their fifth neighbor."""
    step = max(1, len(points) // _MOST_SAMPLED)
    n_neighbors = min(_NEIGHBOR, len(points) - 1)
    if n_neighbors < 1:
        return 1.0
    distances, _ = NearestNeighbors(n_neighbors=n_neighbors).fit(points).kneighbors()
    return max(float(np.quantile(distances[::step, -1], _NEAR_SHARE)), 1e-9)


def _nearest(points: Float64Array, centers: Float64Array) -> IntArray:
    """Return the row of the nearest center of each point, of equals the first."""
    gaps = NearestNeighbors(n_neighbors=1).fit(centers)
    return np.asarray(gaps.kneighbors(points, return_distance=False)[:, 0], dtype=np.int64)
