"""Looking back goes by stamps, and does not see how a stream is cut."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.features.scans.temporal import ChangeOverTime, SlidingMinimum, to_ns
from mpap_cli.observations import Float64Array, IntArray

SECOND = 10**9


@st.composite
def streams(draw: st.DrawFn) -> tuple[IntArray, Float64Array, list[int]]:
    """Draw stamps that do not fall, values, and where the stream is cut."""
    gaps = draw(st.lists(st.integers(0, 6), min_size=1, max_size=25))
    stamps = np.cumsum(np.array(gaps, np.int64)) + 1_700_000_000 * SECOND
    values = np.array(draw(st.lists(st.integers(0, 9), min_size=len(gaps), max_size=len(gaps))))
    cuts = draw(st.lists(st.integers(0, len(gaps)), max_size=4))
    return stamps, values.astype(np.float64), [0, *sorted(cuts), len(gaps)]


@given(stream=streams(), window=st.integers(0, 9))
def test_minimum_does_not_depend_on_the_cuts(
    stream: tuple[IntArray, Float64Array, list[int]], window: int
) -> None:
    """Any cut gives the minimum over the rows at most one window old."""
    stamps, values, cuts = stream
    sliding = SlidingMinimum(window / SECOND, 1)

    parts = [sliding.push(stamps[a:b], values[a:b, None]) for a, b in pairwise(cuts)]

    wanted = [
        min(v for s, v in zip(stamps[: i + 1], values, strict=False) if s >= stamps[i] - window)
        for i in range(stamps.size)
    ]
    assert np.concatenate(parts).ravel().tolist() == wanted


@given(stream=streams(), span=st.integers(1, 9))
def test_change_does_not_depend_on_the_cuts(
    stream: tuple[IntArray, Float64Array, list[int]], span: int
) -> None:
    """Any cut compares with the row whose stamp is nearest to one span before."""
    stamps, values, cuts = stream
    change = ChangeOverTime(span / SECOND)

    parts = [change.push(stamps[a:b], values[a:b]) for a, b in pairwise(cuts)]

    found = np.concatenate(parts)
    for i in range(stamps.size):
        age = np.abs(stamps[i] - span - stamps[: i + 1])
        nearest = age == age.min()
        assert found[i] in (values[i] - values[: i + 1])[nearest]
    whole = ChangeOverTime(span / SECOND).push(stamps, values)
    np.testing.assert_array_equal(found, whole)


def test_a_row_exactly_one_window_old_counts() -> None:
    """The window is closed: at 2 s a window of 1 s still holds the row at 1 s."""
    stamps = np.array([0, 1, 2]) * SECOND

    minima = SlidingMinimum(1.0, 1).push(stamps, np.array([[1.0], [2.0], [3.0]]))

    assert minima.ravel().tolist() == [1.0, 1.0, 2.0]


def test_change_takes_the_third_scan_back_at_five_hertz() -> None:
    """With 0.6 s and scans each 0.2 s, somewhat unsteady, the change spans three scans."""
    stamps = np.array([0.0, 0.21, 0.39, 0.61, 0.80, 1.02]) * SECOND
    values = np.array([5.0, 4.0, 3.0, 2.0, 1.0, 0.0])

    changes = ChangeOverTime(0.6).push(stamps.astype(np.int64), values)

    assert changes.tolist() == [0.0, -1.0, -2.0, -3.0, -3.0, -3.0]


def test_change_is_zero_behind_a_gap() -> None:
    """What lies more than two spans back is not compared with."""
    stamps = np.array([0, 10 * SECOND])

    assert ChangeOverTime(0.6).push(stamps, np.array([2.0, 0.5])).tolist() == [0.0, 0.0]


def test_the_state_holds_one_window_only() -> None:
    """A long stream leaves the rows of one window behind, not itself."""
    sliding, change = SlidingMinimum(1.0, 1), ChangeOverTime(1.0)
    for start in range(0, 1000, 100):
        stamps = np.arange(start, start + 100) * SECOND // 10
        sliding.push(stamps, np.zeros((100, 1)))
        change.push(stamps, np.zeros(100))

    assert sliding._stamps_ns.size == 11
    assert change._stamps_ns.size == 12


@pytest.mark.parametrize("seconds", [1e12, float("inf")])
def test_an_endless_window_does_not_overflow(seconds: float) -> None:
    """Very long windows see everything."""
    stamps = np.array([1_700_000_000, 1_800_000_000]) * SECOND

    minima = SlidingMinimum(seconds, 1).push(stamps, np.array([[1.0], [2.0]]))

    assert minima.ravel().tolist() == [1.0, 1.0]
    assert to_ns(seconds) == 2**62


def test_input_is_neither_kept_nor_changed() -> None:
    """What was pushed may be overwritten afterwards."""
    stamps, values = np.array([0, SECOND // 2]), np.array([[1.0], [2.0]])
    sliding = SlidingMinimum(1.0, 1)
    sliding.push(stamps, values)
    values[:] = -9.0

    minima = sliding.push(np.array([SECOND]), np.array([[3.0]]))

    assert minima.tolist() == [[1.0]]
