"""Compressed images are told by their bytes, and whole ones from broken ones."""

import struct
import zlib
from typing import Any

import cv2
import numpy as np
import pytest

from mpap_cli.features.images.image_decode import Image, decode_frame, decode_scaled
from mpap_cli.observations import Frame

END = b"\xff\xd9"


def compressed(payload: bytes) -> Frame:
    """Return a compressed image."""
    return Frame(0, "compressed", 0, 0, 0, payload)


def picture(width: int = 64, height: int = 48) -> Image:
    """Return an image with slopes in all three colors."""
    y, x = np.mgrid[:height, :width]
    channels = [255 * x // width, 255 * y // height, 255 * (x + y) // (width + height)]
    return np.stack(channels, axis=2).astype(np.uint8)


def encoded(kind: str, pixels: Any, *options: int) -> bytes:
    """Return an image in a compressed format."""
    return bytes(cv2.imencode(kind, pixels, options)[1])


def png_of(chunks: list[tuple[bytes, bytes]]) -> bytes:
    """Return a PNG of some chunks."""
    parts = [
        struct.pack(">I", len(content))
        + name
        + content
        + struct.pack(">I", zlib.crc32(name + content))
        for name, content in chunks
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def png_of_size(width: int, height: int) -> bytes:
    """Return a PNG that states a size and holds no pixels."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return png_of([(b"IHDR", header), (b"IDAT", zlib.compress(b"")), (b"IEND", b"")])


def bmp_of_size(width: int, height: int) -> bytes:
    """Return a bitmap that states a size and holds no pixels."""
    header = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, 0, 0, 0, 0, 0)
    return b"BM" + struct.pack("<IHHI", 54, 0, 0, 54) + header


def with_segment(jpeg: bytes, content: bytes) -> bytes:
    """Put an application segment behind the start of a JPEG."""
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(content) + 2) + content + jpeg[2:]


def with_size(jpeg: bytes, width: int, height: int) -> bytes:
    """Let a baseline JPEG state another size."""
    at = jpeg.index(b"\xff\xc0") + 5
    return jpeg[:at] + struct.pack(">HH", height, width) + jpeg[at + 4 :]


JPEG = encoded(".jpg", picture())


@pytest.mark.parametrize(
    "frame",
    [
        Frame(0, "rgb8", 0, 0, 0, b""),
        Frame(0, "rgb8", 0, 3, 4, bytes(12)),
        Frame(0, "rgb8", -1, 1, 3, bytes(3)),
        Frame(0, "rgb8", 2, 2, 6, bytes(11)),
        Frame(0, "32FC1", 1, 1, 4, bytes(4)),
        compressed(b""),
        compressed(b"no image"),
        compressed(png_of_size(100_000, 100_000)),
        compressed(png_of_size(20_000, 10_000)),
        compressed(png_of([(b"IHDR", b""), (b"IEND", b"")])),
        compressed(bmp_of_size(100_000, 100_000)),
        compressed(with_size(JPEG, 0, 48)),
        compressed(with_size(JPEG, 65_000, 65_000)),
    ],
)
def test_what_is_no_image_is_none(frame: Frame) -> None:
    """Without pixels, cut off, of another encoding, garbled, or of a size that cannot be."""
    assert decode_frame(frame) is None


@pytest.mark.parametrize("kind", [".jpg", ".png", ".webp"])
def test_images_that_are_cut_off_are_none(kind: str) -> None:
    """Wherever the end is missing, be it by two bytes."""
    whole = encoded(kind, picture())

    cut = [whole[:n] for n in (4, 12, 30, len(whole) // 2, len(whole) - 2)]

    assert decode_frame(compressed(whole)) is not None
    assert [decode_frame(compressed(payload)) for payload in cut] == [None] * len(cut)


def test_a_png_with_a_wrong_checksum_is_none() -> None:
    """One byte that changed spoils all pixels behind it."""
    whole = encoded(".png", picture())
    at = len(whole) // 2

    image = decode_frame(compressed(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :]))

    assert image is None


@pytest.mark.parametrize(
    "payload", [JPEG[:2] + END, JPEG[:2] + b"\xff\x01" + END + bytes(20), JPEG[:20]]
)
def test_a_jpeg_without_a_scan_is_none(payload: bytes) -> None:
    """It ends, or breaks off, among its headers."""
    assert decode_frame(compressed(payload)) is None


def test_the_end_of_a_thumbnail_is_not_that_of_the_jpeg() -> None:
    """An application segment may hold a whole JPEG of its own."""
    whole = with_segment(JPEG, encoded(".jpg", picture(16, 16)))

    image = decode_frame(compressed(whole))

    assert image is not None
    assert image.shape == (48, 64, 3)
    assert decode_frame(compressed(whole[:-40])) is None


def test_bytes_behind_a_jpeg_do_not_matter() -> None:
    """Drivers fill up their buffers; markers may be led by any number of 0xFF."""
    plain = decode_frame(compressed(JPEG))

    padded = decode_frame(compressed(JPEG[:2] + b"\xff\xff" + JPEG[2:] + bytes(500)))

    np.testing.assert_array_equal(padded, plain)


def test_progressive_jpegs_are_read() -> None:
    """Tables stand between their scans."""
    payload = encoded(".jpg", picture(), cv2.IMWRITE_JPEG_PROGRESSIVE, 1)

    image = decode_frame(compressed(payload))

    assert image is not None
    assert np.abs(image.astype(int) - picture()).max() < 40


@pytest.mark.parametrize(
    ("size", "smallest", "expected"),
    [
        ((640, 480), (320, 240), (320, 240)),
        ((639, 479), (320, 240), (320, 240)),
        ((638, 480), (320, 240), (638, 480)),
        ((640, 478), (320, 240), (640, 478)),
        ((1280, 720), (320, 240), (640, 360)),
        ((1280, 960), (320, 240), (320, 240)),
        ((2560, 1920), (320, 240), (320, 240)),
        ((320, 240), (320, 240), (320, 240)),
        ((160, 120), (320, 240), (160, 120)),
        ((640, 480), None, (640, 480)),
    ],
)
def test_a_jpeg_is_decoded_no_larger_than_needed(
    size: tuple[int, int], smallest: tuple[int, int] | None, expected: tuple[int, int]
) -> None:
    """At 1/2, 1/4 or 1/8, rounded up, as long as both sides stay long enough."""
    payload = encoded(".jpg", picture(*size))

    decoded = decode_scaled(compressed(payload), smallest)

    assert decoded is not None
    assert decoded.image.shape == (expected[1], expected[0], 3)
    assert decoded.size == size


@pytest.mark.parametrize("kind", [".png", ".webp", ".tiff"])
def test_other_formats_keep_their_size(kind: str) -> None:
    """Only JPEG gains by a smaller scale."""
    options = (cv2.IMWRITE_WEBP_QUALITY, 101) if kind == ".webp" else ()

    decoded = decode_scaled(compressed(encoded(kind, picture(), *options)), (8, 8))

    assert decoded is not None
    assert decoded.size == (64, 48)
    np.testing.assert_array_equal(decoded.image, picture())


def test_png_of_every_kind_becomes_bgr() -> None:
    """Gray is repeated, transparency is left out, 16 bits keep the high byte."""
    image = picture()
    gray = image[:, :, 0]
    alpha = np.dstack([image, gray])
    deep = image.astype(np.uint16) * 256 + 200
    kinds = [gray, alpha, deep, deep[:, :, 0]]

    decoded = [decode_frame(compressed(encoded(".png", pixels))) for pixels in kinds]

    gray_image = np.dstack([gray] * 3)
    for found, expected in zip(decoded, [gray_image, image, image, gray_image], strict=True):
        np.testing.assert_array_equal(found, expected)


def test_a_gray_jpeg_becomes_bgr() -> None:
    """It has three equal channels."""
    image = decode_frame(compressed(encoded(".jpg", picture()[:, :, 0])))

    assert image is not None
    assert image.shape == (48, 64, 3)
    np.testing.assert_array_equal(image[:, :, 0], image[:, :, 2])


def test_an_orientation_in_the_header_does_not_count() -> None:
    """Pixels stay as the camera wrote them, at every scale."""
    entry = struct.pack(">HHIHH", 0x0112, 3, 1, 6, 0)
    exif = b"Exif\0\0MM\0\x2a" + struct.pack(">IH", 8, 1) + entry + bytes(4)
    payload = with_segment(JPEG, exif)

    turned = cv2.imdecode(np.frombuffer(payload, np.uint8), cv2.IMREAD_COLOR)
    images = [decode_frame(compressed(payload), smallest) for smallest in (None, (32, 24))]

    assert turned is not None
    assert turned.shape == (64, 48, 3)
    assert [image.shape for image in images if image is not None] == [(48, 64, 3), (24, 32, 3)]
