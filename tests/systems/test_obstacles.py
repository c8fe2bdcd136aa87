"""The classifier of patches equals that of scikit-learn, and says what it does not know."""

import numpy as np
import pytest
from sklearn.neighbors import KNeighborsClassifier, KNeighborsRegressor, NearestNeighbors

from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.distance import embed
from mpap_cli.observations import Clustering, Float32Array, IntArray
from mpap_cli.params import AffinityParams, StrapParams, make_settings
from mpap_cli.properties.counts import ClusteredPoints
from mpap_cli.systems.appearance_parts import cluster_coarsely
from mpap_cli.systems.nearest import nearest_exemplars
from mpap_cli.systems.obstacles import (
    KnownExemplars,
    PatchClassifier,
    cluster_p_obstacle,
    known_patches,
    patch_classifier,
)


def points_of(n: int, seed: int, n_bins: int = 8) -> Float32Array:
    """Return embedded histograms."""
    random = np.random.default_rng(seed)
    return embed(random.gamma(0.5, size=(n, n_bins)).astype(np.float32)).astype(np.float32)


def classifier_of(exemplars: Float32Array, neighbors: int, seed: int) -> PatchClassifier:
    """Return a classifier with clusters and probabilities of its own for each exemplar."""
    random = np.random.default_rng(seed)
    known = KnownExemplars(exemplars, eps=0.3)
    cluster = random.integers(0, 4, size=len(exemplars))
    p, evidence = random.uniform(size=len(exemplars)), random.uniform(size=(len(exemplars), 2))
    return PatchClassifier(known, cluster, p, evidence, base_rate=0.5, neighbors=neighbors)


@pytest.mark.parametrize("k", [1, 3, 45, 50])
def test_neighbors_equal_those_of_scikit_learn(k: int) -> None:
    """The same exemplars at the same distances, by equation 7."""
    exemplars, asked = points_of(50, seed=1), points_of(300, seed=2)
    oracle = NearestNeighbors(n_neighbors=k, algorithm="brute").fit(exemplars.astype(np.float64))
    wanted, rows = oracle.kneighbors(asked.astype(np.float64))

    found, squared = nearest_exemplars(asked, exemplars, k)

    assert found.tolist() == rows.tolist()
    np.testing.assert_allclose(np.sqrt(2 * squared), wanted, atol=1e-7)


def test_one_neighbor_classifies_as_scikit_learn_does() -> None:
    """Clusters of patches are those of k-nearest neighbors with k = 1."""
    exemplars, asked = points_of(60, seed=3), points_of(360, seed=4)
    classifier = classifier_of(exemplars, 1, seed=5)
    oracle = KNeighborsClassifier(n_neighbors=1).fit(exemplars, classifier.cluster)

    found = classifier.classify(asked.reshape(10, 36, -1))

    assert found.cluster.ravel().tolist() == oracle.predict(asked).tolist()
    assert found.p_obstacle.shape == (10, 36)


def test_several_neighbors_are_averaged_as_scikit_learn_does() -> None:
    """Weighted by 1 / distance; an exemplar that is met exactly counts alone."""
    exemplars = points_of(60, seed=3)
    asked = np.concatenate([points_of(30, seed=4), exemplars[:6]])
    classifier = classifier_of(exemplars, 5, seed=5)
    oracle = KNeighborsRegressor(n_neighbors=5, weights="distance", algorithm="brute")
    oracle.fit(exemplars.astype(np.float64), classifier.p_obstacle)

    found = classifier.classify(asked[None])

    wanted = oracle.predict(asked.astype(np.float64))
    np.testing.assert_allclose(found.p_obstacle[0, :30], wanted[:30], atol=1e-6)
    np.testing.assert_array_equal(found.p_obstacle[0, 30:], classifier.p_obstacle[:6])


@pytest.mark.parametrize("k", [1, 2])
def test_of_equal_exemplars_the_first_is_the_nearest(k: int) -> None:
    """Ties go to the lowest row, in float64."""
    exemplars = points_of(3, seed=1)[[0, 1, 1, 2, 1]]

    rows, squared = nearest_exemplars(exemplars[[1]], exemplars, k)

    assert rows.tolist() == [[1, 2][:k]]
    assert squared.tolist() == [[0.0, 0.0][:k]]


def test_the_fit_radius_is_not_within() -> None:
    """A patch at exactly eps is unknown, as it would be an outlier."""
    exemplars, eps = np.eye(2, dtype=np.float32)[:1], 1.0

    assert KnownExemplars(exemplars, eps).unknown(np.eye(2, dtype=np.float32)).tolist() == [
        False,
        True,
    ]


def test_a_model_without_exemplars_knows_nothing() -> None:
    """No cluster, no probability, infinitely far."""
    two_scale = TwoScale(StrapParams(), AffinityParams(), n_dims=9)
    asked = points_of(12, seed=1).reshape(2, 6, 9)

    found = patch_classifier(two_scale, cluster_coarsely(two_scale), make_settings()).classify(
        asked
    )

    assert known_patches(two_scale).unknown(asked).all()
    assert (found.cluster == -1).all()
    assert np.isinf(found.distance).all()
    assert found.unknown.all()
    assert np.isnan(found.p_obstacle).all()


CORNERS = np.eye(6, dtype=np.float32)


def fill(two_scale: TwoScale, corner: int, times: int) -> IntArray:
    """Add one point several times."""
    stamps_ns = np.arange(times, dtype=np.int64)
    features = np.repeat(CORNERS[[corner]], times, axis=0)
    return two_scale.add_observations(features, stamps_ns, stamps_ns, log_index=0).ids


def two_kinds() -> tuple[TwoScale, dict[int, IntArray]]:
    """Return long-term clusters of the corners 0 to 2, and outliers at 3, 4 and near 0."""
    two_scale = TwoScale(StrapParams(reservoir=20, eps=0.5), AffinityParams(), n_dims=6)
    ids = {corner: fill(two_scale, corner, 5) for corner in range(3)}
    two_scale.rebuild()
    ids |= {corner: fill(two_scale, corner, 4) for corner in (3, 4)}
    return two_scale, ids


def test_probabilities_come_from_clusters_short_exemplars_and_the_rest() -> None:
    """Equation 8 of the coarse cluster, own counts, those of the nearest, the base rate."""
    two_scale, ids = two_kinds()
    two_scale.add_labels(ids[0], np.array([True, True, True, False, False]))
    two_scale.add_labels(ids[1], np.zeros(5, dtype=np.bool_))
    two_scale.add_labels(ids[3], np.array([True, True, True, False]))
    settings = make_settings(values={"readout": "cluster", "neighbors": "1"})
    coarse = Clustering(
        np.arange(3),
        np.arange(3),
        n_iter=1,
        converged=True,
        damping=0.9,
        net_similarity=0.0,
        preference=0.0,
    )

    classifier = patch_classifier(two_scale, ClusteredPoints(coarse, two_scale.ids), settings)
    found = classifier.classify(CORNERS[None, :5])

    base_rate = 6 / 14
    np.testing.assert_allclose(found.p_obstacle[0], [0.6, 0.0, base_rate, 0.75, 0.6])
    assert found.cluster[0].tolist() == [0, 1, 2, -1, -1]
    assert not found.unknown.any()


def test_a_metapoint_is_read_with_pseudo_counts_of_its_cluster() -> None:
    """(3 + 4 q) / (5 + 4) where 3 of 5 labels are positive and the cluster has q = 3/10."""
    two_scale, ids = two_kinds()
    two_scale.add_labels(ids[0], np.array([True, True, True, False, False]))
    two_scale.add_labels(ids[1], np.zeros(5, dtype=np.bool_))
    settings = make_settings(values={"readout": "metapoint", "neighbors": "1"})

    found = patch_classifier(two_scale, cluster_coarsely(two_scale), settings)

    p = found.classify(CORNERS[None, :3]).p_obstacle[0]
    np.testing.assert_allclose(p, [(3 + 4 * 0.3) / 9, 4 * 0.3 / 9, 0.3])


def test_the_kernel_reads_the_labels_of_the_neighbors() -> None:
    """Those of the nearest count in full, those at distance 1 by exp(-8), ten at the base rate.

    The base rate is of 5 positive and 5 negative labels and 13 patches without any.
    """
    two_scale, ids = two_kinds()
    two_scale.add_labels(ids[0], np.ones(5, dtype=np.bool_))
    two_scale.add_labels(ids[1], np.zeros(5, dtype=np.bool_))
    settings = make_settings(values={"neighbors": "2"})

    found = patch_classifier(two_scale, cluster_coarsely(two_scale), settings)

    p = found.classify(CORNERS[None, :2]).p_obstacle[0]
    far = np.exp(-2 / 0.5**2)
    total = 5 + 5 * far + 10
    base_rate = (5 + 0.05 * 13) / (10 + 0.05 * 13)
    wanted = [(5 + 10 * base_rate) / total, (5 * far + 10 * base_rate) / total]
    np.testing.assert_allclose(p, wanted)


def test_what_is_often_seen_and_never_driven_over_is_an_obstacle() -> None:
    """Though nothing ever touched it; a weight of 0 leaves it at the base rate."""
    two_scale, ids = two_kinds()
    two_scale.add_labels(ids[0], np.ones(5, dtype=np.bool_))
    two_scale.add_labels(fill(two_scale, 1, 995), np.zeros(995, dtype=np.bool_))
    fill(two_scale, 2, 995)
    found = {}

    for weight in ("0.05", "0"):
        settings = make_settings(values={"sighting-weight": weight})
        classifier = patch_classifier(two_scale, cluster_coarsely(two_scale), settings)
        found[weight] = classifier.classify(CORNERS[None, :3]).p_obstacle[0]

    assert found["0.05"][2] > 0.8
    assert found["0"][2] == pytest.approx(5 / 1000)
    assert found["0.05"][1] < 0.01


def test_a_touched_image_does_not_speak_against_floor() -> None:
    """Three presses on 97 rides over the same floor leave 3 % of 3 positive labels."""
    two_scale, _ = two_kinds()
    positive = np.arange(100) < 3
    two_scale.add_labels(fill(two_scale, 0, 100), positive)

    classifier = patch_classifier(two_scale, cluster_coarsely(two_scale), make_settings())

    speaking = 3 + 0.05 * 5  # of the first five patches there nobody says anything
    wanted = [97, speaking**2 / (97 + speaking)]
    np.testing.assert_allclose(classifier.evidence[0], wanted)


def test_without_a_press_nothing_is_an_obstacle() -> None:
    """Neither floor that was driven over nor what was only seen."""
    two_scale, ids = two_kinds()
    two_scale.add_labels(ids[0], np.zeros(5, dtype=np.bool_))
    fill(two_scale, 2, 995)

    classifier = patch_classifier(two_scale, cluster_coarsely(two_scale), make_settings())

    assert classifier.classify(CORNERS[None, :3]).p_obstacle[0].tolist() == [0.0, 0.0, 0.0]


def test_the_probability_of_a_cluster_is_that_of_its_patches() -> None:
    """The mean over the patches of its exemplars, as predict gives it; equation 8 on paper."""
    two_scale, ids = two_kinds()
    two_scale.add_labels(ids[0], np.array([True, True, True, False, False]))
    two_scale.add_labels(ids[1], np.zeros(5, dtype=np.bool_))
    robust, paper = make_settings(), make_settings("paper")
    together = Clustering(
        np.array([0]),
        np.zeros(3, dtype=np.int64),
        n_iter=1,
        converged=True,
        damping=0.9,
        net_similarity=0.0,
        preference=0.0,
    )
    fill(two_scale, 2, 10)
    coarse = ClusteredPoints(together, two_scale.ids)

    p = cluster_p_obstacle(two_scale, coarse, robust)

    said = patch_classifier(two_scale, coarse, robust).classify(CORNERS[None, :3]).p_obstacle[0]
    assert p == pytest.approx([said @ [5, 5, 15] / 25])
    assert cluster_p_obstacle(two_scale, coarse, paper).tolist() == [0.3]


def test_nothing_labelled_gives_no_probability() -> None:
    """Not one half, not zero."""
    two_scale, _ = two_kinds()

    found = patch_classifier(two_scale, cluster_coarsely(two_scale), make_settings()).classify(
        CORNERS[None]
    )

    assert np.isnan(found.p_obstacle).all()
    assert found.unknown[0].tolist() == [False] * 5 + [True]


def test_what_was_known_stays_as_it_was() -> None:
    """Later learning changes nothing in it."""
    two_scale, _ = two_kinds()

    known = known_patches(two_scale)
    fill(two_scale, 5, 6)
    two_scale.rebuild()

    assert known.unknown(CORNERS).tolist() == [False] * 5 + [True]
    assert not known_patches(two_scale).unknown(CORNERS).any()
