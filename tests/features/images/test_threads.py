"""Features of images do not depend on the number of threads."""

import cv2
import numpy as np
import pytest

from mpap_cli.features.images.patch_features import PatchEmbedder
from mpap_cli.observations import Frame
from mpap_cli.params import ImageParams

SIZE = (48, 36)


def jpeg(seed: int, size: tuple[int, int] = (96, 72)) -> Frame:
    """Return an image of colored squares."""
    rng = np.random.default_rng(seed)
    squares = rng.integers(0, 256, (6, 8, 3), np.uint8)
    image = cv2.resize(squares, size, interpolation=cv2.INTER_NEAREST)
    return Frame(seed, "compressed", 0, 0, 0, cv2.imencode(".jpg", image)[1].tobytes())


def mixed() -> list[Frame]:
    """Return images of two sizes and encodings, some of them broken, black or not read."""
    black = Frame(50, "mono8", *SIZE, SIZE[0], bytes(SIZE[0] * SIZE[1]))
    whole = [jpeg(n) for n in range(9)]
    odd = [
        Frame(40, "compressed", 0, 0, 0, whole[0].payload[:60]),
        black,
        Frame(51, "32FC1", *SIZE, 4 * SIZE[0], bytes(4 * SIZE[0] * SIZE[1])),
        jpeg(60, (120, 90)),
    ]
    return [*whole[:4], *odd, *whole[4:], odd[0], black]


@pytest.mark.parametrize("jobs", [2, 3, 8, 100])
def test_features_are_those_of_one_thread(jobs: int) -> None:
    """Also what was left out, why, and what changed from image to image."""
    params = ImageParams(image_size="48x36", grid="3x3")
    one, several = PatchEmbedder(params), PatchEmbedder(params)
    alone = one.transform(mixed())

    shared = several.transform(mixed(), jobs)

    np.testing.assert_array_equal(shared.features, alone.features)
    np.testing.assert_array_equal(shared.kept, alone.kept)
    np.testing.assert_array_equal(shared.stamps_ns, alone.stamps_ns)
    assert (several.skipped, several.changes) == (one.skipped, one.changes)
    assert one.skipped.total() == 5
    assert one.changes.total() > 2


@pytest.mark.parametrize("jobs", [1, 4])
def test_no_image_gives_no_patch(jobs: int) -> None:
    """However many threads would share it out."""
    embedder = PatchEmbedder(ImageParams())

    block = embedder.transform([], jobs)

    assert block.features.shape == (0, embedder.n_patches, embedder.n_dims)
