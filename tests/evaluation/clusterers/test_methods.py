"""One contract for every clusterer, and what each makes of its settings."""

import importlib.util
from dataclasses import replace

import numpy as np
import pytest
from sklearn.metrics import v_measure_score

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.preference import coarse_preference
from mpap_cli.distance import similarities
from mpap_cli.evaluation.clusterers.methods import CLUSTERERS, is_there, warm_up
from mpap_cli.evaluation.clusterers.own import theta_of_patches
from mpap_cli.evaluation.clusterers.records import (
    PATCH_SETTINGS,
    ClustererSettings,
    LabelledPoints,
)
from mpap_cli.params import MetaPointParams, StrapParams
from tests.evaluation.clusterers.groups import groups

every = pytest.mark.parametrize("key", [key for key, one in CLUSTERERS.items() if is_there(one)])


@every
def test_labels_belong_to_clusters(key: tuple[str, str]) -> None:
    """Labels count from 0 (-1: noise), exemplars are members of their clusters, time passes."""
    points = groups()

    result = CLUSTERERS[key].run(points, PATCH_SETTINGS, 0)

    assert result.labels.shape == points.classes.shape
    assert set(result.labels.tolist()) - {-1} <= set(range(result.clusters))
    assert result.seconds >= 0
    if result.exemplars is not None:
        assert len(result.exemplars) == result.clusters
        np.testing.assert_array_equal(result.labels[result.exemplars], np.arange(result.clusters))
    if result.coverage is not None:
        assert 0 <= result.coverage <= 1


@every
def test_the_input_is_left_alone_and_runs_repeat(key: tuple[str, str]) -> None:
    """The same points and seed give the same labels; the points stay as they are."""
    points, untouched = groups(), groups()

    first = CLUSTERERS[key].run(points, PATCH_SETTINGS, 3)
    second = CLUSTERERS[key].run(points, PATCH_SETTINGS, 3)

    np.testing.assert_array_equal(first.labels, second.labels)
    np.testing.assert_array_equal(points.features, untouched.features)
    np.testing.assert_array_equal(points.classes, untouched.classes)


@every
@pytest.mark.parametrize("n_points", [2, 5])
def test_a_few_points_or_copies_are_no_error(key: tuple[str, str], n_points: int) -> None:
    """Two points, five points, and as many copies of one give labels for each."""
    few = groups(n_points, 1)
    copies = replace(few, features=np.repeat(few.features[:1], n_points, axis=0))

    results = [CLUSTERERS[key].run(points, PATCH_SETTINGS, 0) for points in (few, copies)]

    assert all(result.labels.shape == (n_points,) for result in results)


@every
def test_clear_groups_are_parted(key: tuple[str, str]) -> None:
    """No cluster holds points of two groups that lie far apart.

    Where radii are fixed (0.13, 0.18) groups this narrow are too few points to part, and
    a heavy micro-cluster of DenStream takes in whatever comes: these are left out.
    """
    points = groups(60, noise=0.5)

    labels = CLUSTERERS[key].run(points, PATCH_SETTINGS, 0).labels

    if key not in {("mpap", "fixed-theta"), ("strap", "default"), ("denstream", "default")}:
        members = [set(points.classes[labels == one].tolist()) for one in set(labels) - {-1}]
        assert all(len(one) == 1 for one in members)


def test_mpap_gives_noise_points_the_nearest_cluster() -> None:
    """With a coverage below 1 there is no point without a cluster."""
    points = groups(60, noise=0.5)

    result = CLUSTERERS["mpap", "default"].run(
        points, ClustererSettings(meta_point=MetaPointParams(theta=0.09, min_points=5)), 0
    )

    assert result.coverage is not None
    assert result.clustered_points is not None
    assert 0.1 < result.coverage < 0.9
    assert result.labels.min() == 0
    assert v_measure_score(points.classes, result.labels) > 0.9


def test_without_a_cluster_point_mpap_has_no_cluster() -> None:
    """More points are asked for than there are: all points are noise."""
    settings = ClustererSettings(meta_point=MetaPointParams(theta=0.1, min_points=100))

    result = CLUSTERERS["mpap", "default"].run(groups(10), settings, 0)

    assert (result.clusters, result.clustered_points, result.coverage) == (0, 0, 0.0)
    assert set(result.labels.tolist()) == {-1}


def test_theta_of_the_settings_counts_unless_it_comes_from_the_points() -> None:
    """A small theta leaves more cluster-points than the one that the points give."""
    points = groups(100, noise=0.4)
    tight = ClustererSettings(meta_point=MetaPointParams(theta=0.06, min_points=2))

    given = CLUSTERERS["mpap", "default"].run(points, tight, 0)
    own = CLUSTERERS["mpap", "default"].run(points, replace(tight, theta_from_points=True), 0)
    fixed = CLUSTERERS["mpap", "fixed-theta"].run(points, tight, 0)

    assert (given.clustered_points or 0) > (own.clustered_points or 0)
    assert (given.clustered_points or 0) > (fixed.clustered_points or 0)


def test_affinity_propagation_takes_its_preference_from_the_variant() -> None:
    """The default is the median times n / 50, whatever the settings prefer."""
    points = groups(50, noise=0.6)
    s = similarities(points.features)
    params = replace(PATCH_SETTINGS.affinity, preference="-0.001")
    expected = affinity_propagation(s, coarse_preference(s), params)

    result = CLUSTERERS["ap", "default"].run(points, ClustererSettings(affinity=params), 0)

    np.testing.assert_array_equal(result.exemplars, expected.exemplars)
    assert result.clusters < CLUSTERERS["ap", "median"].run(points, PATCH_SETTINGS, 0).clusters


def test_the_fine_level_of_strap_are_its_exemplars() -> None:
    """The fine variant has a cluster an exemplar, the default fewer."""
    points = groups(100, noise=0.6)
    settings = ClustererSettings(strap=StrapParams(eps=0.1, reservoir=50))

    fine = CLUSTERERS["strap", "fine"].run(points, settings, 0)
    coarse = CLUSTERERS["strap", "default"].run(points, settings, 0)

    assert fine.clusters == fine.clustered_points == coarse.clustered_points
    assert coarse.clusters < fine.clusters


def test_the_noise_of_hdbscan_goes_to_the_nearest_cluster() -> None:
    """The variant nearest differs from the default in the noise alone."""
    points = groups(40, noise=0.8)

    apart = CLUSTERERS["hdbscan", "default"].run(points, PATCH_SETTINGS, 0)
    nearest = CLUSTERERS["hdbscan", "nearest"].run(points, PATCH_SETTINGS, 0)

    noise = apart.labels < 0
    assert noise.any()
    assert nearest.labels.min() == 0
    np.testing.assert_array_equal(nearest.labels[~noise], apart.labels[~noise])
    assert apart.coverage == nearest.coverage == pytest.approx(1 - noise.mean())


def test_points_in_the_plane_are_clustered_at_euclidean_distances() -> None:
    """Two groups ten units apart are two clusters for mpap with theta 0.7."""
    rng = np.random.default_rng(0)
    classes = rng.integers(0, 2, 400)
    features = (rng.normal(size=(400, 2)) + 10.0 * classes[:, None]).astype(np.float32)
    points = LabelledPoints(features=features, classes=classes, normalized=False)
    settings = ClustererSettings(meta_point=MetaPointParams(theta=0.7, min_points=5))

    result = CLUSTERERS["mpap", "default"].run(points, settings, 0)

    assert result.clusters >= 2
    assert {len(set(classes[result.labels == one])) for one in range(result.clusters)} == {1}


@pytest.mark.parametrize(("spread", "theta"), [(0.0, 0.08), (1.0, 0.2)])
def test_theta_stays_in_its_range(spread: float, theta: float) -> None:
    """Copies give the least, points without likeness the most."""
    points = groups(100, 1, noise=0.0)
    directions = np.abs(np.random.default_rng(0).normal(size=points.features.shape))
    features = points.features + spread * 9 * directions**4
    features /= np.linalg.norm(features, axis=1, keepdims=True)

    found = theta_of_patches(features.astype(np.float32))

    assert found == theta


def test_theta_reaches_the_fifth_neighbor_of_most_points() -> None:
    """Between its bounds, 70 % of the points have their fifth neighbor within theta."""
    features = groups(100, 4, noise=0.9).features
    fifth = np.sqrt(np.sort(-similarities(features), axis=1)[:, 5])
    wanted = np.quantile(fifth, 0.7)
    assert 0.08 < wanted < 0.2

    found = theta_of_patches(features)

    assert found == pytest.approx(wanted, abs=6e-4)


def test_a_single_point_has_the_least_theta() -> None:
    """There is no distance to go by."""
    assert theta_of_patches(groups(1, 1).features) == 0.08


def test_what_needs_a_package_that_is_missing_is_not_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without river there is no DenStream, and warming up goes without it."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda _name: None)

    warm_up()

    assert [key[0] for key, one in CLUSTERERS.items() if not is_there(one)] == ["denstream"]
