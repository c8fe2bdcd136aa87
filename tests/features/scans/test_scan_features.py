"""Embedded histograms of scans: the features of section 4.1, equation 7, profile robust."""

import math
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest

from mpap_cli.distance import embed
from mpap_cli.features.scans.scan_features import SCAN_FEATURES, ScanEmbedder
from mpap_cli.observations import Float32Array, ScanBlock, ScanGeometry
from mpap_cli.params import PAPER_FEATURES, SCAN_FEATURE_NAMES, ScanParams, make_settings

SECOND = 10**9
HALF = ScanGeometry(180, -math.pi / 2, math.pi / 180, 0.05, 8.0)
NEATO = ScanGeometry(361, -math.pi, math.pi / 180, 0.02, 5.0)
ROBUST = make_settings("robust").scan

BIN_VALUES: dict[str, Callable[[Float32Array], Float32Array]] = {
    "min-value": lambda bins: bins.min(axis=-1),
    "max-value": lambda bins: bins.max(axis=-1),
    "mean-value": lambda bins: bins.mean(axis=-1),
    "global-diff": lambda bins: bins.max(axis=-1) - bins.min(axis=-1),
    "seq-diff": lambda bins: np.abs(np.diff(bins, axis=-1)).mean(axis=-1),
    "seq-diff-signed": lambda bins: (bins[..., 0] - bins[..., -1]) / (bins.shape[-1] - 1),
}


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


def test_every_feature_of_the_settings_exists() -> None:
    """The choices of the setting are the keys of the table."""
    assert tuple(SCAN_FEATURES) == SCAN_FEATURE_NAMES


@pytest.mark.parametrize("feature", BIN_VALUES)
@pytest.mark.parametrize("bins", [6, 12])
def test_values_are_those_of_section_4_1(feature: str, bins: int) -> None:
    """Each feature takes its value from the cleaned ranges of each bin."""
    ranges = random_ranges(20, 180)
    cleaned = np.where(np.isinf(ranges), 8.0, ranges.astype(np.float64))

    values = ScanEmbedder(ScanParams(feature=feature, bins=bins)).raw_bins(block_of(ranges, HALF))

    wanted = BIN_VALUES[feature](cleaned.reshape(20, bins, -1))
    np.testing.assert_allclose(values, wanted, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("feature", [*PAPER_FEATURES, "seq-diff-signed"])
def test_the_embedding_is_that_of_the_plain_values(feature: str) -> None:
    """What comes out is equation 7's embedding of the values of the bins."""
    block = block_of(random_ranges(20, 180), HALF)
    embedder = ScanEmbedder(ScanParams(feature=feature, bins=6))

    found = embedder.transform(block).features

    values = embedder.raw_bins(block).astype(np.float64)
    if feature == "seq-diff-signed":
        values = np.concatenate([np.maximum(values, 0), np.maximum(-values, 0)], axis=1)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, embed(values), atol=1e-6)


@pytest.mark.parametrize("feature", PAPER_FEATURES)
def test_distances_equal_opencvs_bhattacharyya(feature: str) -> None:
    """Equation 7 between two histograms is the distance of their embeddings."""
    block = block_of(random_ranges(30, 180), HALF)
    embedder = ScanEmbedder(ScanParams(feature=feature, bins=12))

    points = embedder.transform(block).features.astype(np.float64)

    histograms = embedder.raw_bins(block)
    for first, second in ((0, 1), (2, 17), (29, 3), (5, 5)):
        wanted = cv2.compareHist(histograms[first], histograms[second], cv2.HISTCMP_BHATTACHARYYA)
        squared = 0.5 * np.sum((points[first] - points[second]) ** 2)
        assert squared == pytest.approx(wanted**2, abs=1e-6)


@pytest.mark.parametrize("feature", SCAN_FEATURE_NAMES)
@pytest.mark.parametrize("keep_scale", [False, True])
def test_features_have_length_one_and_n_dims(feature: str, keep_scale: bool) -> None:
    """Every row is a point on the unit sphere, also where there is no return at all."""
    ranges = random_ranges(6, 361)
    ranges[2:4] = np.inf
    embedder = ScanEmbedder(ScanParams(feature=feature, keep_scale=keep_scale), math.pi)

    found = embedder.transform(block_of(ranges, NEATO))

    assert found.features.shape == (6, embedder.n_dims)
    np.testing.assert_allclose(np.linalg.norm(found.features, axis=1), 1.0, atol=1e-6)
    assert found.kept.tolist() == list(range(6))


@pytest.mark.parametrize("feature", ["global-diff", "seq-diff", "seq-diff-signed"])
def test_scans_without_any_return_have_no_differences(feature: str) -> None:
    """All-infinite scans are empty histograms: equal to each other, without a warning."""
    embedder = ScanEmbedder(ScanParams(feature=feature), math.pi)

    found = embedder.transform(constant_scan(math.inf, n=3)).features

    assert np.all(found[:, -1] == 1)
    assert np.all(found[:, :-1] == 0)


@pytest.mark.parametrize("feature", ["min-value", "inverse-min"])
def test_equation_7_forgets_scale_unless_it_is_kept(feature: str) -> None:
    """0.3 m everywhere equals 0.9 m everywhere; with the slack bin it does not."""
    ranges = np.repeat(np.array([[0.3], [0.9]], np.float32), 361, axis=1)
    params = ScanParams(feature=feature, approach_weight=0.0)
    plain = ScanEmbedder(params, math.pi)
    scaled = ScanEmbedder(replace(params, keep_scale=True), math.pi)

    forgotten = plain.transform(block_of(ranges, NEATO)).features
    kept = scaled.transform(block_of(ranges, NEATO)).features

    assert np.max(np.abs(forgotten[0] - forgotten[1])) < 1e-6
    assert np.max(np.abs(kept[0] - kept[1])) > 0.05


def test_slack_fills_the_histogram_to_its_most() -> None:
    """With the slack bin the mass is bins x range_max, the share of a bin its value of that."""
    params = ScanParams(feature="min-value", bins=6, keep_scale=True)

    found = ScanEmbedder(params).transform(constant_scan(2.0, geometry=HALF)).features[0]

    np.testing.assert_allclose(found[:6] ** 2, 2.0 / (6 * 8.0), rtol=1e-5)
    assert found[6] ** 2 == pytest.approx(1 - 2.0 / 8.0)
    assert found[7] == 0


def robust_point(ring: float, front: float, sectors: list[float], change: float) -> Float32Array:
    """Return the point of profile robust from its nearest ranges, formula by formula."""
    blocks = []
    for weight, ranges in ((1.0, [ring]), (0.5, [front]), (0.5, sectors)):
        inverse = [1 / max(min(r, 1.0), 0.2) for r in ranges]
        blocks.append((weight, [*inverse, 5 * len(ranges) - sum(inverse)]))
    step = max(min(change, 0.5), -0.5)
    blocks.append((0.3, [max(step, 0), max(-step, 0), 0.5 - abs(step)]))
    parts = [math.sqrt(weight / 2.3) * embed([block])[0] for weight, block in blocks]
    return np.concatenate(parts).astype(np.float32)


def test_profile_robust_is_its_formula() -> None:
    """Ring, front, sectors, approach, weighted 1, .5, .5 and .3, with slack and look-back."""
    ranges = np.full((4, 361), 4.0, np.float32)
    ranges[0, 5] = 1.5  # ahead, sector 6
    ranges[1, 5], ranges[2, 5] = 0.5, 0.1
    ranges[3, 100] = 0.4  # left behind, sector 9
    ahead = 2 - math.cos(math.radians(5))
    behind = 2 - math.cos(math.radians(100))
    stamps = (np.array([0.0, 0.6, 1.2, 2.4]) * SECOND).astype(np.int64)
    embedder = ScanEmbedder(ROBUST, math.pi)

    found = embedder.transform(ScanBlock(stamps, ranges, NEATO))

    far = [4.0] * 12
    wanted = [
        robust_point(1.5, 1.5 * ahead, [*far[:6], 1.5, *far[:5]], 0.0),
        robust_point(0.5, 0.5 * ahead, [*far[:6], 0.5, *far[:5]], -1.0),
        robust_point(0.1, 0.1 * ahead, [*far[:6], 0.1, *far[:5]], -0.4),
        robust_point(0.4, 0.4 * behind, [*far[:9], 0.4, *far[:2]], 1.9),
    ]
    assert embedder.n_dims == 24
    np.testing.assert_allclose(found.features, np.array(wanted), atol=1e-6)
    np.testing.assert_allclose(found.nearest_ahead_m, [1.5, 0.5, 0.1, 4.0], rtol=1e-6)


def test_the_nearest_range_of_the_last_second_stays() -> None:
    """An obstacle that vanishes in the blind zone is still seen for the look-back."""
    ranges = np.full((8, 361), 4.0, np.float32)
    ranges[0, 0] = 0.5
    embedder = ScanEmbedder(replace(ROBUST, lookback_s=1.0), math.pi)

    values = embedder.raw_bins(block_of(ranges, NEATO))[:, 6]

    assert values.tolist() == [2.0] * 6 + [1.0] * 2


def test_the_approach_does_not_look_back() -> None:
    """The change of the nearest range ahead comes from single scans."""
    ranges = np.full((5, 361), 2.0, np.float32)
    ranges[1, 0] = 1.8
    params = replace(ROBUST, lookback_s=10.0)

    found = ScanEmbedder(params, math.pi).transform(block_of(ranges, NEATO)).features

    receding, approaching = found[:, 20] > 0, found[:, 21] > 0
    assert approaching.tolist() == [False, True, False, False, False]
    assert receding.tolist() == [False, False, False, False, True]


def test_blocks_of_weight_zero_are_left_out() -> None:
    """Dimensions follow the blocks in use."""
    shapes = {
        (1.0, 0.5, 0.5, 0.3): 24,
        (1.0, 0.5, 0.5, 0.0): 20,
        (1.0, 0.0, 0.5, 0.3): 21,
        (1.0, 0.0, 0.0, 0.0): 3,
        (0.0, 0.0, 1.0, 0.0): 14,
    }
    for (ring, front, sectors, approach), n_dims in shapes.items():
        params = replace(
            ROBUST,
            ring_weight=ring,
            front_weight=front,
            sector_weight=sectors,
            approach_weight=approach,
        )

        found = ScanEmbedder(params).transform(constant_scan(0.5)).features

        assert found.shape == (1, n_dims)
        assert np.linalg.norm(found) == pytest.approx(1.0, abs=1e-6)


def test_a_bin_without_returns_keeps_the_value_of_the_scan_before() -> None:
    """Under drop an empty bin repeats its last value, at first it reads range_max."""
    ranges = np.full((4, 180), 2.0, np.float32)
    ranges[0, :30] = np.inf
    ranges[1, :30] = 3.0
    ranges[2, :30] = np.nan
    ranges[3, :30] = 0.0
    embedder = ScanEmbedder(ScanParams(feature="min-value", bins=6, no_return="drop"))

    values = embedder.raw_bins(block_of(ranges, HALF))

    assert values[:, 0].tolist() == [8.0, 3.0, 3.0, 3.0]
    assert values[:, 1].tolist() == [2.0] * 4


def test_drop_takes_the_value_of_the_beams_that_are_left() -> None:
    """Beams without return count neither as range_max nor as a step."""
    ranges = np.tile(np.array([1.0, np.inf, 3.0], np.float32), 60)[None]
    wanted = {"max-value": 3.0, "mean-value": 2.0, "global-diff": 2.0, "seq-diff": 2.0}

    for feature, value in wanted.items():
        params = ScanParams(feature=feature, bins=6, no_return="drop")
        found = ScanEmbedder(params).raw_bins(block_of(ranges, HALF))
        assert found.tolist() == [[value] * 6]
