"""The kernels of scans equal readable loops, on random and adversarial ranges."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.features.scans import _kernels
from mpap_cli.observations import Float32Array, Float64Array, IntArray

STATISTICS = np.arange(6)
NASTY = [0.0, -0.0, 0.02, 0.05, 0.049, 1.0, 3.0, 4.999, 5.0, 5.001, 8.0, 8.001, 81.83]
NASTY += [math.inf, -math.inf, math.nan, -1.0, 1e-40]
LIMITS = {
    "max": [0.05, 8.0, 8.0, 0.05, 8.0, 8.0],
    "capped": [0.05, 8.0, 5.0, 0.05, 0.05, 5.0],
    "drop": [0.05, 8.0, 5.0, 0.05, -1.0, -1.0],
    "drop near": [0.05, 8.0, 8.0, -1.0, -1.0, -1.0],
}


def clean_beam(r: float, limits: Float32Array) -> float:
    """Return the cleaned range of one beam."""
    range_min, reach, cap, near, zero, none = (float(limit) for limit in limits)
    rules = (
        (math.isnan(r), none),
        (r == math.inf, none),
        (r == -math.inf, near),
        (r == 0, zero),
        (r < 0, none),
        (r > reach, none),
        (r < range_min, near),
        (True, min(r, cap)),
    )
    return next(value for holds, value in rules if holds)


def bin_value(statistic: int, ranges: list[float]) -> float:
    """Return one value of the ranges of one bin, as section 4.1 lists them."""
    falls = [a - b for a, b in pairwise(ranges)]
    n_steps = max(len(falls), 1)
    return [
        min(ranges),
        max(ranges),
        sum(ranges) / len(ranges),
        max(ranges) - min(ranges),
        sum(abs(fall) for fall in falls) / n_steps,
        sum(falls) / n_steps,
    ][statistic]


def reference(
    ranges: Float32Array, limits: Float32Array, runs: IntArray, stretch: Float32Array
) -> tuple[Float64Array, Float32Array, Float32Array]:
    """Do what ``bin_block`` does, one beam after the other."""
    n_scans, n_bins, n_turn = len(ranges), len(runs) - 1, len(stretch)
    values = np.empty((6, n_scans, n_bins))
    nearest, front = np.empty(n_scans, np.float32), np.empty(n_scans, np.float32)
    for i, scan in enumerate(ranges):
        cleaned = [clean_beam(float(r), limits) for r in scan]
        inside = [
            [cleaned[k % n_turn] for k in range(start, stop) if cleaned[k % n_turn] >= 0]
            for start, stop in runs
        ]
        nearest[i] = min([*inside[-1], limits[2]])
        stretched = [
            np.float32(cleaned[k % n_turn]) * stretch[k % n_turn]
            for start, stop in runs[:-1]
            for k in range(start, stop)
            if cleaned[k % n_turn] >= 0
        ]
        front[i] = min([*stretched, limits[2]])
        for b in range(n_bins):
            for statistic in range(6):
                if inside[b]:
                    value = bin_value(statistic, inside[b])
                elif runs[b, 1] > runs[b, 0] and i > 0:
                    value = values[statistic, i - 1, b]
                else:
                    value = limits[2] if statistic < 3 else 0.0
                values[statistic, i, b] = value
    return values, nearest, front


@st.composite
def blocks(draw: st.DrawFn) -> tuple[Float32Array, IntArray, Float32Array]:
    """Draw ranges, runs of beams that may cross the wrap or be empty, and stretches of a turn."""
    n_beams = draw(st.integers(2, 12))
    n_turn = draw(st.integers(max(2, n_beams - 1), n_beams))
    n_scans = draw(st.integers(0, 2 * _kernels.LANES + 1))
    beam = st.sampled_from(NASTY) | st.floats(0, 9, width=32)
    rows = draw(st.lists(st.lists(beam, min_size=4, max_size=4), min_size=1, max_size=4))
    picks = np.random.default_rng(draw(st.integers(0, 99))).integers(0, 4, (2, n_scans, n_beams))
    table = np.array(rows, np.float32)
    ranges = table[picks[0] % len(rows), picks[1]]
    run = st.tuples(st.integers(0, n_turn - 1), st.integers(0, n_turn))
    runs = [(start, start + n) for start, n in draw(st.lists(run, min_size=2, max_size=4))]
    stretch = 1.0 + np.random.default_rng(n_turn).integers(0, 3, n_turn) / 2
    return ranges, np.array(runs, np.int64), stretch.astype(np.float32)


@pytest.mark.parametrize("kind", LIMITS)
@given(block=blocks())
def test_a_block_equals_the_loop_over_its_beams(
    kind: str, block: tuple[Float32Array, IntArray, Float32Array]
) -> None:
    """Values and nearest ranges equal the loop exactly, whatever the beams hold."""
    ranges, runs, stretch = block
    limits = np.array(LIMITS[kind], np.float32)
    held = np.full((6, len(runs) - 1), np.nan)

    values, nearest, front = _kernels.bin_block(ranges, limits, runs, stretch, STATISTICS, held)

    wanted_values, wanted_nearest, wanted_front = reference(ranges, limits, runs, stretch)
    np.testing.assert_array_equal(values, wanted_values)
    np.testing.assert_array_equal(nearest, wanted_nearest)
    np.testing.assert_array_equal(front, wanted_front)
    if len(ranges):
        np.testing.assert_array_equal(held, values[:, -1])


def test_only_what_is_asked_is_written() -> None:
    """One statistic alone equals its row of all six."""
    ranges = np.random.default_rng(0).uniform(0, 9, (40, 30)).astype(np.float32)
    limits = np.array(LIMITS["max"], np.float32)
    runs = np.array([[0, 15], [15, 30], [0, 30]])
    together = run_bins(ranges, limits, runs, STATISTICS)

    alone = [run_bins(ranges, limits, runs, STATISTICS[[s]]) for s in STATISTICS]

    np.testing.assert_array_equal(np.concatenate(alone), together)


def test_front_is_the_cap_where_it_is_not_wanted() -> None:
    """All else is the same without it."""
    ranges = np.random.default_rng(0).uniform(0, 9, (40, 30)).astype(np.float32)
    limits = np.array(LIMITS["capped"], np.float32)
    runs, stretch = np.array([[0, 15], [15, 30], [3, 30]]), np.ones(30, np.float32)
    made = [
        _kernels.bin_block(
            ranges, limits, runs, stretch, STATISTICS, np.full((6, 2), np.nan), wants_front=wanted
        )
        for wanted in (True, False)
    ]

    (values, nearest, front), (others, other_nearest, none) = made

    np.testing.assert_array_equal(others, values)
    np.testing.assert_array_equal(other_nearest, nearest)
    assert front.min() < 5.0
    assert set(none.tolist()) == {5.0}


@pytest.mark.parametrize("kind", LIMITS)
def test_cleaning_alone_equals_the_loop(kind: str) -> None:
    """Every kind of beam is cleaned as the loop does it."""
    ranges = np.array([NASTY, NASTY[::-1]], np.float32)
    limits = np.array(LIMITS[kind], np.float32)

    cleaned = _kernels.clean_block(ranges, limits)

    beams = [[clean_beam(float(r), limits) for r in scan] for scan in ranges]
    np.testing.assert_array_equal(cleaned, np.array(beams))


def run_bins(
    ranges: Float32Array, limits: Float32Array, runs: IntArray, statistics: IntArray
) -> Float64Array:
    """Return the values of a block of scans that follow no other."""
    held = np.full((statistics.size, len(runs) - 1), np.nan)
    stretch = np.ones(ranges.shape[1], np.float32)
    return _kernels.bin_block(ranges, limits, runs, stretch, statistics, held)[0]


def test_bodies_run_as_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the compiler the kernels give the same values."""
    ranges = np.array([[0.5, math.inf, 0.0, 3.0], [math.nan, 9.0, -1.0, 0.01]] * 9, np.float32)
    limits = np.array(LIMITS["drop"], np.float32)
    runs = np.array([[3, 5], [1, 3], [0, 0], [0, 4]])
    asked = (STATISTICS, STATISTICS[:1], STATISTICS[2:3])
    compiled = [run_bins(ranges, limits, runs, statistics) for statistics in asked]
    cleaned = _kernels.clean_block(ranges, limits)
    for name in dir(_kernels):
        kernel = getattr(_kernels, name)
        if hasattr(kernel, "py_func"):
            monkeypatch.setattr(_kernels, name, kernel.py_func)

    with np.errstate(invalid="ignore"):
        plain = [run_bins(ranges, limits, runs, statistics) for statistics in asked]

    for i in range(len(asked)):
        np.testing.assert_array_equal(plain[i], compiled[i])
    np.testing.assert_array_equal(_kernels.clean_block(ranges, limits), cleaned)
