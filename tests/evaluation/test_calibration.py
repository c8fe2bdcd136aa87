"""Brier score, its skill against the base rate, and reliability."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import brier_score_loss

from mpap_cli.evaluation.calibration import calibration


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
