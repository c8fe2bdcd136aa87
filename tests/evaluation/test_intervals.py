"""Intervals resample logs or segments of time, never single scans."""

import numpy as np
import pytest

from mpap_cli.evaluation.intervals import (
    NO_INTERVAL,
    log_mean_interval,
    percentile_interval,
    resample_weights,
    unit_pairs,
)
from mpap_cli.evaluation.roc import Scored, area_under_curve
from mpap_cli.observations import IntArray


def random_scans(seed: int, n: int = 120) -> tuple[Scored, IntArray]:
    """Make scans of six units in three folds, some units in two folds."""
    generator = np.random.default_rng(seed)
    positive = generator.random(n) < 0.3
    score = np.floor(10 * generator.random(n) + 3 * positive) / 10
    unit = generator.integers(0, 6, n)
    fold = np.minimum((unit + generator.integers(0, 2, n)) // 2, 2)
    return Scored(score, positive, fold), unit


@pytest.mark.parametrize("seed", range(4))
def test_weighted_sums_equal_scans_written_out(seed: int) -> None:
    """A resample as a weighted sum is the area of the scans repeated unit by unit."""
    scored, unit = random_scans(seed)
    weights = resample_weights(6, 3, seed)

    areas = unit_pairs(scored, unit, 6).areas(weights)

    for weight, area in zip(weights, areas, strict=True):
        times = weight[unit].astype(np.int64)
        repeated = Scored(
            np.repeat(scored.score, times),
            np.repeat(scored.positive, times),
            np.repeat(scored.fold, times),
        )
        assert area == pytest.approx(area_under_curve(repeated))


def test_interval_holds_the_area() -> None:
    """The interval lies about the area, in [0, 1], and the seed decides it."""
    scored, unit = random_scans(7, 600)
    pairs = unit_pairs(scored, unit, 6)

    low, high = percentile_interval(pairs.areas(resample_weights(6, 400, 0)))

    area = area_under_curve(scored)
    assert low is not None
    assert high is not None
    assert area is not None
    assert 0 <= low < area < high <= 1
    assert percentile_interval(pairs.areas(resample_weights(6, 400, 1))) != (low, high)


def test_resamples_without_a_pair_are_left_out() -> None:
    """One class: no interval; one class in some resamples: the others make it."""
    scored, unit = random_scans(1)
    one_class = Scored(scored.score, np.ones(120, dtype=np.bool_), scored.fold)
    weights = resample_weights(6, 100, 0)

    found = unit_pairs(one_class, unit, 6).areas(weights)

    assert np.isnan(found).all()
    assert percentile_interval(found) == NO_INTERVAL
    assert percentile_interval(np.array([np.nan, 0.5, 0.5])) == (0.5, 0.5)


def test_a_mean_over_logs_needs_five_of_them() -> None:
    """Logs without a figure are drawn too, but do not count among the five."""
    four = np.array([0.1, np.nan, 0.2, 0.3, 0.4])
    five = np.append(four, 0.5)

    none = log_mean_interval(four, 200, 0)
    low, high = log_mean_interval(five, 200, 0)

    assert none == NO_INTERVAL
    assert low is not None
    assert high is not None
    assert 0.1 < low < 0.3 < high < 0.5
    assert log_mean_interval(five, 200, 0) == (low, high)
    assert log_mean_interval(five, 200, 1) != (low, high)


def test_equal_logs_leave_no_doubt() -> None:
    """If every log says the same, so does every resample."""
    low, high = log_mean_interval(np.full(6, 0.25), 50, 0)

    assert low == pytest.approx(0.25)
    assert high == pytest.approx(0.25)


def test_each_resample_draws_as_many_units_as_there_are() -> None:
    """Weights of a resample sum to the number of units."""
    weights = resample_weights(7, 50, 0)

    assert weights.shape == (50, 7)
    assert np.all(weights.sum(axis=1) == 7)
