"""Labels of image patches from the presses of their log (section 4.2.3).

A label is 1 (obstacle), 0 (no obstacle) or -1 (none: not counted).
"""

from collections.abc import Sequence

import numpy as np

from mpap_cli.observations import (
    NS_PER_S,
    BoolArray,
    Float64Array,
    Int8Array,
    IntArray,
    Press,
)
from mpap_cli.params import ObstacleParams
from mpap_cli.properties.labels import (
    NO_LABEL,
    label_contact,
    label_early,
    label_onset,
    press_starts,
)

NO_PRESS = -1


def label_patches(
    stamps_ns: IntArray,
    presses: Sequence[Press],
    params: ObstacleParams,
    shape: tuple[int, int],
    driven_m: Float64Array | None = None,
) -> Int8Array:
    """Label the patches of images (section 4.2.3).

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Images of one log, not decreasing.
    presses : sequence of Press
        Of the same log, apart from each other and in time order.
    params : ObstacleParams
        Which images and patches count.
    shape : tuple of int
        Rows and columns of patches.
    driven_m : ndarray of shape (n,), optional
        Metres that the robot gets ahead within ``driven_before_s`` of each image, NaN where
        nobody knows; left out without odometry.

    Returns
    -------
    ndarray of shape (n, rows * columns)
        1 for the patches (of the rows ``label_rows``) of images of a press, see
        :func:`pressed_images`. Of the other images 0 for every patch if ``obstacle_labels``
        is ``plain``; if it is ``driven``, 0 only where :func:`floor_patches` lie and only in
        :func:`driven_images`, and 1 only for ``press_image_s``. Else -1.

    Notes
    -----
    The paper calls every patch of every other image no obstacle. Most of them then show
    walls that are not touched at the moment, so that no cluster comes near probability 1.
    A robot that is stuck for long shows one thing again and again, which says no more about
    it than the first second of the press.

    Examples
    --------
    >>> stamps_ns = np.array([0, 10, 20]) * NS_PER_S
    >>> press = Press(10 * NS_PER_S, 11 * NS_PER_S)
    >>> label_patches(stamps_ns, [press], ObstacleParams(), (2, 3)).tolist()
    [[-1, -1, -1, -1, 0, -1], [1, 1, 1, 1, 1, 1], [-1, -1, -1, -1, 0, -1]]
    """
    rows, columns = shape
    press_ns = pressed_images(stamps_ns, presses, params.bump_image_s)
    pressed = touched = press_ns != NO_PRESS
    labels = np.full((len(stamps_ns), rows, columns), NO_LABEL, dtype=np.int8)
    if params.obstacle_labels == "plain":
        labels[~pressed] = 0
    else:
        driven = driven_images(stamps_ns, presses, params, driven_m) & ~pressed
        labels[driven[:, None, None] & floor_patches(shape)] = 0
        touched = pressed & (stamps_ns - press_ns < round(params.press_image_s * NS_PER_S))
    labelled = slice(*(params.labelled_rows() or (0, rows)))
    labels[touched, labelled] = 1
    return labels.reshape(len(stamps_ns), rows * columns)


def pressed_images(
    stamps_ns: IntArray, presses: Sequence[Press], bump_image_s: float = 0.2
) -> IntArray:
    """Tell which images show what a press touches, by the start of that press.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Images of one log, not decreasing.
    presses : sequence of Press
        Of the same log, apart from each other and in time order.
    bump_image_s : float
        The image nearest to the start of a press counts if it is at most that far from it.

    Returns
    -------
    ndarray of shape (n,)
        Start of the press during which the image was made, or else to whose start no other
        image is nearer (the earlier of two that are equally near); -1 if there is none.

    Examples
    --------
    >>> stamps_ns = np.array([0, 1, 2, 3]) * NS_PER_S // 5
    >>> pressed_images(stamps_ns, [Press(210_000_000, 390_000_000)]).tolist()
    [-1, 210000000, -1, -1]
    """
    during = label_contact(stamps_ns, presses) == 1
    found = np.where(during, press_starts(stamps_ns, presses), NO_PRESS)
    if not found.size:
        return found
    starts = np.array([press.start_ns for press in presses], dtype=np.int64)
    nearest = _nearest(stamps_ns, starts)
    near = np.abs(stamps_ns[nearest] - starts) <= round(bump_image_s * NS_PER_S)
    free = near & ~during[nearest]
    # the first of several presses that have the same nearest image
    image, first = np.unique(nearest[free], return_index=True)
    found[image] = starts[free][first]
    return found


def driven_images(
    stamps_ns: IntArray,
    presses: Sequence[Press],
    params: ObstacleParams,
    driven_m: Float64Array | None = None,
) -> BoolArray:
    """Tell which images show floor that the robot then drives over.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Images of one log.
    presses : sequence of Press
        Of the same log, apart from each other and in time order.
    params : ObstacleParams
        ``driven_before_s``, ``driven_after_s``, ``driven_min_m``, ``driven_share``.
    driven_m : ndarray of shape (n,), optional
        Metres that the robot gets ahead, in time order, NaN where nobody knows.

    Returns
    -------
    ndarray of shape (n,)
        True where no press begins within ``driven_before_s``, none was on within the last
        ``driven_after_s``, and the robot goes straight on, as far as anyone knows: at least
        ``driven_min_m``, and ``driven_share`` of the farthest that it got ahead so far. A
        robot that slows down or turns away from a wall does not drive over it.
    """
    none_soon = label_early(stamps_ns, presses, params.driven_before_s) == 0
    none_lately = label_onset(stamps_ns, presses, release_s=params.driven_after_s) == 0
    free: BoolArray = none_soon & none_lately
    if driven_m is None:
        return free
    farthest_m = np.fmax.accumulate(np.nan_to_num(driven_m))
    least_m = np.maximum(params.driven_min_m, params.driven_share * farthest_m)
    return free & ~(driven_m < least_m)


def floor_patches(shape: tuple[int, int]) -> BoolArray:
    """Tell which patches lie on the path of the robot.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns of patches.

    Returns
    -------
    ndarray of shape (rows, columns)
        True in the lower half of the rows (the larger half if they are odd), where the
        middle of the patch is in the middle two thirds of the image.

    Examples
    --------
    >>> floor_patches((2, 6)).astype(int).tolist()
    [[0, 0, 0, 0, 0, 0], [0, 1, 1, 1, 1, 0]]
    """
    rows, columns = shape
    low = np.arange(rows) >= rows // 2
    middles = 2 * np.arange(columns) + 1
    inside = (3 * middles > columns) & (3 * middles < 5 * columns)
    floor: BoolArray = low[:, None] & inside
    return floor


def _nearest(stamps_ns: IntArray, moments_ns: IntArray) -> IntArray:
    """Return the index of the stamp nearest to each moment, the first of equals."""
    after = np.searchsorted(stamps_ns, moments_ns).clip(max=stamps_ns.size - 1)
    before = (after - 1).clip(min=0)
    nearer = moments_ns - stamps_ns[before] <= stamps_ns[after] - moments_ns
    # of images with the same stamp the first
    return np.searchsorted(stamps_ns, stamps_ns[np.where(nearer, before, after)])
