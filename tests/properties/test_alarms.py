"""Alarms: odds against the usual ones, held, and never by what comes later."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import SettingError
from mpap_cli.observations import NS_PER_S, BoolArray, Float64Array, IntArray
from mpap_cli.params import PropertyParams
from mpap_cli.properties.alarms import alarm_levels, alarm_odds, odds_of

PARAMS = PropertyParams(alarm_release=0.5, alarm_hold_s=2.0)


def alarm_of(stamps_ns: IntArray, odds: Float64Array, threshold: float) -> BoolArray:
    """Return the alarm as its words say: begun at the threshold, ended after the hold time."""
    hold_ns = round(PARAMS.alarm_hold_s * NS_PER_S)
    raised, found = False, []
    for i, stamp_ns in enumerate(stamps_ns.tolist()):
        recent = odds[: i + 1][stamps_ns[: i + 1] >= stamp_ns - hold_ns]
        raised = odds[i] >= threshold or (
            raised and recent.max() >= PARAMS.alarm_release * threshold
        )
        found.append(raised)
    return np.array(found, dtype=np.bool_)


@given(
    steps=st.lists(st.tuples(st.integers(0, 12), st.integers(0, 9)), min_size=1, max_size=40),
    threshold=st.sampled_from([1.0, 2.0, 3.0, 5.0, 8.0]),
)
def test_a_level_is_the_alarm_at_every_threshold(
    steps: list[tuple[int, int]], threshold: float
) -> None:
    """One pass tells the alarms of all thresholds."""
    gaps, odds = np.array(steps, dtype=np.float64).T
    stamps_ns = (np.cumsum(gaps) * NS_PER_S / 4).astype(np.int64)

    levels = alarm_levels(stamps_ns, odds, PARAMS)

    assert ((levels >= threshold) == alarm_of(stamps_ns, odds, threshold)).all()
    assert (levels >= odds).all()


def test_the_future_does_not_matter() -> None:
    """What was said of the first scans stays."""
    odds = np.random.default_rng(0).gamma(1.0, 2.0, 50)
    stamps_ns = np.arange(50) * NS_PER_S // 5

    early = alarm_levels(stamps_ns[:20], odds[:20], PARAMS)

    assert early.tolist() == alarm_levels(stamps_ns, odds, PARAMS)[:20].tolist()


def test_what_is_unknown_raises_no_alarm() -> None:
    """NaN stays, and is nothing to those that follow."""
    levels = alarm_levels(np.arange(3) * NS_PER_S, np.array([np.nan, 1.0, np.nan]), PARAMS)

    assert np.isnan(levels).tolist() == [True, False, True]
    assert levels[1] == 1.0


def test_an_alarm_begins_at_a_multiple_of_the_usual_odds() -> None:
    """As long as enough of what was learnt reaches it."""
    counts = np.array([[60, 0], [30, 2], [5, 3]])
    p = np.array([0.01, 0.1, 0.4])
    usual = 5 / 95

    found = [
        alarm_odds(p, counts, PropertyParams(alarm_lift=lift, alarm_share=share))
        for lift, share in ((2.0, 0.05), (20.0, 0.05), (20.0, 0.2), (20.0, 0.5))
    ]

    assert found == pytest.approx([2 * usual, 0.4 / 0.6, 0.1 / 0.9, 0.01 / 0.99])


@pytest.mark.parametrize("counts", [[[5, 0]], [[0, 5]], [[0, 0]]])
def test_without_both_labels_no_alarm_begins(counts: list[list[int]]) -> None:
    """Nothing can be told from what is usual."""
    assert np.isnan(alarm_odds(np.array([0.5]), np.array(counts), PARAMS))


def test_a_sure_press_has_infinite_odds() -> None:
    """Nobody divides by zero."""
    assert odds_of(np.array([0.0, 0.5, 1.0])).tolist() == [0.0, 1.0, np.inf]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("alarm_lift", 0.0, "setting alarm-lift: found 0.0, expected more than 0"),
        ("alarm_share", 1.0, "setting alarm-share: found 1.0, expected 0 to below 1"),
        ("alarm_release", 1.5, "setting alarm-release: found 1.5, expected more than 0, at most 1"),
        ("alarm_hold_s", -1.0, "setting alarm-hold-s: found -1.0"),
        ("range_share", 2.0, "setting range-share: found 2.0, expected 0 to 1"),
    ],
)
def test_settings_out_of_range_are_refused(name: str, value: float, message: str) -> None:
    """Checked before their first use."""
    with pytest.raises(SettingError, match=message):
        PropertyParams(**{name: value})  # type: ignore[arg-type]
