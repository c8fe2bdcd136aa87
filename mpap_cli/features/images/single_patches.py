"""Patches that stand alone, not cut from the grid of a camera image (section 5.1.1)."""

import numpy as np

from mpap_cli.features.images import _kernels
from mpap_cli.features.images.image_decode import Image
from mpap_cli.features.images.lbp import uniform_codes
from mpap_cli.features.images.pixels._kernels import describe_pixels
from mpap_cli.observations import Float32Array
from mpap_cli.params import ImageParams

PATCH_SIZE = (52, 40)
"""Width and height of the paper's patches in pixels."""
LEAST_SIDE = 8
"""A patch that is lower or narrower says too little of a texture."""

_LARGE_IN_PATCHES = 2


def cut_at_own_size(image: Image) -> Image:
    """Cut an image into patches of 52 x 40 pixels, or take it as one patch if it is small.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
        Of any size; it is not resized.

    Returns
    -------
    ndarray of shape (n, height, width, 3), uint8
        A copy. An image that is wider than 104 or higher than 80 pixels is cut into as many
        patches as it holds, row by row; what remains is split between its sides. Any other,
        and one too low or too narrow for a patch, is one patch of its own size.

    Examples
    --------
    >>> cut_at_own_size(np.zeros((100, 120, 3), np.uint8)).shape
    (4, 40, 52, 3)
    >>> cut_at_own_size(np.zeros((80, 104, 3), np.uint8)).shape
    (1, 80, 104, 3)
    """
    width, height = PATCH_SIZE
    rows, columns = image.shape[0] // height, image.shape[1] // width
    is_large = (
        image.shape[0] > _LARGE_IN_PATCHES * height or image.shape[1] > _LARGE_IN_PATCHES * width
    )
    if not is_large or rows * columns == 0:
        return image[None].copy()
    top, left = image.shape[0] % height // 2, image.shape[1] % width // 2
    inside = image[top : top + rows * height, left : left + columns * width]
    blocks = inside.reshape(rows, height, columns, width, 3).swapaxes(1, 2)
    return blocks.reshape(rows * columns, height, width, 3)


def embed_patches(patches: Image, params: ImageParams) -> Float32Array:
    """Describe patches as :class:`~mpap_cli.features.images.patch_features.PatchEmbedder` does.

    Parameters
    ----------
    patches : ndarray of shape (n, h, w, 3), uint8
        BGR, 8 pixels or more a side; they are not resized, and the pixels at the border of
        each have no pattern.
    params : ImageParams
        ``lbp`` and ``color_weight``.

    Returns
    -------
    ndarray of shape (n, 109), float32
        Embedded histograms of color and texture, of length 1.

    Examples
    --------
    >>> gray = np.full((1, 40, 52, 3), 100, np.uint8)
    >>> embed_patches(gray, ImageParams()).shape
    (1, 109)
    """
    n, height, width = patches.shape[:3]
    grid = np.array([1, 1, height, width, 0, 0], np.int64)
    uniform = uniform_codes()
    index, codes = np.empty((height, width), np.uint16), np.empty((height, width), np.uint8)
    features = np.empty((n, _kernels.COLOR_BINS + _kernels.TEXTURE_BINS + 2), np.float32)
    for patch, row in zip(patches, features, strict=True):
        describe_pixels(
            np.ascontiguousarray(patch), index, codes, circular=params.lbp == "circular"
        )
        counts = _kernels.count_patches(index, codes, grid, uniform)
        _kernels.embed_counts(counts, params.color_weight, row[None])
    return features
