"""Methods compared on the logs and resamples that both share."""

import numpy as np
import pytest

from mpap_cli.evaluation.areas import Areas, Resampling, measure_areas
from mpap_cli.evaluation.differences import difference
from mpap_cli.evaluation.intervals import NO_INTERVAL
from mpap_cli.evaluation.roc import Scored
from mpap_cli.observations import BoolArray, Float64Array, IntArray

N_LOGS, PER_LOG = 8, 40


def hard_and_easy_logs(seed: int = 0) -> tuple[IntArray, BoolArray, Float64Array]:
    """Make logs, truth and a score whose worth differs much from log to log."""
    generator = np.random.default_rng(seed)
    log = np.repeat(np.arange(N_LOGS, dtype=np.int64), PER_LOG)
    positive = np.tile(np.arange(PER_LOG) >= PER_LOG - 10, N_LOGS)
    worth = np.repeat(np.linspace(0, 3, N_LOGS), PER_LOG)
    return log, positive, worth * positive + generator.normal(size=log.size)


def areas_of(score: Float64Array, chosen: BoolArray) -> Areas:
    """Measure the chosen scans of these logs, one model a log."""
    log, positive, _ = hard_and_easy_logs()
    scored = Scored(score[chosen], positive[chosen], log[chosen])
    how = Resampling(n_logs=N_LOGS, n_units=N_LOGS, n_resamples=300, seed=0)
    return measure_areas(scored, log[chosen], log[chosen], how)


def test_a_method_does_not_differ_from_itself() -> None:
    """However unsure its area is, the difference is 0 and surely so."""
    log, _, score = hard_and_easy_logs()
    areas = areas_of(score, log >= 0)

    found = difference(areas, areas)

    low, high = areas.per_log_interval()
    assert low is not None
    assert high is not None
    assert high - low > 0.1
    assert (found.per_log, found.pooled, found.logs) == (0, 0, N_LOGS)
    assert found.per_log_interval == (0, 0)
    assert found.pooled_interval == (0, 0)


def test_differences_change_sign_with_the_order() -> None:
    """What one gains the other loses, intervals too."""
    log, positive, score = hard_and_easy_logs()
    better = areas_of(score + positive, log >= 0)
    worse = areas_of(score, log >= 0)

    gain, loss = difference(better, worse), difference(worse, better)

    assert gain.per_log is not None
    assert loss.per_log is not None
    assert gain.pooled is not None
    assert gain.per_log > 0.05
    assert loss.per_log == pytest.approx(-gain.per_log)
    low, high = gain.per_log_interval
    assert low is not None
    assert high is not None
    assert 0 < low < gain.per_log < high
    assert loss.per_log_interval == pytest.approx((-high, -low))
    pooled_low, pooled_high = gain.pooled_interval
    assert pooled_low is not None
    assert pooled_high is not None
    assert 0 < pooled_low < gain.pooled < pooled_high


def test_only_logs_that_both_can_be_scored_on_count() -> None:
    """The mean difference is not the difference of the means."""
    log, _, score = hard_and_easy_logs()
    first = areas_of(score, log != 0)
    other = areas_of(-score, log < 7)

    found = difference(first, other)

    both = slice(1, 7)
    assert found.logs == 6
    assert found.per_log == pytest.approx(np.mean(first.of_log[both] - other.of_log[both]))
    assert first.per_log is not None
    assert other.per_log is not None
    assert found.per_log != pytest.approx(first.per_log - other.per_log)


def test_fewer_than_five_logs_have_no_interval() -> None:
    """The mean is told, how sure it is is not."""
    log, _, score = hard_and_easy_logs()
    first, other = areas_of(score, log < 4), areas_of(-score, log >= 0)

    found = difference(first, other)

    assert found.logs == 4
    assert found.per_log is not None
    assert found.per_log_interval == NO_INTERVAL


def test_what_has_no_area_has_no_difference() -> None:
    """One class only, or nothing to resample."""
    log, positive, score = hard_and_easy_logs()
    areas = areas_of(score, log >= 0)
    one_class = areas_of(score, positive)
    how = Resampling(n_logs=N_LOGS, n_units=0, n_resamples=300, seed=0)
    single = measure_areas(Scored(score, positive, log), log, None, how)

    empty = difference(areas, one_class)

    assert (empty.logs, empty.per_log, empty.pooled) == (0, None, None)
    assert empty.per_log_interval == empty.pooled_interval == NO_INTERVAL
    assert difference(areas, single).pooled_interval == NO_INTERVAL
    assert single.pooled_interval() == NO_INTERVAL
