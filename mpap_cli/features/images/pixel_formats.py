"""Raw camera images, in every encoding of sensor_msgs/Image that holds colors or gray.

16-bit pixels keep their high byte, which is the second: frames hold little-endian numbers,
whatever their message did.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from mpap_cli.observations import Frame

Pixels = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Packed:
    """An encoding whose rows hold pixel after pixel.

    ``conversion`` is OpenCV's name of the way to BGR; empty: it is BGR already.
    """

    channels: int
    conversion: str
    pixel_bytes: int = 1


@dataclass(frozen=True, slots=True)
class Planar:
    """An encoding whose gray stands before its colors, two bytes for ``shared``^2 pixels.

    The plane of colors has as many bytes a row as that of gray if ``shared`` is 2, twice as
    many if it is 1.
    """

    shared: int
    conversion: str


_GRAY, _RGBA, _BGRA = "COLOR_GRAY2BGR", "COLOR_RGBA2BGR", "COLOR_BGRA2BGR"
_RGB, _UYVY, _YUYV = "COLOR_RGB2BGR", "COLOR_YUV2BGR_UYVY", "COLOR_YUV2BGR_YUY2"

RAW_ENCODINGS: Mapping[str, Packed | Planar] = MappingProxyType(
    {
        "mono8": Packed(1, _GRAY),
        "mono16": Packed(1, _GRAY, 2),
        "rgb8": Packed(3, _RGB),
        "rgb16": Packed(3, _RGB, 2),
        "rgba8": Packed(4, _RGBA),
        "rgba16": Packed(4, _RGBA, 2),
        "bgr8": Packed(3, ""),
        "bgr16": Packed(3, "", 2),
        "bgra8": Packed(4, _BGRA),
        "bgra16": Packed(4, _BGRA, 2),
        "8UC1": Packed(1, _GRAY),
        "8UC3": Packed(3, ""),
        "8UC4": Packed(4, _BGRA),
        "16UC1": Packed(1, _GRAY, 2),
        "16UC3": Packed(3, "", 2),
        "16UC4": Packed(4, _BGRA, 2),
        **{
            f"bayer_{order}{8 * size}": Packed(1, f"COLOR_Bayer{order.upper()}2BGR", size)
            for order in ("rggb", "bggr", "gbrg", "grbg")
            for size in (1, 2)
        },
        "uyvy": Packed(2, _UYVY),
        "yuv422": Packed(2, _UYVY),
        "yuyv": Packed(2, _YUYV),
        "yuv422_yuy2": Packed(2, _YUYV),
        "nv12": Planar(2, "COLOR_YUV2BGR_NV12"),
        "nv21": Planar(2, "COLOR_YUV2BGR_NV21"),
        "nv24": Planar(1, _YUYV),
    }
)
_PAIRED = {_UYVY, _YUYV}  # two pixels beside one another share their color


def bgr_pixels(frame: Frame) -> Pixels | None:
    """Turn a raw image into 8-bit BGR.

    Parameters
    ----------
    frame : Frame
        Rows may be padded.

    Returns
    -------
    ndarray of shape (height, width, 3) or None
        None if the payload is too short, the image has no pixels, or the encoding is none
        of ``RAW_ENCODINGS``. Where pixels share their color, an odd last column (nv12,
        nv21: and row) is left out.

    Examples
    --------
    >>> bgr_pixels(Frame(0, "rgb8", 1, 1, 3, bytes([10, 20, 30]))).tolist()
    [[[30, 20, 10]]]
    """
    import cv2  # noqa: PLC0415  # only where there are images

    encoding = RAW_ENCODINGS.get(frame.encoding)
    if encoding is None or frame.width <= 0 or frame.height <= 0:
        return None
    try:
        if isinstance(encoding, Packed):
            return _packed_pixels(frame, encoding)
        return _planar_pixels(frame, encoding)
    except cv2.error:  # OpenCV does not convert an image that is one pixel high or wide
        return None


def _converted(pixels: Pixels, conversion: str) -> Pixels:
    """Turn pixels into BGR."""
    import cv2  # noqa: PLC0415  # only where there are images

    colors = cv2.cvtColor(np.ascontiguousarray(pixels), getattr(cv2, conversion))
    return np.asarray(colors, np.uint8)


def _plane(frame: Frame, stride: int, n_rows: int) -> Pixels | None:
    """Return the first rows of the payload, None if it is too short."""
    if not 0 < stride * n_rows <= len(frame.payload):
        return None
    return np.frombuffer(frame.payload, np.uint8, stride * n_rows).reshape(n_rows, stride)


def _packed_pixels(frame: Frame, encoding: Packed) -> Pixels | None:
    """Read rows of pixels."""
    row_bytes = frame.width * encoding.channels * encoding.pixel_bytes
    padded = _plane(frame, frame.step, frame.height)
    if padded is None or row_bytes > frame.step:
        return None
    rows = padded[:, :row_bytes]
    shape = (frame.height, frame.width, encoding.channels, encoding.pixel_bytes)
    pixels = rows.reshape(shape)[..., -1]
    if not encoding.conversion:
        return np.array(pixels)
    if encoding.conversion in _PAIRED:
        pixels = pixels[:, : frame.width // 2 * 2]
    return _converted(pixels, encoding.conversion)


def _planar_pixels(frame: Frame, encoding: Planar) -> Pixels | None:
    """Read a plane of gray and one of colors.

    Drivers do not agree on what a step is here. Where the payload is too short for rows of
    that length, they are as long as the image is wide.
    """
    shared = encoding.shared
    width, height = frame.width // shared * shared, frame.height // shared * shared
    n_rows = frame.height + -(-frame.height // shared) * (3 - shared)
    planes = None
    for stride in (frame.step, frame.width):
        if planes is None and stride >= frame.width:
            planes = _plane(frame, stride, n_rows)
    if planes is None:
        return None
    gray, colors = planes[:height, :width], planes[frame.height :]
    if shared > 1:
        colors = colors[: height // shared, :width]
        return _converted(np.concatenate([gray, colors]), encoding.conversion)
    colors = colors.reshape(height, -1)[:, : 2 * width].reshape(height, width, 2)
    return _without_sharing(gray, colors, encoding.conversion)


def _without_sharing(gray: Pixels, colors: Pixels, conversion: str) -> Pixels:
    """Convert pixels with a color each: each is doubled into a pair that shares it."""
    height, width = gray.shape
    pairs = np.empty((height, width, 2, 2), np.uint8)
    pairs[..., 0] = gray[..., None]
    pairs[..., 1] = colors
    doubled = _converted(pairs.reshape(height, 2 * width, 2), conversion)
    return np.array(doubled[:, ::2])
