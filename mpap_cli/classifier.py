"""Classification: what the nearest clusters or meta-points tell of an observation (2.4).

A read-out turns the distances of an observation into a probability:

``exemplar``
    share of positives in the cluster of the nearest exemplar of affinity propagation,
    the paper's nearest neighbor with equation 8;
``cluster``
    the same for the cluster of the nearest cluster-point;
``metapoint``
    counts of the nearest cluster-point itself, with some pseudo-counts at the rate of
    its cluster;
``kernel``
    counts of the nearest meta-points, noise-points included, each weighing
    exp(-d^2 / (2 theta^2)), with some pseudo-counts at the base rate.

The base rate is the share of positives over all meta-points. It also stands in where a
cluster holds no label and where there is no cluster; without any label the probability
is NaN. Distances are compared in float64, equal ones in order of creation.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.distance import squared_distances
from mpap_cli.observations import (
    BoolArray,
    Float32Array,
    Float64Array,
    FloatArray,
    IntArray,
    Prediction,
)
from mpap_cli.params import PropertyParams
from mpap_cli.properties.counts import ClusteredPoints, cluster_counts, ratio
from mpap_cli.properties.kernel import Kernel, kernel_mean
from mpap_cli.properties.nearest_points import NearestPoints

_MOST_ROWS = 512
_MOST_DISTANCES = 1 << 18


@dataclass(frozen=True, slots=True, eq=False)
class _Model:
    """What a read-out looks at: meta-points (n), clustered ones (p) and clusters (k).

    Those that it does not look at are ``others``. ``is_cluster_point`` (n,); ``counts``
    (n, 2); ``rows`` (p,) of the clustered ones among the meta-points and ``labels`` (p,),
    their clusters; ``exemplars`` (k, d); ``cluster_rate`` (k,), the base rate where a
    cluster has no label.
    """

    references: Float64Array
    others: NearestPoints
    is_cluster_point: BoolArray
    counts: IntArray
    rows: IntArray
    labels: IntArray
    exemplars: Float32Array
    cluster_rate: Float64Array
    base_rate: float
    params: PropertyParams
    theta: float


@dataclass(frozen=True, slots=True, eq=False)
class _Readings:
    """Squared distances (m, n) of m observations to the meta-points, and what is nearest.

    ``point`` (m,) is the nearest clustered point, ``cluster`` (m,) the nearest cluster as
    the read-out takes it; both are -1 where there are none.
    """

    squared: Float64Array
    point: IntArray
    cluster: IntArray


def _of_cluster(model: _Model, readings: _Readings) -> Float64Array:
    """Read the rate of the cluster."""
    return _rate_of(model, readings.cluster)


def _of_metapoint(model: _Model, readings: _Readings) -> Float64Array:
    """Read the counts of the nearest cluster-point, shrunk to its cluster (section 4.2.5)."""
    rate = _rate_of(model, readings.cluster)
    counts = np.zeros((readings.point.size, 2), dtype=np.int64)
    known = readings.point >= 0
    counts[known] = model.counts[model.rows[readings.point[known]]]
    prior = model.params.metapoint_prior
    total = counts.sum(axis=1) + prior
    shrunk: Float64Array = (counts[:, 1] + prior * rate) / np.where(total > 0, total, 1.0)
    return np.where(total > 0, shrunk, rate)


def _of_kernel(model: _Model, readings: _Readings) -> Float64Array:
    """Read the mean of the counts of the nearest meta-points, the nearer the weightier."""
    kernel = Kernel(model.theta, model.params.kernel_k, model.params.prior_counts)
    return kernel_mean(readings.squared, model.counts, model.base_rate, kernel)


READOUTS: dict[str, Callable[[_Model, _Readings], Float64Array]] = {
    "exemplar": _of_cluster,
    "cluster": _of_cluster,
    "metapoint": _of_metapoint,
    "kernel": _of_kernel,
}


def classify(
    meta_points: MetaPoints,
    clustered: ClusteredPoints,
    params: PropertyParams,
    pair: int,
    features: FloatArray,
) -> Prediction:
    """Classify observations by their distances to what was learnt (section 2.4).

    Parameters
    ----------
    meta_points : MetaPoints
        With counted labels.
    clustered : ClusteredPoints
        Clusters over its cluster-points.
    params : PropertyParams
        The read-out and its pseudo-counts.
    pair : int
        Pair of counts to read: 0 contact, 1 onset, 2 early.
    features : ndarray of shape (m, d)
        Embedded observations.

    Returns
    -------
    Prediction
        ``p_cluster`` is the share of positives in the cluster, ``p_collision`` the
        read-out; ``alarm`` is NaN here. Without meta-points the distance is infinite; without
        clusters the cluster is -1. Everything farther than theta from the cluster-points is novel.
    """
    model = _model(meta_points, clustered, params, pair)
    rows = max(1, min(_MOST_ROWS, _MOST_DISTANCES // max(1, model.counts.shape[0])))
    parts = [
        _classify_chunk(model, features[start : start + rows])
        for start in range(0, max(1, features.shape[0]), rows)
    ]
    return Prediction(
        cluster=np.concatenate([part.cluster for part in parts]),
        distance=np.concatenate([part.distance for part in parts]),
        novel=np.concatenate([part.novel for part in parts]),
        p_cluster=np.concatenate([part.p_cluster for part in parts]),
        p_collision=np.concatenate([part.p_collision for part in parts]),
        alarm=np.full(features.shape[0], np.nan),
    )


def _model(
    meta_points: MetaPoints, clustered: ClusteredPoints, params: PropertyParams, pair: int
) -> _Model:
    """Gather the arrays that the read-outs look at."""
    counts = meta_points.counts[:, pair]
    base_rate = float(ratio(counts.sum(axis=0)))
    rate = ratio(cluster_counts(meta_points, clustered, pair))
    rows = meta_points.rows_of(clustered.ids)
    references, is_cluster_point = meta_points.references(), meta_points.is_cluster_point
    seen = is_cluster_point | (params.readout == "kernel")
    return _Model(
        references=references[seen],
        others=NearestPoints(references[~seen]),
        is_cluster_point=is_cluster_point[seen],
        counts=counts[seen],
        rows=np.searchsorted(np.flatnonzero(seen), rows),
        labels=clustered.clustering.labels,
        exemplars=meta_points.exemplars[rows[clustered.clustering.exemplars]],
        cluster_rate=np.where(np.isnan(rate), base_rate, rate),
        base_rate=base_rate,
        params=params,
        theta=meta_points.params.theta,
    )


def _classify_chunk(model: _Model, features: FloatArray) -> Prediction:
    """Classify a few observations at once."""
    squared = squared_distances(features, model.references)
    least = np.minimum(squared.min(axis=1, initial=np.inf), model.others.least_squared(features))
    to_cluster_points = squared[:, model.is_cluster_point].min(axis=1, initial=np.inf)
    point = _nearest(squared[:, model.rows])
    if model.params.readout == "exemplar":
        cluster = _nearest(squared_distances(features, model.exemplars))
    else:
        cluster = np.append(model.labels, -1)[point]
    readings = _Readings(squared, point, cluster)
    return Prediction(
        cluster=cluster,
        distance=np.sqrt(least),
        novel=~(to_cluster_points < model.theta**2),
        p_cluster=_rate_of(model, cluster),
        p_collision=READOUTS[model.params.readout](model, readings),
        alarm=np.full(point.size, np.nan),
    )


def _nearest(squared: Float64Array) -> IntArray:
    """Return the first smallest column of each row, -1 if there are no columns."""
    if not squared.shape[1]:
        return np.full(squared.shape[0], -1, dtype=np.int64)
    return np.asarray(squared.argmin(axis=1), dtype=np.int64)


def _rate_of(model: _Model, cluster: IntArray) -> Float64Array:
    """Return the rates of clusters, the base rate for cluster -1."""
    rates: Float64Array = np.append(model.cluster_rate, model.base_rate)[cluster]
    return rates
