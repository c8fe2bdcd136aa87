"""From camera images to features, against one full decode of the same images."""

from pathlib import Path

import cv2
import numpy as np

from benchmarks.measuring.processes import MPAP, in_turns, run_child
from benchmarks.measuring.table import Row
from mpap_cli.commands.runtime import one_thread_each
from mpap_cli.features.images.image_decode import Image
from mpap_cli.features.images.lbp import uniform_codes
from mpap_cli.features.images.patch_features import PatchEmbedder, working_image
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.replay_options import ReplayOptions
from mpap_cli.logs.topics import TopicChoice, choose_roles
from mpap_cli.observations import Float32Array, Frame
from mpap_cli.params import ImageParams, make_settings

SECONDS = 40
REPEATS = 7
_SCALED = ImageParams()
_FULL = ImageParams(image_size="640x480", image_decode="full")
# Row and column of the eight neighbors, from the right against the clock.
_AROUND = ((1, 2), (0, 2), (0, 1), (0, 0), (1, 0), (2, 0), (2, 1), (2, 2))


def images(folder: Path) -> list[Row]:
    """Take the features of simulated JPEGs of 640x480, at half size and in full."""
    frames = _simulated_frames(folder / "camera.mcap")
    scaled, full = PatchEmbedder(_SCALED), PatchEmbedder(_FULL)
    ready = [image for frame in frames if (image := working_image(frame, _SCALED)) is not None]
    bgr = [Frame(0, "bgr8", 320, 240, 960, image.tobytes()) for image in ready]
    works = [
        lambda: scaled.transform(frames),
        lambda: full.transform(frames),
        lambda: _decode(frames),
        lambda: scaled.transform(bgr),
        lambda: [by_numpy(image) for image in ready],
    ]
    with one_thread_each():
        turns = in_turns(works, REPEATS)
    mine, in_full, decoded, alone, plain = (
        tuple(1000 * seconds / len(frames) for seconds in times) for times in turns
    )
    decode = "one full cv2.imdecode"
    size = sum(len(frame.payload) for frame in frames) / len(frames) / 1000
    figures = (
        (f"JPEG 640x480 ({size:.0f} kB) -> features of 320x240", mine, decode, decoded, "<= 1.1x"),
        ("JPEG 640x480 -> features of 640x480", in_full, decode, decoded, "<= 2.0x"),
        ("features of 320x240, decoded before", alone, "OpenCV's HSV + numpy", plain, ">="),
    )
    return [
        Row(work=work, mpap=mpap, beside=beside, peer=peer, unit="ms", goal=goal)
        for work, mpap, beside, peer, goal in figures
    ]


def _simulated_frames(path: Path) -> list[Frame]:
    """Return the images of a simulated robot."""
    run_child([MPAP, "simulate", str(path), "--camera", "--duration", str(SECONDS), "--seed", "1"])
    with open_log(path) as reader:
        roles = choose_roles(reader, TopicChoice())
        options = ReplayOptions(sensors=frozenset({"image"}))
        replay = Replay(reader, roles, make_settings("robust", {}).bumper, options)
        return [frame for batch in replay for frame in batch.frames]


def _decode(frames: list[Frame]) -> None:
    for frame in frames:
        cv2.imdecode(np.frombuffer(frame.payload, np.uint8), cv2.IMREAD_COLOR)


def by_numpy(image: Image) -> Float32Array:
    """Return the same features as the embedder's, without the coordinates that are 0."""
    hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV).astype(np.int64)
    bins = hsv * 16 // [180, 256, 256] + [0, 16, 32]
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    height, width = gray.shape[0] - 2, gray.shape[1] - 2
    codes = np.zeros((height, width), np.int64)
    for bit, (y, x) in enumerate(_AROUND):
        neighbors = gray[y : y + height, x : x + width]
        codes |= (neighbors >= gray[1:-1, 1:-1]).astype(np.int64) << bit
    bin_of = np.full(256, 58)
    bin_of[uniform_codes()] = np.arange(58)
    patterns = np.pad(bin_of[codes], 1, constant_values=59)
    described = np.dstack([bins, patterns]).astype(np.uint8)
    features = np.empty((36, 107), np.float32)
    tall, wide = len(described) // 6, described.shape[1] // 6
    left = (described.shape[1] - 6 * wide) // 2
    for p in range(36):
        y, x = p // 6 * tall, left + p % 6 * wide
        pixels = described[y : y + tall, x : x + wide].reshape(-1, 4)
        color = np.bincount(pixels[:, :3].ravel(), minlength=48)
        texture = np.bincount(pixels[:, 3], minlength=60)[:59]
        features[p, :48] = np.sqrt(0.5 * color / color.sum())
        features[p, 48:] = np.sqrt(0.5 * texture / texture.sum())
    return features
