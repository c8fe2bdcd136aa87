"""Read-outs turn distances into probabilities."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.classifier import READOUTS, classify
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.distance import embed
from mpap_cli.observations import Float32Array
from mpap_cli.params import READOUTS as READOUT_NAMES
from mpap_cli.params import AffinityParams, MetaPointParams, PropertyParams
from mpap_cli.properties.counts import ClusteredPoints, cluster_counts
from mpap_cli.properties.kernel import k_nearest

THETA = 0.1


def histograms(n: int, seed: int) -> Float32Array:
    """Return embedded histograms around some centers."""
    random = np.random.default_rng(seed)
    centers = random.uniform(0, 5, size=(40, 5))
    rows = centers[random.integers(40, size=n)] * random.uniform(0.7, 1.4, size=(n, 5))
    return embed(rows.astype(np.float32)).astype(np.float32)


def learnt(
    features: Float32Array, positive: np.ndarray | None = None, **meta: float
) -> tuple[MetaPoints, ClusteredPoints]:
    """Return meta-points and clusters; contact labels only where they are given."""
    params = MetaPointParams(theta=THETA, min_points=int(meta.get("min_points", 3)))
    points = MetaPoints(params, features.shape[1])
    ids, _ = points.add_data_points(features, np.arange(features.shape[0], dtype=np.int64))
    if positive is not None:
        points.add_counts(ids, 0, positive)
    clustering = points.cluster(AffinityParams())
    return points, ClusteredPoints(clustering, points.ids[points.is_cluster_point])


def reference(
    points: MetaPoints, clustered: ClusteredPoints, params: PropertyParams, row: Float32Array
) -> dict[str, float]:
    """Read one observation as the definitions say."""
    row64 = row.astype(np.float64)
    squared = 0.5 * ((points.references() - row64) ** 2).sum(axis=1)
    rows = points.rows_of(clustered.ids)
    labels, exemplars = clustered.clustering.labels, rows[clustered.clustering.exemplars]
    counts = points.counts[:, 0]
    base = counts[:, 1].sum() / counts.sum()
    to_exemplars = 0.5 * ((points.exemplars[exemplars].astype(np.float64) - row64) ** 2).sum(axis=1)
    by_exemplar, by_point = int(np.argmin(to_exemplars)), int(np.argmin(squared[rows]))
    cluster = by_exemplar if params.readout == "exemplar" else int(labels[by_point])
    inside = counts[rows[labels == cluster]].sum(axis=0)
    rate = inside[1] / inside.sum() if inside.sum() else base
    own = counts[rows[by_point]]
    m = params.metapoint_prior
    nearest = np.argsort(squared, kind="stable")[: params.kernel_k]
    weights = np.exp(-squared[nearest] / (2 * THETA**2))
    above = (weights * counts[nearest, 1]).sum() + params.prior_counts * base
    below = (weights * counts[nearest].sum(axis=1)).sum() + params.prior_counts
    read = {
        "exemplar": rate,
        "cluster": rate,
        "metapoint": (own[1] + m * rate) / (own.sum() + m),
        "kernel": above / below,
    }
    return {
        "cluster": cluster,
        "distance": math.sqrt(squared.min()),
        "novel": float(math.sqrt(squared[points.is_cluster_point].min()) >= THETA),
        "p_cluster": rate,
        "p_collision": read[params.readout],
    }


@pytest.mark.parametrize("readout", READOUT_NAMES)
@pytest.mark.parametrize("labelled_share", [1.0, 0.05])
def test_a_block_reads_as_its_observations_one_by_one(readout: str, labelled_share: float) -> None:
    """Every read-out equals its definition, also where most clusters have no label."""
    features = histograms(400, seed=1)
    points, clustered = learnt(features)
    random = np.random.default_rng(2)
    labelled = points.ids[random.random(points.n_points) < labelled_share]
    assert labelled.size
    points.add_counts(np.repeat(labelled, 4), 0, random.random(4 * labelled.size) < 0.3)
    params = PropertyParams(readout=readout, kernel_k=7)
    asked = histograms(700, seed=3)

    found = classify(points, clustered, params, 0, asked)

    wanted = [reference(points, clustered, params, row) for row in asked]
    assert found.cluster.tolist() == [row["cluster"] for row in wanted]
    assert found.novel.tolist() == [bool(row["novel"]) for row in wanted]
    for name in ("distance", "p_cluster", "p_collision"):
        expected = [row[name] for row in wanted]
        np.testing.assert_allclose(getattr(found, name), expected, rtol=1e-9, atol=1e-12)


def test_the_read_outs_are_those_of_the_settings() -> None:
    """No name can be chosen that does not exist."""
    assert tuple(READOUTS) == READOUT_NAMES


def test_blocks_of_any_size_read_the_same() -> None:
    """The same bytes, whatever the observations come together with."""
    features = histograms(300, seed=4)
    points, clustered = learnt(features, np.arange(300) % 5 == 0)
    asked = histograms(1100, seed=5)

    whole = classify(points, clustered, PropertyParams(), 0, asked)
    parts = [
        classify(points, clustered, PropertyParams(), 0, asked[start : start + 37])
        for start in range(0, 1100, 37)
    ]

    assert whole.p_collision.tobytes() == b"".join(part.p_collision.tobytes() for part in parts)
    assert whole.distance.tobytes() == b"".join(part.distance.tobytes() for part in parts)


@pytest.mark.parametrize("readout", READOUT_NAMES)
def test_without_labels_there_is_no_probability(readout: str) -> None:
    """Clusters and novelty are known all the same."""
    points, clustered = learnt(histograms(200, seed=6))

    found = classify(points, clustered, PropertyParams(readout=readout), 0, histograms(10, seed=6))

    assert np.isnan(found.p_collision).all()
    assert np.isnan(found.p_cluster).all()
    assert (found.cluster >= 0).all()


@pytest.mark.parametrize("readout", READOUT_NAMES)
def test_without_cluster_points_the_base_rate_stands_in(readout: str) -> None:
    """Only the kernel looks at noise-points."""
    features = histograms(12, seed=7)
    points, clustered = learnt(features, np.arange(12) < 3, min_points=99)

    found = classify(points, clustered, PropertyParams(readout=readout), 0, features)

    assert found.cluster.tolist() == [-1] * 12
    assert found.novel.all()
    assert found.p_cluster.tolist() == [0.25] * 12
    assert (set(found.p_collision.tolist()) == {0.25}) == (readout != "kernel")


@pytest.mark.parametrize("readout", READOUT_NAMES)
def test_an_empty_model_knows_nothing(readout: str) -> None:
    """Everything is infinitely far and new."""
    points, clustered = learnt(histograms(0, seed=8))

    found = classify(points, clustered, PropertyParams(readout=readout), 0, histograms(3, seed=8))

    assert found.cluster.tolist() == [-1] * 3
    assert found.distance.tolist() == [np.inf] * 3
    assert found.novel.all()
    assert np.isnan(found.p_collision).all()


def test_no_observations_give_an_empty_prediction() -> None:
    """All arrays have length 0."""
    points, clustered = learnt(histograms(50, seed=9), np.arange(50) < 5)

    found = classify(points, clustered, PropertyParams(), 0, histograms(0, seed=9))

    lengths = {getattr(found, name).shape for name in ("cluster", "novel", "p_collision")}
    assert lengths == {(0,)}


def test_a_metapoint_without_prior_and_without_labels_reads_its_cluster() -> None:
    """Nothing is divided by nothing."""
    features = histograms(200, seed=10)
    points, clustered = learnt(features)
    points.add_counts(clustered.ids[:1], 0, np.array([True]))
    params = PropertyParams(readout="metapoint", metapoint_prior=0.0)

    found = classify(points, clustered, params, 0, features)

    assert set(found.p_collision.tolist()) == {1.0}


def test_cluster_points_made_since_the_clustering_do_not_shift_it() -> None:
    """Clusters know their cluster-points by id; new ones only end novelty."""
    features = histograms(300, seed=11)
    points, clustered = learnt(features[:150], np.arange(150) < 20)
    before = cluster_counts(points, clustered, 0)

    points.add_data_points(features[150:], np.arange(150, 300, dtype=np.int64))
    found = classify(points, clustered, PropertyParams(readout="cluster"), 0, features)

    assert cluster_counts(points, clustered, 0).tolist() == before.tolist()
    assert found.cluster.max() < clustered.n_clusters
    assert clustered.ids.size < points.is_cluster_point.sum()


def test_clusters_are_found_by_id() -> None:
    """Ids of noise-points and of no meta-point have none."""
    points, clustered = learnt(histograms(300, seed=12))

    found = clustered.clusters_of(np.append(points.ids, [10**9, -5]))

    wanted = np.full(points.n_points, -1)
    wanted[points.is_cluster_point] = clustered.clustering.labels
    assert found.tolist() == [*wanted.tolist(), -1, -1]


@given(
    st.lists(st.lists(st.integers(0, 3), min_size=6, max_size=6), min_size=1, max_size=5),
    st.integers(1, 8),
)
def test_of_equal_distances_the_first_are_nearest(rows: list[list[int]], k: int) -> None:
    """As a stable sort would choose them."""
    squared = np.array(rows, dtype=np.float64)

    found = k_nearest(squared, k)

    wanted = np.sort(np.argsort(squared, axis=1, kind="stable")[:, :k], axis=1)
    assert found.tolist() == wanted.tolist()
