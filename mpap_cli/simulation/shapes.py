"""Lines and circles seen from above, and which of them is nearest to a point."""

import math
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import Float64Array


@dataclass(frozen=True, slots=True)
class Nearest:
    """The shape nearest to a point: its number, its distance and where it is touched."""

    index: int
    distance_m: float
    x: float
    y: float


class Shapes:
    """Segments and circles in the plane, numbered in that order.

    Parameters
    ----------
    segments : ndarray of shape (n, 4)
        x, y of one end and of the other, metres.
    circles : ndarray of shape (m, 3)
        x, y of the center and radius, metres.

    Examples
    --------
    >>> wall = Shapes(np.array([[0.0, 1.0, 2.0, 1.0]]), np.empty((0, 3)))
    >>> wall.nearest(1.0, 0.25).distance_m
    0.75
    """

    def __init__(self, segments: Float64Array, circles: Float64Array) -> None:
        self.segments = segments.copy()
        self.circles = circles.copy()
        self._along = segments[:, 2:] - segments[:, :2]
        self._length2 = np.maximum((self._along**2).sum(axis=1), 1e-12)

    def __len__(self) -> int:
        return len(self.segments) + len(self.circles)

    def nearest(self, x: float, y: float) -> Nearest:
        """Return the nearest shape; distances inside a circle are negative.

        With no shapes at all the distance is infinite and the index -1.
        """
        best = Nearest(-1, math.inf, x, y)
        if len(self.segments):
            start = self.segments[:, :2]
            from_start = np.array((x, y)) - start
            share = (from_start * self._along).sum(axis=1) / self._length2
            touched = start + np.clip(share, 0.0, 1.0)[:, None] * self._along
            gaps = np.hypot(touched[:, 0] - x, touched[:, 1] - y)
            i = int(gaps.argmin())
            best = Nearest(i, float(gaps[i]), float(touched[i, 0]), float(touched[i, 1]))
        if len(self.circles):
            center_gaps = np.hypot(self.circles[:, 0] - x, self.circles[:, 1] - y)
            gaps = center_gaps - self.circles[:, 2]
            i = int(gaps.argmin())
            if gaps[i] < best.distance_m:
                shrink = self.circles[i, 2] / max(float(center_gaps[i]), 1e-9)
                touched_x = self.circles[i, 0] + (x - self.circles[i, 0]) * shrink
                touched_y = self.circles[i, 1] + (y - self.circles[i, 1]) * shrink
                index = len(self.segments) + i
                best = Nearest(index, float(gaps[i]), float(touched_x), float(touched_y))
        return best
