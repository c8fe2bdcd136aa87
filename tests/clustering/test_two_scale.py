"""Algorithm 2: long-term clusters, short-term ones, and the two levels."""

import numpy as np
import pytest

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.preference import coarse_preference
from mpap_cli.distance import similarities, squared_distances
from mpap_cli.observations import Float32Array
from tests.clustering.blobs import N_DIMS, around, centers
from tests.clustering.models import AFFINITY, add, filled, new_model, stream


def test_everything_is_an_outlier_until_the_reservoir_overflows() -> None:
    """The first clusters are made of the first R + 1 observations."""
    model = new_model(reservoir=40)
    points = stream(60, 3, spread=0.02)

    before = add(model, points[:40])
    n_before = model.n_clusters
    after = add(model, points[40:])

    assert before.outlier.all()
    assert np.isinf(before.distances).all()
    assert (n_before, model.n_clusters, model.n_rebuilds) == (0, 3, 1)
    assert after.outlier.tolist() == [True] + [False] * 19
    assert model.count.sum() == 60


def test_an_observation_at_the_fit_radius_is_an_outlier() -> None:
    """The comparison is strict."""
    model = new_model(reservoir=1, eps=1.0)
    axes = np.eye(3, N_DIMS, dtype=np.float32)
    add(model, axes[[0, 0]])
    nearly = np.float32(np.sqrt(0.5)) * (axes[1] + axes[2] + np.float32(0.001) * axes[0])

    added = add(model, np.stack([axes[1], nearly]))

    assert added.distances.tolist() == [1.0, pytest.approx(0.9996, abs=1e-4)]
    assert added.outlier.tolist() == [True, False]


def test_short_term_exemplars_explain_at_once() -> None:
    """A new kind that was seen in one image is among the fine exemplars, with its labels."""
    model, _ = filled()
    new = around(np.repeat(centers(9)[8:], 6, axis=0), 0.05, np.random.default_rng(5))
    added = add(model, new)
    model.add_labels(added.ids, np.arange(6) < 4)

    fine = model.fine()

    squared = squared_distances(new, fine.features[fine.is_short])
    nearest = int(squared.sum(axis=0).argmin())
    assert (squared[:, nearest] < model.strap.eps**2).all()
    assert fine.labels[fine.is_short][nearest].tolist() == [2, 4]
    assert fine.count[fine.is_short][nearest] == 6


def test_fine_exemplars_are_long_ones_first() -> None:
    """They come with ids, counts, labels and the places of their pictures."""
    model, ids = filled()
    model.add_labels(ids, np.arange(500) % 3 == 0)

    fine = model.fine()

    k = model.n_clusters
    assert fine.is_short.tolist() == [False] * k + [True] * (len(fine.ids) - k)
    assert fine.ids[:k].tolist() == model.ids.tolist()
    assert fine.features[:k].tolist() == model.exemplars.tolist()
    assert fine.labels[:k].tolist() == model.labels.tolist()
    assert fine.exemplar_patch.tolist() == (fine.exemplar_stamp_ns % 9).tolist()
    assert set(fine.exemplar_log.tolist()) == {1}
    assert (model.rows_of(fine.ids[k:]) == -1).all()


def test_fine_exemplars_are_kept_until_something_changes() -> None:
    """New observations or labels make them anew, an empty block does not."""
    model, ids = filled()
    first = model.fine()

    add(model, np.zeros((0, N_DIMS), np.float32))
    same = model.fine()
    model.add_labels(ids, np.ones(500, np.bool_))
    relabelled = model.fine()
    add(model, stream(10, 8, seed=2))

    assert same is first
    assert relabelled.labels.sum() > 0
    assert model.fine() is not relabelled


def test_coarse_clusters_are_those_of_the_long_exemplars() -> None:
    """Affinity propagation with a preference that grows with their number."""
    model, _ = filled()
    s = similarities(model.exemplars)
    expected = affinity_propagation(s, coarse_preference(s), AFFINITY)

    coarse = model.coarse()

    assert coarse.labels.tolist() == expected.labels.tolist()
    assert coarse is model.coarse()
    model.rebuild()
    assert coarse is not model.coarse()


def test_ids_lead_to_clusters_through_rebuilds() -> None:
    """Also those of outliers that have become part of a cluster; unknown ones to -1."""
    model, ids = filled()

    model.rebuild()

    assert np.isin(model.current_ids(ids), model.ids).all()
    assert model.ids[model.rows_of(ids)].tolist() == model.current_ids(ids).tolist()
    assert model.current_ids(np.array([10**6, -1])).tolist() == [-1, -1]
    assert model.rows_of(np.array([10**6, -1])).tolist() == [-1, -1]
    assert new_model().rows_of(np.array([0])).tolist() == [-1]


def test_rows_that_end_a_rebuild_sum_up_all_observations() -> None:
    """Every observation is counted once, in a cluster or in the reservoir."""
    model, _ = filled()

    assert model.count.sum() + model.n_reservoir == 500
    assert model.weight.tolist() == model.count.tolist()
    assert model.first_ns.min() == 0
    assert (model.last_ns <= 499).all()


def test_a_rise_of_outliers_makes_clusters_anew_before_the_reservoir_is_full() -> None:
    """With the option of Page and Hinkley."""
    models = [new_model(reservoir=1000, page_hinkley=on) for on in (False, True)]
    for model in models:
        add(model, stream(300, 3, spread=0.02))
        model.rebuild()
        add(model, stream(200, 3, seed=1, spread=0.02))

    for model in models:
        new = np.repeat(centers(4)[3:], 60, axis=0)
        add(model, around(new, 0.05, np.random.default_rng(7)))

    assert [model.n_rebuilds for model in models] == [1, 2]
    assert models[0].n_clusters == 3
    assert models[1].n_clusters > 3


@pytest.mark.parametrize(
    ("features", "n_stamps", "n_patches", "match"),
    [
        (np.eye(3, 7, dtype=np.float32), 3, 3, r"features \(3, 7\) at"),
        (np.eye(3, N_DIMS, dtype=np.float32), 2, 3, r"at \(2,\) stamps"),
        (np.eye(3, N_DIMS, dtype=np.float32), 3, 4, r"\(4,\) patches"),
        (np.eye(3, N_DIMS, dtype=np.float32) * 2, 3, 3, "length is not 1"),
        (np.full((3, N_DIMS), np.nan, np.float32), 3, 3, "length is not 1"),
        (np.zeros((3, N_DIMS), np.float32), 3, 3, "length is not 1"),
    ],
)
def test_observations_that_do_not_fit_are_an_error(
    features: Float32Array, n_stamps: int, n_patches: int, match: str
) -> None:
    """Wrong width, wrong numbers of stamps or patches, no embedded histogram."""
    model = new_model()

    with pytest.raises(ValueError, match=match):
        model.add_observations(features, np.arange(n_stamps), np.arange(n_patches), log_index=0)

    assert model.n_reservoir == 0
