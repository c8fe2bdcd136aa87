"""From patches to a motion: straight on, or to where more space is free (section 4.2.6)."""

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array, Int8Array, IntArray
from mpap_cli.params import ObstacleParams

ACTIONS = ("straight", "rotate-left", "rotate-right", "stop")
STRAIGHT, ROTATE_LEFT, ROTATE_RIGHT, STOP = range(4)


class Decider:
    """Decides on a motion for each image of a log, in time order.

    Parameters
    ----------
    params : ObstacleParams
        ``patch_threshold``, ``unknown``, ``front_rows``, ``side_rows``.
    shape : tuple of int
        Rows and columns of patches.

    Notes
    -----
    The paper names the free space in front and the directions that make it larger, and no
    formula. Free depth of a column is the number of patches from the bottom up to the first
    obstacle. The robot goes straight if the two middle columns (the middle one, if their
    number is odd) have a depth of ``front_rows`` or more, at most all rows, and those beside
    them of ``side_rows``: near the robot its own width covers them too. Else it rotates
    towards the half with more free depth; if both have the same it goes on in the direction
    of the last rotation, left at first, lest it turn back and forth in a corner. It stops if
    no column has any.

    Examples
    --------
    >>> decider = Decider(ObstacleParams(), (3, 4))
    >>> p = np.zeros((2, 12))
    >>> p[1, [9, 10, 11]] = 0.9
    >>> [ACTIONS[action] for action in decider.decide(p, p < 0)]
    ['straight', 'rotate-left']
    """

    def __init__(self, params: ObstacleParams, shape: tuple[int, int]) -> None:
        self._params = params
        self._shape = shape
        self._direction = ROTATE_LEFT

    def decide(self, p_obstacle: Float64Array, unknown: BoolArray) -> Int8Array:
        """Decide on the motion for images that follow those of the call before.

        Parameters
        ----------
        p_obstacle : ndarray of shape (n, rows * columns)
            Probability of each patch, NaN (no obstacle) where the model has no labels.
        unknown : ndarray of shape (n, rows * columns)
            Patches that the model does not know; ``params.unknown`` says what they are.

        Returns
        -------
        ndarray of shape (n,)
            Indices into :data:`ACTIONS`.
        """
        depth = self._free_depth(self.obstacles(p_obstacle, unknown))
        rows, columns = self._shape
        first, behind = (columns - 1) // 2, columns // 2 + 1
        front = depth[:, first:behind].min(axis=1)
        beside = depth[:, max(first - 1, 0) : behind + 1].min(axis=1)
        half = columns // 2
        more_left = depth[:, :half].sum(axis=1) - depth[:, columns - half :].sum(axis=1)
        turns = front < min(self._params.front_rows, rows)
        turns |= beside < min(self._params.side_rows, rows)
        stops = turns & (depth.max(axis=1) == 0)
        turns &= ~stops
        actions = np.zeros(len(depth), dtype=np.int8)
        actions[turns] = self._directions(more_left[turns])
        actions[stops] = STOP
        return actions

    def obstacles(self, p_obstacle: Float64Array, unknown: BoolArray) -> BoolArray:
        """Tell which patches are obstacles for the decision; arrays of one shape."""
        known: BoolArray = (p_obstacle >= self._params.patch_threshold) & ~unknown
        return known | unknown if self._params.unknown == "obstacle" else known

    def _free_depth(self, obstacles: BoolArray) -> IntArray:
        """Count the free patches (n, columns) from the bottom up to the first obstacle."""
        grid = obstacles.reshape(-1, *self._shape)[:, ::-1]
        depth: IntArray = np.logical_and.accumulate(~grid, axis=1).sum(axis=1, dtype=np.int64)
        return depth

    def _directions(self, more_left: IntArray) -> Int8Array:
        """Return where to rotate, and keep the last direction for where it is all the same."""
        wanted = np.where(more_left > 0, ROTATE_LEFT, ROTATE_RIGHT)
        wanted = np.append(self._direction, wanted)
        clear = np.append(True, more_left != 0)
        last_clear = np.maximum.accumulate(np.where(clear, np.arange(clear.size), 0))
        directions = wanted[last_clear]
        self._direction = int(directions[-1])
        return directions[1:].astype(np.int8)
