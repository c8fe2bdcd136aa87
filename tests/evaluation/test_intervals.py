"""Intervals resample logs or segments of time, never single scans."""

import numpy as np
import pytest

from mpap_cli.evaluation.intervals import area_interval, resample_weights, unit_pairs
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

    ordered, pairs = unit_pairs(scored, unit, 6)

    for weight in weights:
        times = weight[unit]
        repeated = Scored(
            np.repeat(scored.score, times),
            np.repeat(scored.positive, times),
            np.repeat(scored.fold, times),
        )
        share = (weight @ ordered @ weight) / (weight @ pairs @ weight)
        assert share == pytest.approx(area_under_curve(repeated))


def test_interval_holds_the_area() -> None:
    """The interval lies about the area, in [0, 1], and the seed decides it."""
    scored, unit = random_scans(7, 600)

    interval = area_interval(scored, unit, 400, 0)

    area = area_under_curve(scored)
    assert interval is not None
    assert area is not None
    assert 0 <= interval[0] < area < interval[1] <= 1
    assert interval == area_interval(scored, unit, 400, 0)
    assert interval != area_interval(scored, unit, 400, 1)


def test_nothing_to_resample_gives_no_interval() -> None:
    """No units, no scan or one class: no interval."""
    scored, unit = random_scans(1)
    nothing = Scored(np.zeros(0), np.zeros(0, dtype=np.bool_), np.zeros(0, dtype=np.int64))
    one_class = Scored(scored.score, np.ones(120, dtype=np.bool_), scored.fold)

    assert area_interval(scored, None, 100, 0) is None
    assert area_interval(nothing, np.zeros(0, dtype=np.int64), 100, 0) is None
    assert area_interval(one_class, unit, 100, 0) is None


def test_each_resample_draws_as_many_units_as_there_are() -> None:
    """Weights of a resample sum to the number of units."""
    weights = resample_weights(7, 50, 0)

    assert weights.shape == (50, 7)
    assert np.all(weights.sum(axis=1) == 7)
