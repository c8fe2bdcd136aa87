"""Raw images of every encoding become the same BGR pixels."""

from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mpap_cli.features.images.pixel_formats import RAW_ENCODINGS, bgr_pixels
from mpap_cli.observations import Frame

U8 = NDArray[np.uint8]
RNG = np.random.default_rng(0)
BGR: U8 = RNG.integers(0, 256, (6, 10, 3), dtype=np.uint8)
GRAY: U8 = np.repeat(BGR[:, :, :1], 3, axis=2)
ALPHA: U8 = RNG.integers(0, 256, (6, 10, 1), dtype=np.uint8)
PADDING = 7


def frame_of(encoding: str, pixels: NDArray[Any], padding: int = 0) -> Frame:
    """Return rows of pixels as a frame, each row followed by bytes that mean nothing."""
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(height, -1)
    padded = np.pad(rows, ((0, 0), (0, padding)), constant_values=99)
    return Frame(0, encoding, width, height, padded.shape[1], padded.tobytes())


def deep(pixels: U8) -> NDArray[np.uint16]:
    """Return pixels of 16 bits whose high byte is given."""
    return pixels.astype(np.uint16) * 256 + np.uint16(77)


RGB = BGR[:, :, ::-1]
COLORED = {
    "rgb8": RGB,
    "bgr8": BGR,
    "8UC3": BGR,
    "rgba8": np.dstack([RGB, ALPHA]),
    "bgra8": np.dstack([BGR, ALPHA]),
    "8UC4": np.dstack([BGR, ALPHA]),
    "rgb16": deep(RGB),
    "bgr16": deep(BGR),
    "16UC3": deep(BGR),
    "rgba16": deep(np.dstack([RGB, ALPHA])),
    "bgra16": deep(np.dstack([BGR, ALPHA])),
    "16UC4": deep(np.dstack([BGR, ALPHA])),
}
MONO = {"mono8": GRAY[:, :, :1], "8UC1": GRAY[:, :, :1]}
DEEP_MONO = {"mono16": deep(GRAY[:, :, :1]), "16UC1": deep(GRAY[:, :, :1])}
BAYER = [f"bayer_{order}{bits}" for order in ("rggb", "bggr", "gbrg", "grbg") for bits in (8, 16)]
PAIRED = ["uyvy", "yuv422", "yuyv", "yuv422_yuy2"]


def test_every_encoding_is_tested_here() -> None:
    """The lists of this file are complete."""
    tested = {*COLORED, *MONO, *DEEP_MONO, *BAYER, *PAIRED, "nv12", "nv21", "nv24"}

    assert tested == set(RAW_ENCODINGS)


@pytest.mark.parametrize("padding", [0, PADDING])
@pytest.mark.parametrize("encoding", [*COLORED, *MONO, *DEEP_MONO])
def test_channels_are_put_in_order(encoding: str, padding: int) -> None:
    """Blue, green, red; 16 bits keep the high byte; transparency and padding are left out."""
    pixels = {**COLORED, **MONO, **DEEP_MONO}[encoding]

    image = bgr_pixels(frame_of(encoding, pixels, padding))

    np.testing.assert_array_equal(image, BGR if encoding in COLORED else GRAY)
    assert image is not None
    assert image.flags["C_CONTIGUOUS"]
    assert image.flags["WRITEABLE"]


@pytest.mark.parametrize("padding", [0, PADDING])
@pytest.mark.parametrize("encoding", BAYER)
def test_bayer_patterns_name_their_first_four_pixels(encoding: str, padding: int) -> None:
    """An evenly colored image comes out in that color."""
    color = {"r": 200, "g": 120, "b": 40}
    first_four = [color[letter] for letter in encoding.removeprefix("bayer_")[:4]]
    mosaic = np.tile(np.array(first_four, np.uint8).reshape(2, 2), (4, 5))

    pixels = deep(mosaic) if encoding.endswith("16") else mosaic
    image = bgr_pixels(frame_of(encoding, pixels, padding))

    np.testing.assert_array_equal(image, np.full((8, 10, 3), [40, 120, 200]))


def interleaved(encoding: str, gray: U8, colors: U8) -> U8:
    """Return pixels whose colors (h, w / 2, 2) are shared by two: uyvy, or yuyv."""
    pixels = np.empty((*gray.shape, 2), np.uint8)
    first = encoding in {"uyvy", "yuv422"}
    pixels[..., 1 if first else 0] = gray
    pixels[..., 0 if first else 1] = colors.reshape(gray.shape)
    return pixels


@pytest.mark.parametrize("padding", [0, PADDING])
@pytest.mark.parametrize("encoding", PAIRED)
def test_pairs_share_a_color(encoding: str, padding: int) -> None:
    """Both orders give what OpenCV makes of them."""
    gray, colors = RNG.integers(16, 236, (2, 6, 10), dtype=np.uint8)
    pixels = interleaved(encoding, gray, colors)
    rule = cv2.COLOR_YUV2BGR_UYVY if encoding in {"uyvy", "yuv422"} else cv2.COLOR_YUV2BGR_YUY2

    image = bgr_pixels(frame_of(encoding, pixels, padding))

    np.testing.assert_array_equal(image, cv2.cvtColor(pixels, rule))


@pytest.mark.parametrize("encoding", PAIRED)
def test_an_odd_last_column_of_pairs_is_left_out(encoding: str) -> None:
    """Half a pair has no color."""
    gray, colors = RNG.integers(16, 236, (2, 6, 10), dtype=np.uint8)
    pixels = interleaved(encoding, gray, colors)
    odd = np.concatenate([pixels, pixels[:, :1]], axis=1)

    image = bgr_pixels(frame_of(encoding, odd))

    np.testing.assert_array_equal(image, bgr_pixels(frame_of(encoding, pixels)))
    assert bgr_pixels(frame_of(encoding, pixels[:, :1])) is None


def planar(encoding: str, gray: U8, colors: U8, padding: int = 0) -> Frame:
    """Return a plane of gray before one of colors; a color is (blue, red) difference."""
    height, width = gray.shape
    ordered = colors[..., ::-1] if encoding == "nv21" else colors
    rows = ordered.reshape(len(colors), -1)
    n_color_padding = padding * rows.shape[1] // width
    payload = np.pad(gray, ((0, 0), (0, padding))).tobytes()
    payload += np.pad(rows, ((0, 0), (0, n_color_padding))).tobytes()
    return Frame(0, encoding, width, height, width + padding, payload)


def of_color(luma: int, blue: int, red: int) -> U8:
    """Return what OpenCV makes of one color."""
    pair = np.array([[[luma, blue], [luma, red]]], np.uint8)
    return np.asarray(cv2.cvtColor(pair, cv2.COLOR_YUV2BGR_YUY2)[0, 0], np.uint8)


@pytest.mark.parametrize("padding", [0, 2 * PADDING])
@pytest.mark.parametrize("encoding", ["nv12", "nv21", "nv24"])
def test_planes_of_gray_and_colors_are_joined(encoding: str, padding: int) -> None:
    """Two evenly colored halves keep their colors, whichever way the planes are stored."""
    shared = 1 if encoding == "nv24" else 2
    gray = np.full((6, 8), 90, np.uint8)
    gray[:, 4:] = 150
    colors = np.full((6 // shared, 8 // shared, 2), [60, 190], np.uint8)
    colors[:, 4 // shared :] = [200, 100]

    image = bgr_pixels(planar(encoding, gray, colors, padding))

    assert image is not None
    assert image.shape == (6, 8, 3)
    np.testing.assert_array_equal(image[:, :4], np.tile(of_color(90, 60, 190), (6, 4, 1)))
    np.testing.assert_array_equal(image[:, 4:], np.tile(of_color(150, 200, 100), (6, 4, 1)))


def test_every_pixel_of_nv24_has_its_own_color() -> None:
    """Neighbors do not share."""
    gray = np.full((2, 3), 120, np.uint8)
    colors = RNG.integers(40, 200, (2, 3, 2), dtype=np.uint8)

    image = bgr_pixels(planar("nv24", gray, colors))

    expected = [[of_color(120, int(blue), int(red)) for blue, red in row] for row in colors]
    np.testing.assert_array_equal(image, expected)


@pytest.mark.parametrize("encoding", ["nv12", "nv21"])
def test_odd_last_row_and_column_of_shared_colors_are_left_out(encoding: str) -> None:
    """Their planes of colors are rounded up, and read past them."""
    gray = np.full((5, 6), 90, np.uint8)
    colors = np.full((3, 3, 2), [60, 190], np.uint8)
    whole = planar(encoding, gray, colors)
    odd = Frame(0, encoding, 5, 5, 6, whole.payload)

    image = bgr_pixels(odd)

    np.testing.assert_array_equal(image, np.tile(of_color(90, 60, 190), (4, 4, 1)))


def test_a_step_for_gray_and_colors_together_is_understood() -> None:
    """Some drivers count both planes into the step; the payload tells."""
    gray, colors = np.full((4, 6), 90, np.uint8), np.full((2, 3, 2), [60, 190], np.uint8)
    frame = planar("nv12", gray, colors)

    image = bgr_pixels(Frame(0, "nv12", 6, 4, 12, frame.payload))

    np.testing.assert_array_equal(image, bgr_pixels(frame))


@pytest.mark.parametrize("encoding", sorted(RAW_ENCODINGS))
def test_a_payload_that_is_too_short_is_no_image(encoding: str) -> None:
    """Neither is one whose rows are shorter than its width, or that has no pixels."""
    n_bytes = 8 * 6 * 8

    whole = Frame(0, encoding, 8, 6, 64, bytes(2 * n_bytes))
    broken = [
        Frame(0, encoding, 8, 6, 64, bytes(40)),
        Frame(0, encoding, 65, 6, 8, bytes(60)),
        Frame(0, encoding, 8, 6, 0, bytes(40)),
        Frame(0, encoding, 0, 6, 64, bytes(n_bytes)),
        Frame(0, encoding, 8, 0, 64, bytes(n_bytes)),
        Frame(0, encoding, -8, -6, 64, bytes(n_bytes)),
    ]

    assert bgr_pixels(whole) is not None
    assert [bgr_pixels(frame) for frame in broken] == [None] * len(broken)


@pytest.mark.parametrize("encoding", ["32FC1", "64FC3", "8SC1", "bayer_rggb10", "yuv444", ""])
def test_other_encodings_are_no_image(encoding: str) -> None:
    """Distances, signed numbers, and names that nobody has defined."""
    assert bgr_pixels(Frame(0, encoding, 2, 2, 64, bytes(256))) is None
