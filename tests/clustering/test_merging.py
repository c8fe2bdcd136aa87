"""Merging of meta-points that were built apart."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpap_cli.clustering.merging import merge_meta_points
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.distance import embed
from mpap_cli.errors import ModelError
from mpap_cli.params import AffinityParams, MetaPointParams


def leaf(xs: list[float], **params: object) -> MetaPoints:
    """Meta-points of points on a line, theta 1, the first stamp being the first x."""
    made = MetaPoints(MetaPointParams(**{"theta": 1.0, **params}), 1, normalized=False)  # type: ignore[arg-type]
    points = np.array(xs, np.float32)[:, None]
    made.add_data_points(points, np.arange(len(xs)) + int(xs[0] if xs else 0))
    return made


def random_leaves(seed: int, reference: str) -> list[MetaPoints]:
    """Four logs of one world, with labels."""
    rng = np.random.default_rng(seed)
    centers = rng.dirichlet(np.full(6, 0.4), 5)
    leaves = []
    for _ in range(4):
        made = MetaPoints(MetaPointParams(theta=0.25, reference=reference), 7)
        u = embed(rng.gamma(1e-3 + 40 * centers[rng.integers(0, 5, 60)])).astype(np.float32)
        u[rng.integers(0, 60, 10)] = u[0]
        ids, _ = made.add_data_points(u, rng.integers(0, 5, 60).cumsum())
        made.add_counts(ids, 1, rng.random(60) < 0.3)
        leaves.append(made)
    return leaves


@settings(max_examples=settings().max_examples // 10)
@given(st.integers(0, 10_000), st.sampled_from(["mean", "exemplar"]))
def test_the_order_of_the_models_does_not_matter(seed: int, reference: str) -> None:
    """All arrays are equal byte for byte under every permutation."""
    leaves = random_leaves(seed, reference)
    first = merge_meta_points(leaves).state()

    for order in itertools.islice(itertools.permutations(leaves), 1, None, 3):
        other = merge_meta_points(order).state()

        assert all(first[name].tobytes() == other[name].tobytes() for name in first)


@settings(max_examples=settings().max_examples // 10)
@given(st.integers(0, 10_000), st.sampled_from(["mean", "exemplar"]))
def test_totals_are_kept(seed: int, reference: str) -> None:
    """Numbers of points and labels add up exactly, sums of points to rounding."""
    leaves = random_leaves(seed, reference)

    merged = merge_meta_points(leaves)

    assert merged.count.sum() == sum(each.count.sum() for each in leaves)
    assert np.array_equal(
        merged.counts.sum(axis=0), sum(each.counts.sum(axis=0) for each in leaves)
    )
    assert np.allclose(merged.sums.sum(axis=0), sum(each.sums.sum(axis=0) for each in leaves))
    assert merged.first_ns.min() == min(each.first_ns.min() for each in leaves)
    assert merged.last_ns.max() == max(each.last_ns.max() for each in leaves)
    assert merged.ids.tolist() == list(range(merged.n_points))


def test_merging_one_model_changes_nothing_but_ids() -> None:
    """Its meta-points are at least theta / 2 apart where both are cluster-points."""
    only = leaf([0.0, 0.1, 5.0, 5.1, 9.0])

    merged = merge_meta_points([only])

    assert sorted(merged.sums.ravel()) == sorted(only.sums.ravel())
    assert merged.is_cluster_point.tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("reference", "joins", "stays"), [("mean", 0.4, 0.6), ("exemplar", 0.85, 0.95)]
)
def test_two_cluster_points_join_only_when_nearer_than_theta(
    reference: str, joins: float, stays: float
) -> None:
    """Otherwise too few of them would be left; means drift apart, exemplars do not."""
    placed = leaf([0.0, 0.0], reference=reference)

    near = merge_meta_points([placed, leaf([joins, joins], reference=reference)])
    far = merge_meta_points([placed, leaf([stays, stays], reference=reference)])

    assert near.count.tolist() == [4]
    assert far.count.tolist() == [2, 2]


def test_noise_joins_within_theta_and_keeps_the_exemplar_of_the_placed_one() -> None:
    """A noise-point is absorbed by a cluster-point within theta."""
    merged = merge_meta_points([leaf([0.8]), leaf([0.0, 0.0])])

    assert merged.count.tolist() == [3]
    assert merged.exemplars.tolist() == [[0.0]]
    assert merged.is_cluster_point.tolist() == [True]


def test_noise_seen_in_two_logs_becomes_a_cluster_point() -> None:
    """As it would have if the logs had been one."""
    merged = merge_meta_points([leaf([3.0]), leaf([3.5])])

    assert merged.is_cluster_point.tolist() == [True]
    assert merged.references().tolist() == [[3.25]]


def test_logs_get_new_indices() -> None:
    """An exemplar of the second model comes from another log then."""
    merged = merge_meta_points(
        [leaf([0.0, 0.0, 0.0]), leaf([9.0, 9.0])], [np.array([4]), np.array([7])]
    )

    assert merged.exemplar_log.tolist() == [4, 7]


def test_the_cap_on_noise_points_holds() -> None:
    """The longest unseen are dropped and counted."""
    models = [leaf([10.0 * k], max_noise=2) for k in range(5)]

    merged = merge_meta_points(models)

    assert merged.last_ns.tolist() == [30, 40]
    assert merged.n_dropped == 3


def test_a_merged_model_goes_on_learning() -> None:
    """It takes points and can be clustered."""
    merged = merge_meta_points([leaf([0.0, 0.0]), leaf([9.0])])

    ids, cases = merged.add_data_points(np.array([[9.1]], np.float32), np.array([99]))

    assert (ids.tolist(), cases.tolist()) == ([1], [2])
    assert merged.cluster(AffinityParams()).labels.size == 2


def test_models_without_points_can_be_merged() -> None:
    """Empty in, empty out."""
    assert merge_meta_points([leaf([]), leaf([])]).n_points == 0


def test_models_of_different_settings_cannot_be_merged() -> None:
    """The message names the setting and both values."""
    with pytest.raises(ModelError, match="min-points is 2 and 5; learn with one min-points"):
        merge_meta_points([leaf([0.0]), leaf([0.0], min_points=5)])
    with pytest.raises(ModelError, match="points have 1 and 3 coordinates"):
        merge_meta_points([leaf([0.0]), MetaPoints(leaf([]).params, 3, normalized=False)])
    with pytest.raises(ModelError, match="nothing to merge"):
        merge_meta_points([])


def test_the_models_stay_as_they_are() -> None:
    """No leaf is written to."""
    leaves = random_leaves(0, "mean")
    before = [each.state() for each in leaves]

    merge_meta_points(leaves, [np.array([k]) for k in range(4)])

    for each, state in zip(leaves, before, strict=True):
        assert all(each.state()[name].tobytes() == state[name].tobytes() for name in state)
