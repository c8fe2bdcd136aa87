"""Streams of scans: cuts into blocks, changing geometries, skipped scans, bearings."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import UsageError
from mpap_cli.features.scans.scan_features import ScanEmbedder
from mpap_cli.observations import Float32Array, ScanBlock, ScanGeometry
from mpap_cli.params import SCAN_FEATURE_NAMES, make_settings

SECOND = 10**9
HALF = ScanGeometry(180, -math.pi / 2, math.pi / 180, 0.05, 8.0)
NEATO = ScanGeometry(361, -math.pi, math.pi / 180, 0.02, 5.0)
ROBUST = make_settings("robust").scan


def random_ranges(n: int, n_beams: int, seed: int = 0) -> Float32Array:
    """Return ranges with a fifth of the beams without return."""
    random = np.random.default_rng(seed)
    ranges = random.uniform(0.1, 7.9, (n, n_beams)).astype(np.float32)
    ranges[random.random(ranges.shape) < 0.2] = np.inf
    return ranges


def block_of(ranges: Float32Array, geometry: ScanGeometry, rate_hz: float = 5.0) -> ScanBlock:
    """Return a block of scans at a steady rate from time 0."""
    stamps = (np.arange(len(ranges)) * (SECOND / rate_hz)).astype(np.int64)
    return ScanBlock(stamps, ranges, geometry)


def constant_scan(value: float, n: int = 1, geometry: ScanGeometry = NEATO) -> ScanBlock:
    """Return scans with the same range everywhere."""
    return block_of(np.full((n, geometry.n_beams), value, np.float32), geometry)


@given(
    feature=st.sampled_from(SCAN_FEATURE_NAMES),
    no_return=st.sampled_from(["max", "drop"]),
    gaps=st.lists(st.integers(0, 700), min_size=1, max_size=20),
    cuts=st.lists(st.integers(0, 20), max_size=4),
    seed=st.integers(0, 5),
)
def test_features_do_not_depend_on_the_cuts(
    feature: str, no_return: str, gaps: list[int], cuts: list[int], seed: int
) -> None:
    """A stream gives the same bytes however it is cut into blocks."""
    stamps = np.cumsum(np.array(gaps, np.int64)) * (SECOND // 1000)
    ranges = random_ranges(len(gaps), 361, seed)
    ranges[np.random.default_rng(seed).random(len(gaps)) < 0.3, 100:] = np.inf
    params = replace(ROBUST, feature=feature, no_return=no_return)
    whole, cut = ScanEmbedder(params, math.pi), ScanEmbedder(params, math.pi)
    edges = [0, *sorted(min(c, len(gaps)) for c in cuts), len(gaps)]
    blocks = [ScanBlock(stamps[a:b], ranges[a:b], NEATO) for a, b in pairwise(edges)]

    parts = [cut.transform(block) for block in blocks]
    values = np.concatenate([cut.raw_bins(block) for block in blocks])

    once = whole.transform(ScanBlock(stamps, ranges, NEATO))
    np.testing.assert_array_equal(np.concatenate([p.features for p in parts]), once.features)
    nearest = np.concatenate([p.nearest_ahead_m for p in parts])
    np.testing.assert_array_equal(nearest, once.nearest_ahead_m)
    np.testing.assert_array_equal(values, whole.raw_bins(ScanBlock(stamps, ranges, NEATO)))


def test_look_back_off_does_not_join_scans_of_one_stamp() -> None:
    """Two scans with the same stamp keep their own values."""
    ranges = np.full((2, 361), 0.5, np.float32)
    ranges[1] = 0.8
    embedder = ScanEmbedder(replace(ROBUST, feature="min-value", lookback_s=0.0))

    values = embedder.raw_bins(ScanBlock(np.array([SECOND, SECOND]), ranges, NEATO))

    np.testing.assert_array_equal(values, np.repeat(ranges[:, :1], 12, axis=1))


def test_a_new_log_forgets_what_looks_back() -> None:
    """After reset, or for another log, nothing of the scans before is seen."""
    embedder = ScanEmbedder(ROBUST, math.pi)
    fresh = embedder.transform(constant_scan(0.9)).features
    embedder.transform(constant_scan(0.3))

    embedder.for_log(math.pi)
    again = embedder.transform(constant_scan(0.9)).features
    embedder.transform(constant_scan(0.3))
    embedder.reset()
    once_more = embedder.transform(constant_scan(0.9)).features

    np.testing.assert_array_equal(again, fresh)
    np.testing.assert_array_equal(once_more, fresh)


def test_beam_counts_may_change_within_a_log() -> None:
    """Dimensions stay and the look-back goes on when the geometry changes."""
    embedder = ScanEmbedder(replace(ROBUST, approach_weight=0.0), 0.0)
    near = np.full((1, 926), 4.0, np.float32)
    near[0, 0] = 0.5
    blocks = [ScanBlock(np.array([0]), near, ScanGeometry(926, 0.0, math.tau / 926, 0.1, 40.0))]
    for i, n_beams in enumerate((937, 930, 181)):
        geometry = ScanGeometry(n_beams, 0.0, math.tau / n_beams, 0.1, 40.0)
        ranges = np.full((1, n_beams), 4.0, np.float32)
        blocks.append(ScanBlock(np.array([(i + 1) * SECOND // 4]), ranges, geometry))

    features = np.concatenate([embedder.transform(block).features for block in blocks])

    assert features.shape == (4, embedder.n_dims)
    np.testing.assert_array_equal(features[1:], np.repeat(features[:1], 3, axis=0))


def test_scans_with_too_few_beams_are_skipped() -> None:
    """A broken scan of 10 beams has no feature and leaves no trace in the look-back."""
    broken = ScanGeometry(10, -math.pi / 2, math.pi / 10, 0.05, 8.0)
    params = replace(ROBUST, feature="min-value", fov="180")
    embedder, other = ScanEmbedder(params), ScanEmbedder(params)
    good = block_of(random_ranges(3, 180), HALF)
    embedder.transform(good)
    other.transform(good)

    nothing = embedder.transform(constant_scan(0.1, n=2, geometry=broken))
    no_values = embedder.raw_bins(constant_scan(0.1, n=2, geometry=broken))

    assert nothing.features.shape == (0, embedder.n_dims)
    assert nothing.stamps_ns.size == nothing.kept.size == nothing.nearest_ahead_m.size == 0
    assert no_values.shape == (0, 12)
    later = ScanBlock(good.stamps_ns + SECOND, good.ranges, HALF)
    found, wanted = embedder.transform(later), other.transform(later)
    np.testing.assert_array_equal(found.features, wanted.features)


def test_sectors_outside_the_scanner_read_no_return(caplog: pytest.LogCaptureFixture) -> None:
    """A 180 degree laser has as many dimensions all round; it is said once."""
    embedder = ScanEmbedder(ROBUST)

    with caplog.at_level("DEBUG"):
        values = embedder.raw_bins(constant_scan(0.5, geometry=HALF))[0]
        found = [embedder.transform(constant_scan(0.5, geometry=HALF)) for _ in range(2)]

    assert values.tolist() == [1.0] * 3 + [2.0] * 6 + [1.0] * 3
    assert found[0].features.shape == (1, 24)
    assert caplog.messages == [
        "6 of 12 bins lie outside the field of the scanner and read 'no return'"
    ]


def test_a_clockwise_scanner_sees_the_same() -> None:
    """Reversed beams with a negative increment give the same features and nearest range."""
    ranges = random_ranges(5, 360)
    rising = ScanGeometry(360, -math.pi, math.pi / 180, 0.05, 8.0)
    falling = ScanGeometry(360, math.pi - math.pi / 180, -math.pi / 180, 0.05, 8.0)
    mirrored = np.ascontiguousarray(ranges[:, ::-1])

    for feature in SCAN_FEATURE_NAMES:
        params = replace(ROBUST, feature=feature)
        wanted = ScanEmbedder(params, 0.5).transform(block_of(ranges, rising))
        found = ScanEmbedder(params, 0.5).transform(block_of(mirrored, falling))

        np.testing.assert_array_equal(found.features, wanted.features)
        np.testing.assert_array_equal(found.nearest_ahead_m, wanted.nearest_ahead_m)


def test_nearest_ahead_is_cleaned_and_capped() -> None:
    """What lies behind does not count; nothing ahead reads range_max."""
    ranges = np.full((3, 361), np.inf, np.float32)
    ranges[0, 180] = 0.3  # straight behind
    ranges[1, 89] = 1.5  # 89 degrees to the left
    ranges[2, 300] = -np.inf  # too near, 60 degrees to the right
    for no_return in ("max", "drop"):
        embedder = ScanEmbedder(replace(ROBUST, no_return=no_return), math.pi)

        found = embedder.transform(block_of(ranges, NEATO)).nearest_ahead_m

        assert found.dtype == np.float32
        np.testing.assert_array_equal(found, np.array([5.0, 1.5, 0.02], np.float32))


def test_nearest_bearing_points_at_the_nearest_return() -> None:
    """Radians against forward, to the left positive; NaN where nothing returns."""
    ranges = np.full((4, 361), np.inf, np.float32)
    ranges[0, 0] = 0.5
    ranges[1, 90] = 0.4
    ranges[2, 270] = 0.3
    for no_return in ("max", "drop"):
        embedder = ScanEmbedder(replace(ROBUST, no_return=no_return), math.pi)

        found = embedder.nearest_bearing(block_of(ranges, NEATO))

        assert found.dtype == np.float32
        wanted = [0.0, math.pi / 2, -math.pi / 2, math.nan]
        np.testing.assert_allclose(found, wanted, atol=1e-5)


def test_a_scan_without_beams_has_no_bearing() -> None:
    """Empty scans are skipped and point nowhere."""
    block = constant_scan(1.0, n=2, geometry=ScanGeometry(0, 0.0, 0.1, 0.05, 8.0))
    embedder = ScanEmbedder(ROBUST)

    assert np.isnan(embedder.nearest_bearing(block)).all()
    assert embedder.transform(block).kept.size == 0


def test_an_unusable_range_max_needs_another_one() -> None:
    """range_max 0 is replaced by the survey's; without it the option is named."""
    geometry = replace(NEATO, range_max=0.0)

    with pytest.raises(UsageError, match="--max-range METRES"):
        ScanEmbedder(ROBUST).transform(constant_scan(math.inf, geometry=geometry))
    found = ScanEmbedder(ROBUST, 0.0, 6.0).transform(constant_scan(math.inf, geometry=geometry))

    assert found.nearest_ahead_m.tolist() == [6.0]


@pytest.mark.parametrize("feature", SCAN_FEATURE_NAMES)
def test_input_is_neither_changed_nor_kept(feature: str) -> None:
    """The block stays as it was, may be read-only, and shares no memory with the result."""
    block = block_of(random_ranges(4, 361), NEATO)
    before = block.ranges.copy(), block.stamps_ns.copy()
    block.ranges.flags.writeable = block.stamps_ns.flags.writeable = False
    embedder = ScanEmbedder(replace(ROBUST, feature=feature))

    found = embedder.transform(block)

    np.testing.assert_array_equal(block.ranges, before[0])
    np.testing.assert_array_equal(found.stamps_ns, before[1])
    assert not np.shares_memory(found.stamps_ns, block.stamps_ns)
    assert embedder.transform(constant_scan(1.0, n=0)).features.shape == (0, embedder.n_dims)
