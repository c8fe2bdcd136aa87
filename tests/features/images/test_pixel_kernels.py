"""What is told of pixels equals OpenCV's colors, scikit-image's patterns, and plain loops."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from skimage.feature import local_binary_pattern

from mpap_cli.features.images.image_decode import Image
from mpap_cli.features.images.lbp import uniform_codes
from mpap_cli.features.images.pixels import _kernels
from mpap_cli.observations import IntArray

U8 = NDArray[np.uint8]
# From the neighbor to the right against the clock: rows down, columns to the right.
AROUND = [(0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0), (1, 1)]


def images() -> list[Image]:
    """Return random, even, nearly even, striped and tiny images."""
    rng = np.random.default_rng(0)
    noise = rng.integers(0, 256, (50, 70, 3), dtype=np.uint8)
    smooth = np.asarray(cv2.GaussianBlur(noise, (0, 0), 3), np.uint8)
    return [
        noise,
        smooth,
        smooth // 32 * 32,
        rng.integers(100, 102, (33, 129, 3), dtype=np.uint8),
        np.full((9, 8, 3), 255, np.uint8),
        np.zeros((8, 8, 3), np.uint8),
        np.tile(np.array([[[0, 0, 255], [255, 0, 0]]], np.uint8), (12, 40, 1)),
        rng.integers(0, 256, (3, 3, 3), dtype=np.uint8),
    ]


def scikit_image_codes(gray: U8, method: str = "default") -> IntArray:
    """Return what scikit-image makes of every pixel, as whole numbers."""
    codes = local_binary_pattern(gray, 8, 1, method=method)  # type: ignore[no-untyped-call]
    return np.asarray(codes, np.int64)


def described(image: Image, *, circular: bool) -> tuple[NDArray[np.uint16], U8]:
    """Return index and code of every pixel."""
    index, codes = np.empty(image.shape[:2], np.uint16), np.empty(image.shape[:2], np.uint8)
    _kernels.describe_pixels(image, index, codes, circular=circular)
    return index, codes


def square_code(gray: U8, y: int, x: int) -> int:
    """Return the code of one pixel, as Ojala et al. define it on the 3x3 square."""
    return sum(
        1 << bit
        for bit, (down, right) in enumerate(AROUND)
        if gray[y + down, x + right] >= gray[y, x]
    )


@pytest.mark.parametrize("image", images())
def test_colors_are_those_of_opencv(image: Image) -> None:
    """Hue of 180 and saturation and value of 256 steps, in 16 bins each."""
    hue, saturation, value = cv2.split(cv2.cvtColor(image, cv2.COLOR_BGR2HSV).astype(int))

    index, _ = described(image, circular=False)

    np.testing.assert_array_equal(index % 16, saturation // 16)
    np.testing.assert_array_equal(index // 16 % 16, hue * 16 // 180)
    np.testing.assert_array_equal(index // 256, value // 16)


@pytest.mark.slow
def test_every_color_there_is_has_the_bins_of_opencv() -> None:
    """All 16.8 million; and the gray that the codes are taken from."""
    every = np.arange(1 << 24, dtype=np.uint32)
    blue, green, red = ((every >> shift).astype(np.uint8) for shift in (0, 8, 16))
    image = np.stack([blue, green, red], axis=1).reshape(4096, 4096, 3)
    hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV).astype(np.uint16)
    expected = (hsv[..., 2] // 16) * 256 + (hsv[..., 0] * 16 // 180) * 16 + hsv[..., 1] // 16

    gray = np.empty(1 << 24, np.uint8)

    index, _ = described(image, circular=False)
    _kernels._gray_row(blue, green, red, gray)

    assert np.array_equal(index, expected)
    assert np.array_equal(gray, cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).ravel())


@pytest.mark.parametrize("image", images())
def test_square_codes_equal_plain_loops(image: Image) -> None:
    """A neighbor that is as bright as the pixel counts; the border has code 0."""
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.uint8)
    height, width = gray.shape
    expected = np.zeros((height, width), np.uint8)
    expected[1:-1, 1:-1] = [
        [square_code(gray, y, x) for x in range(1, width - 1)] for y in range(1, height - 1)
    ]

    _, codes = described(image, circular=False)

    np.testing.assert_array_equal(codes, expected)


@pytest.mark.parametrize("image", images())
def test_circular_codes_equal_those_of_scikit_image(image: Image) -> None:
    """Eight neighbors on a circle of radius 1, interpolated; inside the border."""
    expected = scikit_image_codes(np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8))

    _, codes = described(image, circular=True)

    np.testing.assert_array_equal(codes[1:-1, 1:-1], expected[1:-1, 1:-1])
    assert not codes[[0, -1]].any()
    assert not codes[:, [0, -1]].any()


@given(levels=st.integers(1, 256), seed=st.integers(0, 10**6))
def test_ties_are_decided_as_scikit_image_does(levels: int, seed: int) -> None:
    """Few levels of gray make many neighbors that are exactly as bright as the pixel."""
    rng = np.random.default_rng(seed)
    gray = (rng.integers(0, levels, (30, 40)) * (255 // levels)).astype(np.uint8)

    _, codes = described(np.dstack([gray] * 3), circular=True)

    expected = scikit_image_codes(gray)
    np.testing.assert_array_equal(codes[1:-1, 1:-1], expected[1:-1, 1:-1])


def test_bins_of_codes_are_those_of_scikit_image() -> None:
    """nri_uniform: 58 codes have a bin of their own, all others the last."""
    rng = np.random.default_rng(0)
    gray = rng.integers(0, 256, (200, 200), dtype=np.uint8)
    codes = scikit_image_codes(gray)
    bins = np.full(256, 58)

    bins[uniform_codes()] = np.arange(58)

    assert np.unique(codes).size == 256
    np.testing.assert_array_equal(bins[codes], scikit_image_codes(gray, "nri_uniform"))


def test_uniform_codes_change_at_most_twice_around_the_circle() -> None:
    """There are 58 of them, each once."""
    n_changes = [(code ^ (code >> 1 | (code & 1) << 7)).bit_count() for code in range(256)]

    codes = uniform_codes()

    assert sorted(codes.tolist()) == [code for code in range(256) if n_changes[code] <= 2]


def test_the_image_is_left_as_it_is() -> None:
    """Nothing is written into what comes in."""
    image = images()[0]
    before = image.copy()

    described(image, circular=True)

    np.testing.assert_array_equal(image, before)


@pytest.mark.parametrize("circular", [False, True])
def test_kernels_run_uncompiled(circular: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same code, line by line, gives the same."""
    image = np.random.default_rng(1).integers(0, 256, (5, 6, 3), dtype=np.uint8)
    compiled = described(image, circular=circular)
    for name in [name for name in vars(_kernels) if name.startswith("_") and "row" in name]:
        monkeypatch.setattr(_kernels, name, getattr(_kernels, name).py_func)
    monkeypatch.setattr(_kernels, "_between", _kernels._between.py_func)
    monkeypatch.setattr(_kernels, "_describe_image", _kernels._describe_image.py_func)

    plain = described(image, circular=circular)

    for found, expected in zip(plain, compiled, strict=True):
        np.testing.assert_array_equal(found, expected)
