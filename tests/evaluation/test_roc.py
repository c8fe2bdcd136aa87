"""The area under the curve counts ordered pairs, within one model only."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import average_precision_score, roc_auc_score

from mpap_cli.evaluation.roc import (
    Scored,
    area_under_curve,
    areas_of_logs,
    average_precision,
    fold_curve,
    ordered_pairs,
    roc_curve,
)

LEVELS = st.integers(0, 6).map(lambda level: level / 6)
SCANS = st.lists(st.tuples(LEVELS, st.booleans(), st.integers(0, 2)), min_size=1, max_size=40)


def scored_of(scans: list[tuple[float, bool, int]]) -> Scored:
    """Turn (score, truth, fold) triples into arrays."""
    score, positive, fold = (np.array(column) for column in zip(*scans, strict=True))
    return Scored(score.astype(np.float64), positive.astype(np.bool_), fold.astype(np.int64))


def pairs_by_hand(scored: Scored) -> tuple[float, int]:
    """Compare every positive with every negative of its fold, one by one."""
    ordered, n_pairs = 0.0, 0
    for i in np.flatnonzero(scored.positive):
        for j in np.flatnonzero(~scored.positive & (scored.fold == scored.fold[i])):
            difference = scored.score[i] - scored.score[j]
            ordered += 1.0 if difference > 0 else 0.5 if difference == 0 else 0.0
            n_pairs += 1
    return ordered, n_pairs


@given(SCANS)
def test_area_is_the_share_of_pairs_compared_one_by_one(
    scans: list[tuple[float, bool, int]],
) -> None:
    """Rank sums give exactly what comparing every pair within a fold gives."""
    scored = scored_of(scans)

    area = area_under_curve(scored)

    ordered, n_pairs = pairs_by_hand(scored)
    assert area == (ordered / n_pairs if n_pairs else None)
    assert (area is None) == (scored.two_class_folds().size == 0)


@given(SCANS)
def test_negated_scores_mirror_the_area(scans: list[tuple[float, bool, int]]) -> None:
    """Turning the order round turns the area round, ties included."""
    scored = scored_of(scans)

    area = area_under_curve(scored)
    mirrored = area_under_curve(Scored(-scored.score, scored.positive, scored.fold))
    swapped = area_under_curve(Scored(scored.score, ~scored.positive, scored.fold))

    if area is None:
        assert mirrored is None
        assert swapped is None
    else:
        assert mirrored == pytest.approx(1 - area)
        assert swapped == pytest.approx(1 - area)


@pytest.mark.parametrize("seed", range(5))
def test_one_fold_agrees_with_scikit_learn(seed: int) -> None:
    """With one model, area and average precision are the usual ones."""
    generator = np.random.default_rng(seed)
    score = generator.integers(0, 12, 80) / 12
    positive = generator.random(80) < 0.3
    scored = Scored(score, positive, np.zeros(80, dtype=np.int64))

    area, precision = area_under_curve(scored), average_precision(scored)

    assert area == pytest.approx(roc_auc_score(positive, score))
    assert precision == pytest.approx(average_precision_score(positive, score))


def test_pooling_the_folds_is_biased_down() -> None:
    """A fold rich in contacts is scored by a model that saw few: pooled, that looks bad."""
    rich = [(0.10 + 0.01 * i, i >= 4, 0) for i in range(12)]
    poor = [(0.60 + 0.01 * i, i >= 10, 1) for i in range(12)]
    scored = scored_of([*rich, *poor])
    pooled = Scored(scored.score, scored.positive, np.zeros(24, dtype=np.int64))

    within, across = area_under_curve(scored), area_under_curve(pooled)

    assert within == 1.0
    assert across is not None
    assert across < 0.5


@given(SCANS)
def test_area_of_the_curve_is_the_area(scans: list[tuple[float, bool, int]]) -> None:
    """The averaged curve rises from (0, 0) to (1, 1) and holds the pair-weighted area."""
    scored = scored_of(scans)

    curve = roc_curve(scored)

    if curve is None:
        assert area_under_curve(scored) is None
        return
    assert (curve.fpr[0], curve.tpr[0]) == (0, 0)
    assert (curve.fpr[-1], curve.tpr[-1]) == (1, 1)
    assert np.all(np.diff(curve.fpr) >= 0)
    assert np.all(np.diff(curve.tpr) >= -1e-12)
    assert curve.area() == pytest.approx(area_under_curve(scored))


def test_thresholds_call_what_they_say() -> None:
    """At each threshold of a single model the curve counts scans at or above it."""
    score = np.array([0.9, 0.7, 0.7, 0.2])
    positive = np.array([True, False, True, False])

    curve = fold_curve(score, positive)

    assert curve.threshold.tolist() == [np.inf, 0.9, 0.7, 0.2]
    assert curve.tpr.tolist() == [0, 0.5, 1, 1]
    assert curve.fpr.tolist() == [0, 0, 0.5, 1]


def test_average_of_models_has_no_threshold() -> None:
    """Where two models were averaged no single threshold leads to a point."""
    scored = scored_of([(0.9, True, 0), (0.1, False, 0), (0.3, True, 1), (0.4, False, 1)])

    curve = roc_curve(scored)

    assert curve is not None
    assert np.isnan(curve.threshold).all()
    assert list(zip(curve.fpr.tolist(), curve.tpr.tolist(), strict=True)) == [
        (0, 0),
        (0, 0.5),
        (1, 0.5),
        (1, 1),
    ]


def test_one_class_has_no_area() -> None:
    """Contacts only: no area, no curve, no precision; not one half."""
    scored = scored_of([(0.1, True, 0), (0.2, True, 0)])

    assert area_under_curve(scored) is None
    assert average_precision(scored) is None
    assert roc_curve(scored) is None
    with pytest.raises(ValueError, match="positives and negatives"):
        fold_curve(scored.score, scored.positive)


def test_each_log_has_its_area() -> None:
    """A log of one class has none, nor has one without scans."""
    log_index = np.array([0, 0, 1, 1, 1, 1, 2])
    score = np.array([0.1, 0.9, 0.9, 0.1, 0.1, 0.1, 0.5])
    positive = np.array([False, True, False, True, True, True, True])

    areas = areas_of_logs(Scored(score, positive, np.zeros(7, dtype=np.int64)), log_index, 4)

    assert np.array_equal(areas, [1.0, 0.0, np.nan, np.nan], equal_nan=True)


def test_counting_pairs_leaves_the_input_alone() -> None:
    """Scores are not sorted in place."""
    scores = np.array([0.5, 0.1, 0.3])
    before = scores.copy()

    ordered = ordered_pairs(scores, np.array([True, False, False]))

    assert ordered == 2
    assert np.array_equal(scores, before)
