"""Affinity propagation, meta-points and STRAP as clusterers of a set of points (section 5.1)."""

from dataclasses import replace

import numpy as np

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.clustering.preference import coarse_preference, resolve_preference
from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.distance import similarities, squared_distances
from mpap_cli.evaluation.clusterers.records import (
    UNASSIGNED,
    ClustererSettings,
    ClusteringResult,
    LabelledPoints,
    timed,
)
from mpap_cli.observations import (
    Clustering,
    Float32Array,
    Float64Array,
    FloatArray,
    IntArray,
)
from mpap_cli.params import MetaPointParams
from mpap_cli.systems.nearest import nearest_exemplars

NEAR_SHARE = 0.7
NEAR_NEIGHBOR = 5
LEAST_THETA, MOST_THETA = 0.08, 0.20
FIXED_THETA = 0.13

_MOST_SAMPLED = 1000
_DIGITS = 3
_BLOCK = 4096


def theta_of_patches(features: Float32Array, seed: int = 0) -> float:
    """Choose the radius of meta-points by how near to one another patches are (section 3.4).

    Parameters
    ----------
    features : ndarray of shape (n, d)
        Embedded histograms of image patches, of length 1, of the whole set: those that come
        first are of one place and lie too close together.
    seed : int
        Of the sample of 1,000 that is looked at where there are more.

    Returns
    -------
    float
        The distance within which 70 % of the points have their fifth neighbor, but 0.08 at
        least and 0.20 at most; three digits.

    Notes
    -----
    With less, most points stay noise; with more, classes merge inside meta-points and
    nothing parts them again. What 2 % of all pairs keep within is as good, but grows with
    the number of classes. A fixed 0.13 is as good on some photographs and finds hardly any
    cluster-point among surfaces that vary more.

    Examples
    --------
    >>> theta_of_patches(np.eye(3, dtype=np.float32))
    0.2
    """
    chosen = np.random.default_rng(seed).permutation(len(features))[:_MOST_SAMPLED]
    points = features[chosen].astype(np.float64)
    n = len(points)
    if n < 2:  # noqa: PLR2004
        return LEAST_THETA
    products = points @ points.T
    np.fill_diagonal(products, -np.inf)
    place = n - min(NEAR_NEIGHBOR, n - 1)
    neighbor = np.partition(products, place, axis=1)[:, place]
    squared = max(0.0, 1.0 - float(np.quantile(neighbor, 1.0 - NEAR_SHARE)))
    return float(round(np.clip(np.sqrt(squared), LEAST_THETA, MOST_THETA), _DIGITS))


def cluster_all_points(
    points: LabelledPoints, settings: ClustererSettings, *, coarse: bool
) -> ClusteringResult:
    """Run affinity propagation over all points (section 3.2).

    Parameters
    ----------
    points : LabelledPoints
        n points; time and memory grow with n^2.
    settings : ClustererSettings
        ``affinity``; its preference does not count.
    coarse : bool
        The preference is the median times n / 50, else the median.
    """

    def work() -> Clustering:
        rule = settings.affinity.similarity
        s = similarities(points.features, rule, normalized=points.normalized)
        preference = coarse_preference(s) if coarse else resolve_preference(s, "median")
        return affinity_propagation(s, preference, settings.affinity)

    found, seconds = timed(work)
    return ClusteringResult(
        labels=found.labels,
        clusters=len(found.exemplars),
        clustered_points=len(found.labels),
        coverage=None,
        seconds=seconds,
        exemplars=found.exemplars,
        converged=found.converged,
    )


def cluster_by_meta_points(
    points: LabelledPoints, settings: ClustererSettings, seed: int
) -> ClusteringResult:
    """Run meta-point affinity propagation (section 3.4).

    Every point gets the cluster of the cluster-point nearest to it; noise-points too.
    Without any cluster-point all are unassigned.
    """
    return _meta_points_within(points, settings, seed, theta=None)


def cluster_by_fixed_theta(
    points: LabelledPoints, settings: ClustererSettings, seed: int
) -> ClusteringResult:
    """Run it with theta 0.13, whatever the settings say."""
    return _meta_points_within(points, settings, seed, theta=FIXED_THETA)


def _meta_points_within(
    points: LabelledPoints, settings: ClustererSettings, seed: int, theta: float | None
) -> ClusteringResult:
    """Run meta-point affinity propagation with this theta, or that of the settings."""

    def work() -> tuple[MetaPoints, Clustering, IntArray]:
        params = settings.meta_point
        if theta is not None:
            params = replace(params, theta=theta)
        elif settings.theta_from_points:
            params = replace(params, theta=theta_of_patches(points.features, seed))
        return _by_meta_points(points, settings, params)

    (meta_points, found, labels), seconds = timed(work)
    members = meta_points.is_cluster_point
    return ClusteringResult(
        labels=labels,
        clusters=len(found.exemplars),
        clustered_points=int(members.sum()),
        coverage=float(meta_points.count[members].sum() / len(labels)),
        seconds=seconds,
        exemplars=meta_points.exemplar_stamp_ns[members][found.exemplars],
        converged=found.converged,
    )


def _by_meta_points(
    points: LabelledPoints, settings: ClustererSettings, params: MetaPointParams
) -> tuple[MetaPoints, Clustering, IntArray]:
    """Return the meta-points, the clusters of the cluster-points, the labels of all points.

    The stamp of a point is its row.
    """
    n, n_dims = points.features.shape
    meta_points = MetaPoints(params, n_dims, normalized=points.normalized)
    meta_points.add_data_points(points.features, np.arange(n))
    found = meta_points.cluster(settings.affinity)
    references = meta_points.references()[meta_points.is_cluster_point]
    rows, _ = nearest_rows(points.features, references, normalized=points.normalized)
    return meta_points, found, np.append(found.labels, UNASSIGNED)[rows]


def cluster_by_strap(
    points: LabelledPoints, settings: ClustererSettings, *, fine: bool
) -> ClusteringResult:
    """Run streaming affinity propagation (section 3.3).

    Parameters
    ----------
    points : LabelledPoints
        Embedded histograms.
    settings : ClustererSettings
        ``strap``; of ``affinity`` all but the preference.
    fine : bool
        Every exemplar is a cluster; else they are clustered once more, as in learning.

    Returns
    -------
    ClusteringResult
        Outliers that still wait at the end are taken in. Every point gets the cluster of
        the exemplar nearest to it; within ``eps`` of that it is covered.
    """

    def work() -> tuple[IntArray, Float64Array, TwoScale, Clustering | None]:
        n, n_dims = points.features.shape
        strap = TwoScale(settings.strap, settings.affinity, n_dims)
        strap.add_observations(points.features, np.arange(n), np.zeros(n, np.int64), 0)
        if strap.n_reservoir:
            strap.rebuild()
        rows, squared = nearest_rows(points.features, strap.exemplars, normalized=True)
        return rows, squared, strap, None if fine else strap.coarse()

    (rows, squared, strap, coarse), seconds = timed(work)
    exemplars = strap.exemplar_stamp_ns
    return ClusteringResult(
        labels=rows if coarse is None else coarse.labels[rows],
        clusters=len(exemplars) if coarse is None else len(coarse.exemplars),
        clustered_points=len(exemplars),
        coverage=float(np.mean(squared < settings.strap.eps**2)),
        seconds=seconds,
        exemplars=exemplars if coarse is None else exemplars[coarse.exemplars],
        converged=coarse is None or coarse.converged,
    )


def nearest_rows(
    points: Float32Array, references: FloatArray, *, normalized: bool
) -> tuple[IntArray, Float64Array]:
    """Return the row of the nearest reference and its squared distance, both (n,).

    Row -1 at distance inf where there is no reference.
    """
    if normalized or not len(references):
        rows, squared = nearest_exemplars(points, references.astype(np.float32), 1)
        return rows[:, 0], squared[:, 0]
    blocks = [
        squared_distances(points[at : at + _BLOCK], references, normalized=False)
        for at in range(0, len(points), _BLOCK)
    ]
    rows = np.concatenate([block.argmin(axis=1) for block in blocks])
    return rows, np.concatenate([block.min(axis=1) for block in blocks])
