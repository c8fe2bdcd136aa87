"""Images and the camera's lens as messages, compressed or raw."""

from collections.abc import Callable
from typing import Any

import numpy as np

from mpap_cli.simulation.messages import ros_header
from mpap_cli.simulation.rendering.arrays import Image

Fields = dict[str, Any]

CAMERA_FRAME = "camera"
INFO_TOPIC = "/camera/camera_info"
INFO_TYPE = "sensor_msgs/msg/CameraInfo"

_RAW_TOPIC = "/camera/image_raw"
_COMPRESSED_TOPIC = _RAW_TOPIC + "/compressed"


def image_topic(encoding: str) -> tuple[str, str]:
    """Return topic and type of the images of an encoding.

    >>> image_topic("bgr8")
    ('/camera/image_raw', 'sensor_msgs/msg/Image')
    """
    if encoding in COMPRESSED:
        return _COMPRESSED_TOPIC, "sensor_msgs/msg/CompressedImage"
    return _RAW_TOPIC, "sensor_msgs/msg/Image"


def _mono(image: Image) -> Image:
    import cv2  # noqa: PLC0415  # start-up

    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)


def _mosaic(image: Image) -> Image:
    """Return the one color that each pixel of a sensor sees: red green / green blue."""
    mosaic = image[:, :, 1].copy()
    mosaic[::2, ::2] = image[::2, ::2, 2]
    mosaic[1::2, 1::2] = image[1::2, 1::2, 0]
    return mosaic


COMPRESSED = {"jpeg": ".jpg", "png": ".png"}
RAW: dict[str, Callable[[Image], Image]] = {
    "rgb8": lambda image: np.ascontiguousarray(image[:, :, ::-1]),
    "bgr8": lambda image: image,
    "mono8": _mono,
    "bayer_rggb8": _mosaic,
}
ENCODINGS = (*COMPRESSED, *RAW)


def image_message(stamp_ns: int, image: Image, encoding: str, quality: int) -> Fields:
    """Return a sensor_msgs/CompressedImage or Image.

    Parameters
    ----------
    stamp_ns : int
        When it was taken.
    image : ndarray of shape (height, width, 3)
        Blue first.
    encoding : str
        One of ``ENCODINGS``.
    quality : int
        Of JPEG, 1 to 100.
    """
    header = ros_header(stamp_ns, CAMERA_FRAME)
    if encoding in RAW:
        pixels = RAW[encoding](image)
        height, width = pixels.shape[:2]
        return {
            "header": header,
            "height": height,
            "width": width,
            "encoding": encoding,
            "step": pixels.nbytes // height,
            "data": pixels.reshape(-1),
        }
    import cv2  # noqa: PLC0415  # start-up

    _, payload = cv2.imencode(COMPRESSED[encoding], image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return {"header": header, "format": f"bgr8; {encoding} compressed bgr8", "data": payload}


def camera_info(stamp_ns: int, size: tuple[int, int], focal_px: float, *, is_ros1: bool) -> Fields:
    """Return the sensor_msgs/CameraInfo of a lens without distortion."""
    width, height = size
    f, cx, cy = focal_px, width / 2, height / 2
    matrices = {
        "d": np.zeros(5),
        "k": np.array((f, 0, cx, 0, f, cy, 0, 0, 1.0)),
        "r": np.eye(3).reshape(-1),
        "p": np.array((f, 0, cx, 0, 0, f, cy, 0, 0, 0, 1.0, 0)),
    }
    if is_ros1:
        matrices = {name.upper(): matrix for name, matrix in matrices.items()}
    return {
        "header": ros_header(stamp_ns, CAMERA_FRAME),
        "width": width,
        "height": height,
        "distortion_model": "plumb_bob",
        **matrices,
    }
