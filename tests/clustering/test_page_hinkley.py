"""The test of Page and Hinkley for a rise of the share of outliers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.clustering.page_hinkley import PageHinkley

VALUES = st.lists(st.booleans(), max_size=80)


def first_alarm(values: list[bool], delta: float, threshold: float) -> int | None:
    """Go through the values one after the other."""
    total = m = least = 0.0
    for n, value in enumerate(values, start=1):
        total += value
        m += value - total / n - delta
        least = min(least, m)
        if m - least > threshold:
            return n
    return None


@given(
    VALUES,
    st.integers(0, 80),
    st.sampled_from([0.0, 0.005, 0.2]),
    st.sampled_from([0.3, 1.0, 4.0]),
)
def test_blocks_give_what_single_values_give(
    values: list[bool], cut: int, delta: float, threshold: float
) -> None:
    """The first alarm is the same, bit for bit, wherever a stream is cut."""
    expected = first_alarm(values, delta, threshold)
    watch = PageHinkley(delta, threshold)
    before = np.array(values[:cut], np.bool_)

    found = watch.first_alarm(before)
    if found is None:
        watch.add(before)
        later = watch.first_alarm(np.array(values[cut:], np.bool_))
        found = None if later is None else later + len(before)

    assert found == expected


@pytest.mark.parametrize(("share", "alarm"), [(0.1, False), (0.9, True)])
def test_only_a_rise_is_an_alarm(share: float, alarm: bool) -> None:
    """After 400 values of which a tenth are outliers, 100 more of that share or of nine tenths."""
    rng = np.random.default_rng(0)
    watch = PageHinkley(delta=0.05, threshold=10.0)
    watch.add(rng.random(400) < 0.1)

    found = watch.first_alarm(rng.random(100) < share)

    assert (found is not None) == alarm


def test_outliers_from_the_start_are_no_rise() -> None:
    """A stream of nothing but outliers has the share it always had."""
    assert PageHinkley(delta=0.005, threshold=1.0).first_alarm(np.ones(1000, np.bool_)) is None


def test_reset_forgets_the_stream() -> None:
    """What follows counts as if nothing had been before."""
    watch = PageHinkley(delta=0.0, threshold=0.5)
    watch.add(np.array([False, False, True]))

    watch.reset()

    assert watch.state.tolist() == [0.0] * 4


def test_asking_changes_nothing() -> None:
    """Only values that are added count."""
    watch = PageHinkley(delta=0.0, threshold=0.5)
    watch.add(np.array([False]))
    before = watch.state

    watch.first_alarm(np.ones(5, np.bool_))

    assert watch.state.tolist() == before.tolist()


def test_a_given_mean_does_not_follow_the_stream() -> None:
    """Of a steady share above it there is an alarm, of one below it never."""
    one_in_four = np.arange(4000) % 4 == 0

    above, below = (PageHinkley(delta=0.125, threshold=20.0, mean=m) for m in (0.0, 0.25))

    # 40 ones in 157 values: 40 - 157 / 8 is the first above 20
    assert above.first_alarm(one_in_four) == 157
    assert below.first_alarm(one_in_four) is None
