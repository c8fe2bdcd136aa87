"""Brier score, its skill against the base rate, and reliability."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.linear_model import LogisticRegression
from sklearn.metrics import brier_score_loss

from mpap_cli.evaluation.calibration import calibration, recalibration


@given(st.lists(st.tuples(st.floats(0, 1), st.booleans()), min_size=1, max_size=60))
def test_scores_are_bounded_and_bins_hold_every_scan(scans: list[tuple[float, bool]]) -> None:
    """Brier and ECE lie in [0, 1]; the ten bins hold each scan once, p = 1 in the last."""
    p = np.array([scan[0] for scan in scans])
    positive = np.array([scan[1] for scan in scans])

    found = calibration(p, positive)

    assert found is not None
    assert 0 <= found.brier <= 1
    assert 0 <= found.ece <= 1
    assert len(found.bins) == 10
    assert sum(entry.scans for entry in found.bins) == p.size
    assert found.brier == pytest.approx(brier_score_loss(positive, p))
    for entry in found.bins:
        inside = entry.mean_p is None or entry.low - 1e-9 <= entry.mean_p <= entry.high + 1e-9
        assert inside


def test_base_rate_has_no_skill_and_truth_has_all() -> None:
    """Saying the base rate has skill 0, saying the truth skill 1."""
    positive = np.array([True, False, False, False])

    base = calibration(np.full(4, 0.25), positive)
    truth = calibration(positive.astype(np.float64), positive)

    assert base is not None
    assert truth is not None
    assert base.brier_skill == pytest.approx(0)
    assert base.ece == pytest.approx(0)
    assert truth.brier_skill == 1
    assert truth.ece == 0


def test_ece_by_hand() -> None:
    """Two bins, off by .05 and .6: weighted by their scans."""
    p = np.array([0.05, 0.05, 0.4, 0.4])
    positive = np.array([False, False, True, True])

    found = calibration(p, positive)

    assert found is not None
    assert found.ece == pytest.approx(0.5 * 0.05 + 0.5 * 0.6)


def test_one_class_has_no_skill_and_no_scan_no_score() -> None:
    """Skill needs both classes; nothing can be said of no scan."""
    found = calibration(np.array([0.2]), np.array([False]))

    assert found is not None
    assert found.brier_skill is None
    assert calibration(np.zeros(0), np.zeros(0, dtype=np.bool_)) is None


@pytest.mark.parametrize("seed", range(4))
def test_recalibration_is_a_logistic_regression_on_log_odds(seed: int) -> None:
    """Slope and intercept are those of scikit-learn without a penalty."""
    generator = np.random.default_rng(seed)
    p = np.clip(generator.random(200) ** 2, 0.01, 0.99)
    positive = generator.random(200) < p / 2
    log_odds = np.log(p / (1 - p))

    found = recalibration(p, positive)

    oracle = LogisticRegression(C=1e9, tol=1e-10, max_iter=1000).fit(log_odds[:, None], positive)
    assert found is not None
    assert found == pytest.approx((oracle.coef_[0, 0], oracle.intercept_[0]), abs=1e-4)


def test_honest_probabilities_have_slope_one_and_overstated_ones_less() -> None:
    """Log odds twice as far from the base rate have half the slope; too high ones a shift."""
    p = np.repeat([0.1, 0.5, 0.9], 1000)
    positive = np.concatenate([np.arange(1000) < 1000 * q for q in (0.1, 0.5, 0.9)])
    twice = p**2 / (p**2 + (1 - p) ** 2)
    too_high = 3 * p / (3 * p + 1 - p)

    assert recalibration(p, positive) == pytest.approx((1, 0), abs=1e-9)
    assert recalibration(twice, positive) == pytest.approx((0.5, 0), abs=1e-9)
    assert recalibration(too_high, positive) == pytest.approx((1, -np.log(3)), abs=1e-9)


def test_certainty_is_taken_as_one_in_a_thousand() -> None:
    """0 and 1 have no finite log odds."""
    p = np.array([0.0, 0.0, 1.0, 1.0])
    positive = np.array([False, True, True, False])

    assert recalibration(p, positive) == pytest.approx((0, 0), abs=1e-9)


@pytest.mark.parametrize(
    ("p", "positive"),
    [
        ([0.1, 0.2, 0.3], [False, False, True]),
        ([0.1, 0.2, 0.2], [False, False, True]),
        ([0.3, 0.2, 0.1], [False, False, True]),
        ([0.2, 0.2, 0.2], [False, False, True]),
        ([0.1, 0.2, 0.3], [False, False, False]),
        ([0.1, 0.2, 0.3], [True, True, True]),
    ],
)
def test_there_is_no_slope_where_a_threshold_parts_the_classes(
    p: list[float], positive: list[bool]
) -> None:
    """The best slope would be infinite, or any would do."""
    assert recalibration(np.array(p), np.array(positive)) is None
