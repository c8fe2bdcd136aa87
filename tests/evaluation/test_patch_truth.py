"""Scores of patches against a truth made by hand."""

from dataclasses import replace

import numpy as np
import pytest
from sklearn.metrics import roc_auc_score, v_measure_score

from mpap_cli.evaluation.patch_truth import (
    FreeWay,
    PatchPlaces,
    SeenPatches,
    TruePatches,
    pair_patches,
    score_free_way,
    score_patches,
)
from mpap_cli.observations import Float64Array


def places(n_images: int, rows: int = 2, columns: int = 3) -> PatchPlaces:
    """Name all patches of images with large stamps, one nanosecond apart."""
    image, row, column = np.indices((n_images, rows, columns)).reshape(3, -1)
    return PatchPlaces(image + 1_700_000_000_000_000_001, row, column)


def make(n_images: int, seed: int = 0) -> tuple[SeenPatches, TruePatches]:
    """Make truth, and predictions that have something to do with it."""
    generator = np.random.default_rng(seed)
    where = places(n_images)
    shares = generator.dirichlet((0.5, 0.3, 0.3), where.rows.size)
    p = np.clip(1 - shares[:, 0] + generator.normal(0, 0.4, where.rows.size), 0, 1).round(1)
    cluster = np.where(p > 0.8, -1, (p * 4).astype(np.int64))
    return SeenPatches(where, cluster, p, p > 0.9), TruePatches(where, shares)


def shuffled(seen: SeenPatches, seed: int = 1) -> SeenPatches:
    """Bring the rows into another order."""
    order = np.random.default_rng(seed).permutation(seen.cluster.size)
    at = seen.places
    where = PatchPlaces(at.stamps_ns[order], at.rows[order], at.columns[order])
    return SeenPatches(where, seen.cluster[order], seen.p_obstacle[order], seen.unknown[order])


def test_patches_are_paired_by_stamp_row_and_column() -> None:
    """Whatever the order of the tables; stamps one nanosecond apart are apart."""
    seen, truth = make(20)

    paired = pair_patches(shuffled(seen), truth)

    assert paired.missing == 0
    assert paired.p_obstacle.tolist() == seen.p_obstacle.tolist()
    assert paired.cluster.tolist() == seen.cluster.tolist()
    assert paired.unknown.tolist() == seen.unknown.tolist()
    assert paired.shares.tolist() == truth.shares.tolist()


def test_patches_without_prediction_are_counted() -> None:
    """An image that could not be decoded is missing; one without truth is left out."""
    seen, truth = make(4)
    late = replace(seen.places, stamps_ns=seen.places.stamps_ns + 1)

    paired = pair_patches(replace(seen, places=late), truth)

    assert paired.missing == 6
    assert paired.p_obstacle.tolist() == seen.p_obstacle[:18].tolist()
    assert paired.shares.tolist() == truth.shares[6:].tolist()


def test_scores_equal_scikit_learns() -> None:
    """Area over all patches of all logs, positive below one half of floor."""
    logs = [make(30, seed) for seed in (2, 3)]
    shares = np.concatenate([truth.shares for _, truth in logs])
    p = np.concatenate([seen.p_obstacle for seen, _ in logs])
    cluster = np.concatenate([seen.cluster for seen, _ in logs])
    floor: Float64Array = shares[:, 0]

    found = score_patches([pair_patches(*log) for log in logs])

    assert (found.patches, found.missing) == (360, 0)
    assert found.positives == np.sum(floor < 0.5)
    assert found.auc == pytest.approx(roc_auc_score(floor < 0.5, p))
    assert found.mean_p_floor == pytest.approx(p[floor >= 0.5].mean())
    assert found.mean_p_obstacle == pytest.approx(p[floor < 0.5].mean())
    assert found.unknown_share == pytest.approx(np.mean(p > 0.9))
    assert found.v_measure == pytest.approx(v_measure_score(shares.argmax(axis=1), cluster))


def test_purity_changes_the_means_only() -> None:
    """Means of patches that are nearly all floor, or nearly all not, lie farther apart."""
    paired = pair_patches(*make(100))

    every, pure = score_patches([paired]), score_patches([paired], purity=0.9)

    assert pure.mean_p_floor is not None
    assert pure.mean_p_obstacle is not None
    assert every.mean_p_floor is not None
    assert every.mean_p_obstacle is not None
    assert pure.mean_p_floor < every.mean_p_floor
    assert pure.mean_p_obstacle > every.mean_p_obstacle
    rest = replace(pure, mean_p_floor=every.mean_p_floor, mean_p_obstacle=every.mean_p_obstacle)
    assert rest == every


def test_model_without_labels_has_no_area() -> None:
    """NaN is no probability: neither an area nor means, but clusters are compared."""
    seen, truth = make(5)
    silent = replace(seen, p_obstacle=np.full(30, np.nan))

    found = score_patches([pair_patches(silent, truth)])

    assert (found.auc, found.mean_p_floor, found.mean_p_obstacle) == (None, None, None)
    assert found.v_measure > 0


def test_floor_alone_has_no_area() -> None:
    """One class only: there is no pair to be ordered."""
    seen, truth = make(5)
    floor = replace(truth, shares=np.tile([1.0, 0.0, 0.0], (30, 1)))

    found = score_patches([pair_patches(seen, floor)])

    assert (found.auc, found.mean_p_obstacle, found.positives) == (None, None, 0)
    assert found.mean_p_floor == pytest.approx(seen.p_obstacle.mean())


def test_nothing_paired_is_all_missing() -> None:
    """Tables of two logs have no patch in common."""
    seen, truth = make(2)
    other = replace(seen.places, stamps_ns=seen.places.stamps_ns + 1000)

    paired = pair_patches(replace(seen, places=other), truth)

    assert (paired.missing, paired.cluster.size) == (12, 0)


def test_free_way_counts_straight_where_more_than_two_metres_are_free() -> None:
    """Images without a decision are left out, whatever the order of the decisions."""
    truth_ns = np.arange(6)
    free_m = np.array([2.0, 2.1, 8.0, 8.0, 0.3, 9.0])

    found = score_free_way(np.array([3, 1, 2, 4, 0]), np.array([1, 0, 0, 0, 3]), truth_ns, free_m)

    assert found.images == 3
    assert found.straight_share == pytest.approx(2 / 3)
    assert score_free_way(truth_ns[:1], np.array([0]), truth_ns, free_m) == FreeWay(0, None)
