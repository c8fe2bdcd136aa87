"""Images are cut as section 5.3 has it: patches of one size, what remains at the edges."""

import numpy as np
import pytest

from mpap_cli.features.images.patches import PatchGrid, cut_patches, lay_out_patches
from mpap_cli.params import ImageParams


@pytest.mark.parametrize(
    ("grid", "size", "expected"),
    [
        ("6x6", "320x240", PatchGrid(6, 6, 40, 53, 0, 1)),
        ("3x3", "320x240", PatchGrid(3, 3, 80, 106, 0, 1)),
        ("7x9", "320x240", PatchGrid(7, 9, 34, 35, 1, 2)),
        ("1x1", "8x9", PatchGrid(1, 1, 9, 8, 0, 0)),
    ],
)
def test_what_remains_is_split(grid: str, size: str, expected: PatchGrid) -> None:
    """Half of it lies left and above, the odd pixel right and below."""
    assert lay_out_patches(ImageParams(grid=grid, image_size=size)) == expected


def test_patches_hold_the_pixels_of_their_places() -> None:
    """Row by row of the grid; the image is copied."""
    params = ImageParams(grid="2x3", image_size="31x21")
    image = np.arange(21 * 31 * 3).reshape(21, 31, 3).astype(np.uint8)
    before = image.copy()

    patches = cut_patches(image, params)

    assert patches.shape == (2, 3, 10, 10, 3)
    np.testing.assert_array_equal(patches[0, 0], image[0:10, 0:10])
    np.testing.assert_array_equal(patches[1, 2], image[10:20, 20:30])
    patches[:] = 0
    np.testing.assert_array_equal(image, before)


def test_only_working_images_are_cut() -> None:
    """An image of another size is refused with both shapes."""
    with pytest.raises(ValueError, match=r"shape \(480, 640, 3\), .* \(240, 320, 3\)"):
        cut_patches(np.zeros((480, 640, 3), np.uint8), ImageParams())
