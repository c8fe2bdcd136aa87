"""Images of a log become embedded patches; what is left out is counted."""

import pickle
from collections import Counter
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.features.images.image_decode import Image, decode_frame
from mpap_cli.features.images.patch_features import PatchEmbedder, working_image
from mpap_cli.features.images.patches import cut_patches
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.replay_options import ReplayOptions
from mpap_cli.logs.topics import TopicChoice, choose_roles
from mpap_cli.observations import Float32Array, Frame
from mpap_cli.params import ImageParams, make_settings

SMALL = ImageParams(grid="2x3", image_size="48x32")
STEP_NS = 200_000_000


def scenery(width: int, height: int, seed: int = 0) -> Image:
    """Return an image with coarse and fine structure in all colors."""
    rng = np.random.default_rng(seed)
    coarse = cv2.resize(
        rng.integers(0, 256, (height // 8, width // 8, 3), dtype=np.uint8), (width, height)
    )
    return np.asarray(coarse // 2 + rng.integers(0, 100, coarse.shape), np.uint8)


def jpeg(image: Image, stamp_ns: int = 0) -> Frame:
    """Return a compressed frame."""
    payload = bytes(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 90])[1])
    return Frame(stamp_ns, "compressed", 0, 0, 0, payload)


def raw(image: Image, stamp_ns: int = 0) -> Frame:
    """Return a frame of encoding bgr8."""
    height, width = image.shape[:2]
    return Frame(stamp_ns, "bgr8", width, height, 3 * width, image.tobytes())


def by_numpy(image: Image) -> Float32Array:
    """Return the color part (n_patches, 48) of the patches of an image."""
    histograms = []
    for patch in cut_patches(image, SMALL).reshape(6, 16, 16, 3):
        hsv = cv2.cvtColor(patch, cv2.COLOR_BGR2HSV).reshape(-1, 3).astype(int)
        levels = hsv * 16 // [180, 256, 256]
        histograms.append([np.bincount(level, minlength=16) for level in levels.T])
    shares = np.array(histograms).reshape(6, 48) / (3 * 16 * 16)
    return np.asarray(np.sqrt(shares), np.float32)


def test_features_are_histograms_of_the_patches_embedded() -> None:
    """The color part equals OpenCV's HSV counted by numpy; each patch has length 1."""
    image = scenery(48, 32)
    embedder = PatchEmbedder(replace(SMALL, color_weight=0.25))

    block = embedder.transform([raw(image, 7)])

    assert block.features.shape == (1, 6, 109) == (1, embedder.n_patches, embedder.n_dims)
    assert block.features.dtype == np.float32
    assert (embedder.rows, embedder.columns) == (2, 3)
    assert block.stamps_ns.tolist() == [7]
    assert block.kept.tolist() == [0]
    np.testing.assert_allclose(block.features[0, :, :48], 0.5 * by_numpy(image), rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(block.features, axis=2), 1.0, rtol=1e-6)
    assert not block.features[..., [48, 108]].any()


def test_the_operator_of_the_texture_can_be_chosen() -> None:
    """It changes the texture part alone."""
    frames = [raw(scenery(48, 32))]

    square = PatchEmbedder(SMALL).transform(frames).features
    circular = PatchEmbedder(replace(SMALL, lbp="circular")).transform(frames).features

    np.testing.assert_array_equal(square[..., :49], circular[..., :49])
    assert not np.array_equal(square[..., 49:], circular[..., 49:])


def test_images_may_come_in_any_pieces() -> None:
    """Features do not depend on what comes together; nothing that comes in is kept or changed."""
    frames = [jpeg(scenery(96, 64, seed), seed * STEP_NS) for seed in range(5)]
    embedder = PatchEmbedder(SMALL)

    whole = embedder.transform(frames)
    pieces = [embedder.transform(frames[i:j]) for i, j in ((0, 2), (2, 2), (2, 5))]

    joined = np.concatenate([piece.features for piece in pieces])
    np.testing.assert_array_equal(joined, whole.features)
    assert np.concatenate([piece.stamps_ns for piece in pieces]).tolist() == [
        frame.stamp_ns for frame in frames
    ]
    assert pieces[1].features.shape == (0, 6, 109)


def test_an_embedder_can_be_pickled() -> None:
    """It works on in another process."""
    frames = [jpeg(scenery(96, 64))]
    embedder = PatchEmbedder(SMALL)

    other = pickle.loads(pickle.dumps(embedder))  # noqa: S301  # our own bytes

    np.testing.assert_array_equal(
        other.transform(frames).features, embedder.transform(frames).features
    )


def test_what_cannot_be_used_is_counted_by_reason() -> None:
    """The rest is used, and kept says which."""
    good, dark = scenery(96, 64), np.full((64, 96, 3), 15, np.uint8)
    cut = replace(jpeg(good), payload=jpeg(good).payload[:-100])
    depth = Frame(0, "32FC1", 96, 64, 384, bytes(384 * 64))
    frames = [
        cut,
        jpeg(good, 1),
        raw(dark),
        depth,
        raw(good, 2),
        cut,
    ]
    embedder = PatchEmbedder(SMALL)

    block = embedder.transform(frames)

    assert block.kept.tolist() == [1, 4]
    assert block.stamps_ns.tolist() == [1, 2]
    assert embedder.skipped == Counter(
        {"cut off or not decodable": 2, "black": 1, "encoding 32FC1": 1}
    )


def test_one_pixel_of_light_is_enough() -> None:
    """Dark is not black."""
    image = np.zeros((32, 48, 3), np.uint8)
    image[20, 20, 1] = 16
    embedder = PatchEmbedder(SMALL)

    block = embedder.transform([raw(image)])

    assert block.kept.tolist() == [0]
    assert not embedder.skipped


def test_changes_of_size_and_encoding_are_counted_and_used() -> None:
    """Also where both sizes are decoded to the same; broken images between do not count."""
    large, small = scenery(96, 64), scenery(48, 32)
    broken = Frame(1, "bgr8", 640, 480, 1920, b"")
    frames = [jpeg(large), jpeg(large), jpeg(small), broken, raw(small), raw(small), raw(large)]
    embedder = PatchEmbedder(SMALL)

    first = embedder.transform(frames[:3])
    rest = embedder.transform(frames[3:])

    assert first.kept.size + rest.kept.size == 6
    assert embedder.changes == Counter({"size changes": 2, "encoding changes": 1})


def test_another_log_begins_anew() -> None:
    """Counts are gone, and another camera is no change."""
    embedder = PatchEmbedder(SMALL)
    embedder.transform([jpeg(scenery(96, 64)), jpeg(scenery(48, 32)), raw(scenery(96, 64)[:0])])

    embedder.for_log()
    embedder.transform([raw(scenery(64, 64))])

    assert not embedder.changes
    assert not embedder.skipped


def test_a_working_image_has_the_chosen_size() -> None:
    """Scaled while it is decoded, then brought to size; None if it cannot be decoded."""
    params = ImageParams(grid="2x3", image_size="40x30")
    full = replace(params, image_decode="full")
    frame = jpeg(scenery(128, 96))
    decoded, scaled = decode_frame(frame), decode_frame(frame, (40, 30))

    images = [working_image(frame, params), working_image(frame, full)]

    assert decoded is not None
    assert scaled is not None
    assert scaled.shape == (48, 64, 3)
    for image, source in zip(images, [scaled, decoded], strict=True):
        expected = cv2.resize(source, (40, 30), interpolation=cv2.INTER_AREA)
        np.testing.assert_array_equal(image, expected)
    assert working_image(replace(frame, payload=b""), params) is None


@pytest.mark.shared
@pytest.mark.parametrize(("name", "n_images"), [("neato-2017-i1", 123), ("neato-2017-i2", 97)])
def test_every_image_of_recorded_logs_is_used(shared_logs: Path, name: str, n_images: int) -> None:
    """None is broken or black, and the size does not change."""
    embedder = PatchEmbedder(ImageParams())
    with open_log(shared_logs / "camera" / f"{name}.bag") as reader:
        roles = choose_roles(reader, TopicChoice())
        options = ReplayOptions(sensors=frozenset({"image"}))
        replay = Replay(reader, roles, make_settings("robust", {}).bumper, options)

        blocks = [embedder.transform(batch.frames) for batch in replay]

    assert sum(block.kept.size for block in blocks) == n_images
    assert not embedder.skipped
    assert not embedder.changes
