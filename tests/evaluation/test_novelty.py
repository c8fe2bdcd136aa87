"""Windows of new observations over logs made by hand; stamps in seconds."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.novelty import NoveltyMeter, NoveltyRow
from mpap_cli.evaluation.novelty_windows import OBSERVATIONS, sum_windows
from mpap_cli.observations import NS_PER_S, IntArray

PATCHES = 36


def ns(seconds: Sequence[float]) -> IntArray:
    """Return stamps."""
    return np.array([round(second * NS_PER_S) for second in seconds], dtype=np.int64)


def play(
    meter: NoveltyMeter,
    name: str,
    seconds: Sequence[float],
    novel: Sequence[int],
    unknown: Sequence[int] | None = None,
) -> None:
    """Let the meter see one log that begins at 0 s."""
    meter.begin_log(name, 0)
    seen = None if unknown is None else np.array(unknown)
    meter.add(ns(seconds), PATCHES, np.array(novel), seen, 7)
    meter.end_log()


def test_columns_are_those_of_the_table() -> None:
    """The fields of a row are the columns of novelty.csv, in order."""
    names = [item.name for item in fields(NoveltyRow)]

    assert names == [
        "log", "log_index", "sensor", "window_start_s", "window_end_s", "start_stamp_ns",
        "observations", "novel", "percent_novel", "percent_unknown_at_start", "clusters",
    ]  # fmt: skip


def test_windows_begin_with_the_first_observation_of_each_log() -> None:
    """Windows tumble from there, times count from the first message, none straddles logs."""
    meter = NoveltyMeter("image")

    play(meter, "a", [5, 64.9, 65], [36, 0, 9])
    play(meter, "b", [100, 130], [0, 18], [36, 36])

    starts = [(row.log, row.log_index, row.window_start_s) for row in meter.rows()]
    assert starts == [("a", 0, 5.0), ("a", 0, 65.0), ("b", 1, 100.0)]
    assert [row.start_stamp_ns for row in meter.rows()] == ns([5, 65, 100]).tolist()
    assert [row.window_end_s for row in meter.rows()] == [65.0, 65.0, 130.0]
    assert [row.percent_novel for row in meter.rows()] == [50.0, 25.0, 25.0]
    assert [row.percent_unknown_at_start for row in meter.rows()] == [None, None, 100.0]
    assert [row.clusters for row in meter.rows()] == [7, 7, 7]


def test_empty_window_has_no_row() -> None:
    """A pause of years is no row, and takes no time."""
    meter = NoveltyMeter("scan")

    play(meter, "a", [0, 1e9], [1, 0])

    assert [row.window_start_s for row in meter.rows()] == [0.0, 999_999_960.0]


def test_overlapping_windows_begin_every_step() -> None:
    """Each holds a whole window; the last one is the first that reaches the end."""
    meter = NoveltyMeter("image", window_s=60, step_s=10)

    play(meter, "a", range(81), [36] * 10 + [0] * 71)

    rows = meter.rows()
    assert [row.window_start_s for row in rows] == [0, 10, 20, 30]
    assert [row.window_end_s for row in rows] == [60, 70, 80, 80]
    assert [row.observations for row in rows] == [60 * 36, 60 * 36, 60 * 36, 51 * 36]
    assert [row.novel for row in rows] == [360, 0, 0, 0]


def test_log_shorter_than_a_window_is_one_window() -> None:
    """It has one row, whatever the step."""
    meter = NoveltyMeter("image", window_s=60, step_s=10)

    play(meter, "a", [0, 11, 25], [1, 2, 3])

    assert [(row.window_start_s, row.window_end_s, row.novel) for row in meter.rows()] == [
        (0.0, 25.0, 6)
    ]


def test_clock_that_jumps_back_makes_no_windows() -> None:
    """What is stamped before an earlier observation counts at the time of that."""
    meter = NoveltyMeter("image")
    meter.begin_log("a", 0)

    meter.add(ns([100, 170, 20]), PATCHES, np.array([0, 0, 36]))
    meter.add(ns([10, 175]), PATCHES, np.array([36, 0]))
    meter.end_log()

    rows = meter.rows()
    assert [(row.window_start_s, row.observations, row.novel) for row in rows] == [
        (100.0, 36, 0),
        (160.0, 4 * 36, 72),
    ]


def test_boundary_compares_with_the_windows_before() -> None:
    """First window against the last three, over their observations; unknown of the log."""
    meter = NoveltyMeter("image")
    play(meter, "a", [0, 60, 120, 180, 180.1], [36, 18, 9, 0, 9])

    play(meter, "b", [0, 1, 60], [36, 18, 0], [36, 36, 0])

    first, second = meter.boundaries()
    assert (first.percent_unknown_at_start, first.first_window_percent) == (None, 100.0)
    assert first.ratio is None
    assert second.percent_unknown_at_start == pytest.approx(200 / 3)
    assert second.first_window_percent == 75.0
    assert second.ratio == pytest.approx(0.75 / 0.25)


def test_boundary_does_not_depend_on_the_step() -> None:
    """Overlapping windows are for the plot; boundaries look at those one after the other."""
    whole, sliding = NoveltyMeter("image"), NoveltyMeter("image", step_s=15)

    for meter in (whole, sliding):
        play(meter, "a", range(300), [9] * 100 + [0] * 200)
        play(meter, "b", range(90), [18] * 90)

    assert whole.boundaries() == sliding.boundaries()


def test_nothing_novel_before_gives_no_ratio() -> None:
    """Nothing is infinitely many times nothing."""
    meter = NoveltyMeter("image")

    play(meter, "a", [0], [0])
    play(meter, "b", [0], [36])

    assert meter.boundaries()[1].ratio is None


def test_log_without_observation_has_no_row_but_a_number() -> None:
    """The next log keeps its place in the order given."""
    meter = NoveltyMeter("image")

    play(meter, "dark", [], [])
    play(meter, "a", [3], [1])

    assert [(row.log, row.log_index) for row in meter.rows()] == [("a", 1)]
    assert [boundary.log for boundary in meter.boundaries()] == ["a"]


def test_uncounted_clusters_are_left_empty() -> None:
    """Who does not say how many clusters there are gets an empty cell."""
    meter = NoveltyMeter("scan")
    meter.begin_log("a", 0)

    meter.add(ns([0]), 1, np.array([1]))
    meter.end_log()

    assert meter.rows()[0].clusters is None


@pytest.mark.parametrize(("window_s", "step_s"), [(60, 7), (10, 20), (0, None), (-1, None)])
def test_step_must_divide_the_window(window_s: float, step_s: float | None) -> None:
    """Anything else is refused in one line."""
    with pytest.raises(UsageError, match="does not divide the window"):
        NoveltyMeter("image", window_s, step_s)


@given(
    steps=st.lists(st.integers(0, 40), min_size=1, max_size=60),
    width=st.sampled_from([1, 2, 3, 6]),
    cuts=st.lists(st.integers(0, 60), max_size=5),
    seed=st.integers(0, 99),
)
def test_windows_equal_a_plain_count(
    steps: list[int], width: int, cuts: list[int], seed: int
) -> None:
    """However the log is cut into blocks, each window counts what lies in it."""
    seconds = np.cumsum(steps)
    generator = np.random.default_rng(seed)
    novel = generator.integers(0, PATCHES + 1, seconds.size)
    meter = NoveltyMeter("image", window_s=10.0 * width, step_s=10)
    meter.begin_log("a", 0)

    for part in np.split(np.arange(seconds.size), sorted(cuts)):
        meter.add(ns(seconds[part].tolist()), PATCHES, novel[part], novel[part], 1)
    meter.end_log()

    expected = []
    since = seconds - seconds[0]
    start = 0
    while True:
        inside = (since >= start) & (since < start + 10 * width)
        if inside.any():
            expected.append((start, int(inside.sum()) * PATCHES, int(novel[inside].sum())))
        # bins are as long as a step, so the end is reached with the last one's bin
        if since[-1] // 10 * 10 < start + 10 * width:
            break
        start += 10
    rows = meter.rows()
    found = [(row.window_start_s - seconds[0], row.observations, row.novel) for row in rows]
    assert found == expected
    assert all(row.percent_unknown_at_start == row.percent_novel for row in rows)


@given(st.sets(st.integers(0, 200), min_size=1), st.integers(1, 6))
def test_windows_one_after_the_other_count_everything_once(bins: set[int], width: int) -> None:
    """Their observations sum up to all of them."""
    table = np.array([[index, 36, 1, 0, 5] for index in sorted(bins)], dtype=np.int64)

    found = sum_windows(table, width, width)

    assert found[:, OBSERVATIONS].sum() == table[:, OBSERVATIONS].sum()
