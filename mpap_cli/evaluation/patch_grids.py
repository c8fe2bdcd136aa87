"""Predictions of one grid of patches brought to another, so that grids can be compared."""

import numpy as np

from mpap_cli.evaluation.patch_truth import PatchPlaces, SeenPatches
from mpap_cli.observations import BoolArray, Float64Array, IntArray

_HALF = 0.5


def regrid(seen: SeenPatches, shape: tuple[int, int], wanted: tuple[int, int]) -> SeenPatches:
    """Bring what is said of the patches of one grid to the patches of another.

    Parameters
    ----------
    seen : SeenPatches
        All patches of some images.
    shape, wanted : tuple of int
        Rows and columns of the grid, and of the one it is brought to; of each side one
        is a multiple of the other.

    Returns
    -------
    SeenPatches
        A patch that is divided says the same of all its parts; of patches that are joined
        ``p_obstacle`` is the mean, ``unknown`` means half of them or more, and ``cluster``
        is that of the first.

    Raises
    ------
    ValueError
        If the sides do not fit, or a patch of an image is missing.

    Examples
    --------
    >>> places = PatchPlaces(np.zeros(2, int), np.array([0, 1]), np.array([0, 0]))
    >>> seen = SeenPatches(places, np.array([3, 4]), np.array([0.2, 0.6]), np.array([False, True]))
    >>> one = regrid(seen, (2, 1), (1, 2))
    >>> one.p_obstacle.tolist(), one.unknown.tolist(), one.places.columns.tolist()
    ([0.4, 0.4], [True, True], [0, 1])
    """
    if any(max(pair) % min(pair) for pair in zip(shape, wanted, strict=True)):
        msg = f"a grid of {shape} cannot be brought to {wanted}"
        raise ValueError(msg)
    places = seen.places
    order = np.lexsort((places.columns, places.rows, places.stamps_ns))
    stamps_ns = np.unique(places.stamps_ns)
    grids = [
        _in_cells(values[order].reshape(-1, *shape), wanted)
        for values in (seen.cluster, seen.p_obstacle, seen.unknown)
    ]
    rows, columns = np.divmod(np.arange(wanted[0] * wanted[1]), wanted[1])
    n_images = stamps_ns.size
    return SeenPatches(
        PatchPlaces(
            np.repeat(stamps_ns, rows.size), np.tile(rows, n_images), np.tile(columns, n_images)
        ),
        grids[0][..., 0].ravel().astype(np.int64),
        grids[1].astype(np.float64).mean(axis=-1).ravel(),
        grids[2].mean(axis=-1).ravel() >= _HALF,
    )


def _in_cells(
    images: IntArray | Float64Array | BoolArray, wanted: tuple[int, int]
) -> IntArray | Float64Array | BoolArray:
    """Return for each cell (n, rows, columns, k) the values of the k patches it is made of."""
    for axis, n_wanted in enumerate(wanted, start=1):
        if images.shape[axis] < n_wanted:
            images = images.repeat(n_wanted // images.shape[axis], axis=axis)
    n, rows, columns = images.shape[0], *wanted
    down, across = images.shape[1] // rows, images.shape[2] // columns
    parts = images.reshape(n, rows, down, columns, across).swapaxes(2, 3)
    return parts.reshape(n, rows, columns, down * across)
