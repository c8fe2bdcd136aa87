"""Peers from other packages: k-means, mean shift, HDBSCAN and DenStream (section 5.1.1).

Euclidean methods see embedded histograms, whose Euclidean distance is that of equation 7
times the root of two; k-means also the plain histograms.
"""

from typing import Any

import numpy as np

from mpap_cli.evaluation.clusterers.mean_shift import mean_shift
from mpap_cli.evaluation.clusterers.own import nearest_rows, theta_of_patches
from mpap_cli.evaluation.clusterers.records import (
    UNASSIGNED,
    ClustererSettings,
    ClusteringResult,
    LabelledPoints,
    timed,
)
from mpap_cli.observations import FloatArray, IntArray

BANDWIDTH_QUANTILE = 0.05
N_STARTS = 10
# DenStream fades what it has seen; a set of points is no stream that changes.
FADING = 1e-4
OUTLIER_SHARE = 0.5
FIRST_POINTS = 200


def k_means_of_histograms(points: LabelledPoints, seed: int) -> ClusteringResult:
    """Run k-means with the true number of classes on plain histograms."""
    return _k_means(np.square(points.features), points.n_classes, seed)


def k_means_of_points(points: LabelledPoints, seed: int) -> ClusteringResult:
    """Run k-means with the true number of classes on the points as they are."""
    return _k_means(points.features, points.n_classes, seed)


def _k_means(rows: FloatArray, n_clusters: int, seed: int) -> ClusteringResult:
    """Run k-means, the best of ten starts."""
    from sklearn.cluster import KMeans  # noqa: PLC0415  # start-up

    most = min(n_clusters, len(np.unique(rows, axis=0)))
    model = KMeans(most, n_init=N_STARTS, random_state=seed)
    labels, seconds = timed(lambda: model.fit_predict(rows))
    return _result(labels, most, seconds)


def shift_means(points: LabelledPoints) -> ClusteringResult:
    """Run mean shift; the bandwidth holds the nearest 5 % of the points, on average."""
    from sklearn.cluster import estimate_bandwidth  # noqa: PLC0415  # start-up

    def work() -> tuple[IntArray, int]:
        bandwidth = float(estimate_bandwidth(points.features, quantile=BANDWIDTH_QUANTILE))
        least = np.finfo(np.float32).eps  # copies have none
        return mean_shift(points.features, max(bandwidth, float(least)))

    (labels, clusters), seconds = timed(work)
    return _result(labels, clusters, seconds)


def cluster_by_density(points: LabelledPoints, *, with_noise: bool) -> ClusteringResult:
    """Run HDBSCAN with scikit-learn's settings.

    Its noise stays unassigned ``with_noise``, else it goes to the cluster of the point in a
    cluster that is nearest to it.
    """
    from sklearn.cluster import HDBSCAN  # noqa: PLC0415  # start-up

    def work() -> tuple[IntArray, float]:
        least = min(HDBSCAN().min_cluster_size, len(points.features))
        model = HDBSCAN(min_cluster_size=max(2, least), copy=True)
        found = np.asarray(model.fit_predict(points.features.astype(np.float64)), np.int64)
        member = found >= 0
        if not with_noise and member.any():
            rows, _ = nearest_rows(
                points.features, points.features[member], normalized=points.normalized
            )
            found = np.where(member, found, found[member][rows])
        return found, float(member.mean())

    (labels, coverage), seconds = timed(work)
    return _result(labels, int(labels.max()) + 1, seconds, coverage=coverage)


def cluster_stream(
    points: LabelledPoints, settings: ClustererSettings, seed: int
) -> ClusteringResult:
    """Run DenStream (Cao et al. 2006) as river has it; nothing fades.

    The radius of a micro-cluster and the points that make one are theta and ``min_points``
    of the meta-points. A point goes to the nearest cluster, as river predicts it; within the
    radius of a micro-cluster it is covered.
    """
    from river.cluster import DenStream  # noqa: PLC0415  # an extra

    theta = settings.meta_point.theta
    if settings.theta_from_points:
        theta = theta_of_patches(points.features, seed)
    radius = theta * np.sqrt(2.0) if points.normalized else theta
    stream = [dict(enumerate(row)) for row in points.features.astype(np.float64).tolist()]

    def work() -> tuple[FloatArray, FloatArray]:
        model: Any = DenStream(
            decaying_factor=FADING,
            beta=OUTLIER_SHARE,
            mu=max(settings.meta_point.min_points, 1 + 1 / OUTLIER_SHARE),
            epsilon=float(radius),
            n_samples_init=min(FIRST_POINTS, len(stream)),
        )
        for point in stream:
            model.learn_one(point)
        model.predict_one(stream[0])  # which makes clusters of the micro-clusters
        groups = model.clusters.values(), model.p_micro_clusters.values()
        centers, micro = ([list(one.center.values()) for one in group] for group in groups)
        n_dims = points.features.shape[1]
        return np.reshape(centers, (-1, n_dims)), np.reshape(micro, (-1, n_dims))

    (centers, micro), seconds = timed(work)
    labels, _ = nearest_rows(points.features, centers, normalized=False)
    _, squared = nearest_rows(points.features, micro, normalized=False)
    coverage = float(np.mean(squared <= radius**2))
    return _result(labels, len(centers), seconds, coverage=coverage, clustered_points=len(micro))


def _result(
    labels: IntArray,
    clusters: int,
    seconds: float,
    *,
    coverage: float | None = None,
    clustered_points: int | None = None,
) -> ClusteringResult:
    """Return clusters without exemplars."""
    return ClusteringResult(
        labels=np.maximum(np.asarray(labels, np.int64), UNASSIGNED),
        clusters=clusters,
        clustered_points=clustered_points,
        coverage=coverage,
        seconds=seconds,
    )
