"""Images are cut into a grid of patches of one size (section 4.2.2).

The paper has 36 patches of 52 x 40 pixels; 6 x 6 patches of 53 x 40 in an image of
320 x 240 are what fits that best.
"""

from dataclasses import dataclass

from mpap_cli.features.images.image_decode import Image
from mpap_cli.params import ImageParams


@dataclass(frozen=True, slots=True)
class PatchGrid:
    """Where the patches of a working image lie, in pixels.

    ``top`` and ``left`` are the first row and column of the first patch.
    """

    rows: int
    columns: int
    height: int
    width: int
    top: int
    left: int


def lay_out_patches(params: ImageParams) -> PatchGrid:
    """Lay the grid over the working image.

    Parameters
    ----------
    params : ImageParams
        ``grid`` and ``image_size``.

    Returns
    -------
    PatchGrid
        Patches of floor(W / columns) x floor(H / rows) pixels; what remains of the image
        is split between left and right, top and bottom, the odd pixel to the right and
        to the bottom.

    Examples
    --------
    >>> lay_out_patches(ImageParams())
    PatchGrid(rows=6, columns=6, height=40, width=53, top=0, left=1)
    """
    rows, columns = params.rows_columns()
    width, height = params.width_height()
    return PatchGrid(
        rows=rows,
        columns=columns,
        height=height // rows,
        width=width // columns,
        top=height % rows // 2,
        left=width % columns // 2,
    )


def cut_patches(image: Image, params: ImageParams) -> Image:
    """Return the pixels of the patches.

    Parameters
    ----------
    image : ndarray of shape (H, W, 3), uint8
        A working image: of the size ``params.image_size``.
    params : ImageParams
        ``grid`` and ``image_size``.

    Returns
    -------
    ndarray of shape (rows, columns, h, w, 3), uint8
        A copy.

    Raises
    ------
    ValueError
        If the image has another size.

    Examples
    --------
    >>> import numpy as np
    >>> cut_patches(np.zeros((240, 320, 3), np.uint8), ImageParams()).shape
    (6, 6, 40, 53, 3)
    """
    width, height = params.width_height()
    if image.shape != (height, width, 3):
        msg = f"image: shape {image.shape}, the working image has ({height}, {width}, 3)"
        raise ValueError(msg)
    grid = lay_out_patches(params)
    bottom = grid.top + grid.rows * grid.height
    right = grid.left + grid.columns * grid.width
    inside = image[grid.top : bottom, grid.left : right]
    blocks = inside.reshape(grid.rows, grid.height, grid.columns, grid.width, 3)
    return blocks.swapaxes(1, 2).copy()
