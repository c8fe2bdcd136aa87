"""Recorded camera images become BGR pixels (section 4.2.2)."""

import struct
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.features.images.pixel_formats import bgr_pixels
from mpap_cli.features.images.video_decode import VideoDecoder
from mpap_cli.observations import VIDEO_ENCODINGS, Frame

Image = NDArray[np.uint8]

COMPRESSED = "compressed"

_JPEG, _JPEG_END = b"\xff\xd8\xff", b"\xff\xd9"
_PNG, _CHUNK, _PNG_SIZE = b"\x89PNG\r\n\x1a\n", struct.Struct(">I4s"), struct.Struct(">II")
# Markers of JPEG: frame headers (but not the tables that stand among them), start of a
# scan, end of the image.
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_SCAN, _END = 0xDA, 0xD9
# Those without a length: restart marks, start of the image, and 0xFF that fills.
_FIRST_MARKER, _BARE_MARKERS = 0xC0, frozenset({*range(0xD0, 0xD9), 0xFF})
_SCALES = (8, 4, 2)
# A header that states more is broken; no camera has that many pixels.
_MOST_PIXELS = 1 << 27


@dataclass(frozen=True, slots=True, eq=False)
class Decoded:
    """An image of shape (h, w, 3), and the (width, height) that it was recorded with."""

    image: Image
    size: tuple[int, int]


def decode_frame(frame: Frame, smallest: tuple[int, int] | None = None) -> Image | None:
    """Decode an image into 8-bit BGR; see :func:`decode_scaled`.

    Examples
    --------
    >>> decode_frame(Frame(0, "mono8", 1, 1, 1, bytes([7]))).tolist()
    [[[7, 7, 7]]]
    """
    decoded = decode_scaled(frame, smallest)
    return None if decoded is None else decoded.image


def decode_scaled(frame: Frame, smallest: tuple[int, int] | None = None) -> Decoded | None:
    """Decode an image into 8-bit BGR, a JPEG at no larger a scale than is needed.

    Parameters
    ----------
    frame : Frame
        As recorded. A compressed image is told by its first bytes; what its message says
        of its format does not count, nor does an orientation in its header. A packet of
        video is decoded after those that it is linked to.
    smallest : tuple of int, optional
        Width and height: a JPEG may be decoded at 1/2, 1/4 or 1/8 of its size, which
        costs less, as long as it stays that large in both directions.

    Returns
    -------
    Decoded or None
        None if the image is cut off, without pixels, of an encoding that is not read, or
        otherwise cannot be decoded.

    Raises
    ------
    UsageError
        If it is video and PyAV is missing.

    Notes
    -----
    A JPEG whose end is missing counts as cut off, since decoders fill the rest with gray.
    16-bit images keep their high byte. Video in its order costs less with a
    :class:`~mpap_cli.features.images.frame_decoder.FrameDecoder`, which gives the same.
    """
    if frame.encoding in VIDEO_ENCODINGS:
        ((_, picture),) = VideoDecoder().decode([frame])
        return None if isinstance(picture, str) else as_recorded(picture)
    if frame.encoding != COMPRESSED:
        pixels = bgr_pixels(frame)
        return None if pixels is None else as_recorded(pixels)
    payload = frame.payload
    if payload.startswith(_JPEG):
        size = _jpeg_size(payload)
        if size is None or not 0 < size[0] * size[1] <= _MOST_PIXELS:
            return None
        image = _decode(payload, _jpeg_scale(size, smallest or size))
        return None if image is None else Decoded(image, size)
    whole = _decode(payload, 1) if _is_whole(payload) else None
    return None if whole is None else as_recorded(whole)


def as_recorded(image: Image) -> Decoded:
    """Return an image that was not scaled."""
    return Decoded(image, (image.shape[1], image.shape[0]))


def _decode(payload: bytes, scale: int) -> Image | None:
    """Decode JPEG, PNG, WebP, or whatever else OpenCV knows."""
    import cv2  # noqa: PLC0415  # only where there are images

    name = "IMREAD_COLOR" if scale == 1 else f"IMREAD_REDUCED_COLOR_{scale}"
    flags = getattr(cv2, name) | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        decoded: NDArray[Any] | None = cv2.imdecode(np.frombuffer(payload, np.uint8), flags)
    except cv2.error:  # the header states a size that no image has
        return None
    return None if decoded is None else decoded.astype(np.uint8, copy=False)


def _is_whole(payload: bytes) -> bool:
    """Tell whether an image that is no JPEG reaches its end; other formats say nothing."""
    if payload.startswith(_PNG):
        return _is_whole_png(payload)
    if payload.startswith(b"RIFF") and payload[8:12] == b"WEBP":
        return len(payload) >= 8 + int.from_bytes(payload[4:8], "little")
    return len(payload) > 0


def _is_whole_png(payload: bytes) -> bool:
    """Tell whether the chunks of a PNG are all there, and their checksums right."""
    at = len(_PNG)
    while at + _CHUNK.size <= len(payload):
        length, name = _CHUNK.unpack_from(payload, at)
        end = at + _CHUNK.size + length
        if zlib.crc32(payload[at + 4 : end]).to_bytes(4, "big") != payload[end : end + 4]:
            return False
        if name == b"IHDR" and length >= _PNG_SIZE.size:
            width, height = _PNG_SIZE.unpack_from(payload, at + _CHUNK.size)
            if width * height > _MOST_PIXELS:
                return False
        if name == b"IEND":
            return True
        at = end + 4
    return False


def _jpeg_scale(size: tuple[int, int], smallest: tuple[int, int]) -> int:
    """Return the greatest divisor that leaves a JPEG large enough; libjpeg rounds up."""
    for scale in _SCALES:
        if all(-(-side // scale) >= least for side, least in zip(size, smallest, strict=True)):
            return scale
    return 1


def _jpeg_size(payload: bytes) -> tuple[int, int] | None:
    """Return width and height of a JPEG, None if it has no end behind its first scan."""
    size = None
    at = 2
    while (at := payload.find(b"\xff", at)) >= 0 and at + 9 <= len(payload):
        marker = payload[at + 1]
        if marker == _SCAN:
            return size if payload.rfind(_JPEG_END, at) > at else None
        if marker == _END:
            return None
        if marker in _FRAMES:
            height, width = payload[at + 5 : at + 7], payload[at + 7 : at + 9]
            size = int.from_bytes(width, "big"), int.from_bytes(height, "big")
        has_length = marker >= _FIRST_MARKER and marker not in _BARE_MARKERS
        at += 2 + int.from_bytes(payload[at + 2 : at + 4], "big") if has_length else 1
    return None
