"""Recorded camera images become BGR pixels (section 4.2.2)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.observations import Frame

Image = NDArray[np.uint8]
CHANNELS = {"mono8": 1, "8UC1": 1, "bgr8": 3, "rgb8": 3, "8UC3": 3, "bgra8": 4, "rgba8": 4}


def decode_frame(frame: Frame) -> Image | None:
    """Decode an image into 8-bit BGR.

    Parameters
    ----------
    frame : Frame
        As recorded; rows may be padded.

    Returns
    -------
    ndarray of shape (height, width, 3) or None
        None if the image is cut off, without pixels, or of an encoding that is not read.

    Examples
    --------
    >>> decode_frame(Frame(0, "rgb8", 1, 1, 3, bytes([10, 20, 30]))).tolist()
    [[[30, 20, 10]]]
    """
    if frame.encoding == "compressed":
        return _decode_compressed(frame.payload)
    channels = CHANNELS.get(frame.encoding)
    row = frame.width * (channels or 0)
    whole = 0 < row <= frame.step and 0 < frame.step * frame.height <= len(frame.payload)
    if channels is None or not whole:
        return None
    padded = np.frombuffer(frame.payload, dtype=np.uint8, count=frame.step * frame.height)
    pixels = padded.reshape(frame.height, frame.step)[:, :row]
    pixels = pixels.reshape(frame.height, frame.width, channels)
    colours = np.repeat(pixels, 3, axis=2) if channels == 1 else pixels[:, :, :3]
    return np.ascontiguousarray(colours[:, :, ::-1] if "rgb" in frame.encoding else colours)


def _decode_compressed(payload: bytes) -> Image | None:
    """Decode JPEG, PNG or WebP."""
    import cv2  # noqa: PLC0415  # only where there are images

    if not payload:
        return None
    try:
        decoded: NDArray[Any] | None = cv2.imdecode(
            np.frombuffer(payload, dtype=np.uint8), cv2.IMREAD_COLOR
        )
    except cv2.error:  # the header states a size that no image has
        return None
    return None if decoded is None else decoded.astype(np.uint8, copy=False)
