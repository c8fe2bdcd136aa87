"""Patches that stand alone are described like those of a camera image."""

import numpy as np
import pytest

from mpap_cli.features.images.patch_features import PatchEmbedder
from mpap_cli.features.images.single_patches import cut_at_own_size, embed_patches
from mpap_cli.observations import Frame
from mpap_cli.params import ImageParams
from tests.features.images.test_patch_features import scenery


@pytest.mark.parametrize("lbp", ["square", "circular"])
def test_a_patch_equals_an_image_of_one_patch(lbp: str) -> None:
    """Features are those of the embedder with a grid of one patch, bit for bit."""
    image = scenery(56, 40)
    params = ImageParams(grid="1x1", image_size="56x40", lbp=lbp, color_weight=0.3)
    frame = Frame(0, "bgr8", 56, 40, 168, image.tobytes())
    expected = PatchEmbedder(params).transform([frame]).features[0]

    found = embed_patches(image[None], params)

    np.testing.assert_array_equal(found, expected)


def test_patches_of_a_stack_do_not_touch_one_another() -> None:
    """Each of several patches has the features that it has alone."""
    patches = np.stack([scenery(56, 40, seed) for seed in range(3)])

    together = embed_patches(patches, ImageParams())

    alone = [embed_patches(patch[None], ImageParams())[0] for patch in patches]
    np.testing.assert_array_equal(together, alone)
    np.testing.assert_allclose(np.linalg.norm(together, axis=1), 1.0, rtol=1e-5)


@pytest.mark.parametrize(
    ("size", "n_patches", "patch"),
    [
        ((80, 104), 1, (80, 104)),  # not larger
        ((81, 104), 4, (40, 52)),
        ((80, 105), 4, (40, 52)),
        ((240, 320), 36, (40, 52)),
        ((39, 500), 1, (39, 500)),  # too low for a patch
        ((200, 51), 1, (200, 51)),  # too narrow
        ((40, 52), 1, (40, 52)),
        ((8, 8), 1, (8, 8)),
    ],
)
def test_larger_images_are_cut(
    size: tuple[int, int], n_patches: int, patch: tuple[int, int]
) -> None:
    """An image larger than 104 x 80 gives patches of 52 x 40, any other is one patch."""
    found = cut_at_own_size(np.zeros((*size, 3), np.uint8))

    assert found.shape == (n_patches, *patch, 3)


def test_patches_are_cut_from_the_middle_row_by_row() -> None:
    """What does not fill a patch is left out at the edges, half on each side."""
    image = np.arange(90 * 110 * 3, dtype=np.int64).astype(np.uint8).reshape(90, 110, 3)

    found = cut_at_own_size(image)

    np.testing.assert_array_equal(found[0], image[5:45, 3:55])
    np.testing.assert_array_equal(found[1], image[5:45, 55:107])
    np.testing.assert_array_equal(found[2], image[45:85, 3:55])
    assert not np.shares_memory(found, image)
