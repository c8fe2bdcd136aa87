"""Images that are none are told from those that are."""

import struct
import zlib

import pytest

from mpap_cli.features.images.image_decode import decode_frame
from mpap_cli.observations import Frame


def png_of_size(width: int, height: int) -> bytes:
    """Return a PNG that states a size and holds no pixels."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", zlib.compress(b"")), (b"IEND", b"")]
    parts = [
        struct.pack(">I", len(content))
        + name
        + content
        + struct.pack(">I", zlib.crc32(name + content))
        for name, content in chunks
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


@pytest.mark.parametrize(
    "frame",
    [
        Frame(0, "rgb8", 0, 0, 0, b""),
        Frame(0, "rgb8", 0, 3, 4, bytes(12)),
        Frame(0, "rgb8", -1, 1, 3, bytes(3)),
        Frame(0, "rgb8", 2, 2, 6, bytes(11)),
        Frame(0, "16UC1", 1, 1, 2, bytes(2)),
        Frame(0, "compressed", 0, 0, 0, b""),
        Frame(0, "compressed", 0, 0, 0, b"no image"),
        Frame(0, "compressed", 0, 0, 0, png_of_size(100_000, 100_000)),
    ],
)
def test_what_is_no_image_is_none(frame: Frame) -> None:
    """Without pixels, cut off, of another encoding, garbled, or of a size that cannot be."""
    assert decode_frame(frame) is None
