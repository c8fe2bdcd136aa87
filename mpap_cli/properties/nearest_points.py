"""How far the nearest of many points is, where nothing else of them matters."""

import numpy as np

from mpap_cli.observations import Float64Array, FloatArray

# More than a float32 product of two vectors of length 1 is off, for each coordinate.
_ROUNDING = 5e-7
_GROUP = 64
_MOST_BOUNDS = 1 << 18


class NearestPoints:
    """Finds the distance of the nearest of n points, exactly and without all distances.

    Float32 products rule out nearly all of the points; to the others squared distances are
    summed up in float64 from the first coordinate to the last, as
    :func:`mpap_cli.distance.squared_distances` does: the results have the same bytes.

    Parameters
    ----------
    references : ndarray of shape (n, d)
        Embedded histograms or their means; not changed.

    Examples
    --------
    >>> nearest = NearestPoints(np.array([[1.0, 0.0], [0.0, 1.0]]))
    >>> nearest.least_squared(np.array([[0.6, 0.8]])).round(3).tolist()
    [0.2]
    """

    def __init__(self, references: Float64Array) -> None:
        n, d = references.shape
        self._references = references
        squares = np.square(references).sum(axis=1)
        self._slack = np.float32(_ROUNDING * (d + 4) * squares.max(initial=1.0))
        # half of the squared length less the product; what fills the last group is far away
        self._turned = np.zeros((d + 1, -(-n // _GROUP) * _GROUP), np.float32)
        self._turned[:d, :n], self._turned[d, :n] = -references.T, 0.5 * squares
        self._turned[d, n:] = np.inf

    def least_squared(self, points: FloatArray) -> Float64Array:
        """Return squared distances (m,), equation 7, of points (m, d); inf if there are none."""
        least = np.full(len(points), np.inf)
        width = self._turned.shape[1]
        if not width:
            return least
        step = max(1, _MOST_BOUNDS // width)
        bounds = np.empty((min(step, len(points)), width), np.float32)
        for start in range(0, len(points), step):
            part = points[start : start + step]
            least[start : start + step] = self._least(part, bounds[: len(part)])
        return least

    def _least(self, points: FloatArray, bounds: FloatArray) -> Float64Array:
        """Do the same for few points, with room for what bounds the distances."""
        ones = np.ones((len(points), 1), np.float32)
        np.matmul(np.concatenate([points.astype(np.float32), ones], axis=1), self._turned, bounds)
        # a group are points at even distances in the table: numpy finds its minimum faster
        groups = bounds.reshape(len(points), _GROUP, -1)
        of_groups = groups.min(axis=1)
        limit = of_groups.min(axis=1) + self._slack
        point, group = np.nonzero(of_groups <= limit[:, None])
        which, place = np.nonzero(groups[point, :, group] <= limit[point, None])
        point, row = point[which], place * groups.shape[2] + group[which]
        squared = np.zeros(point.size)
        for x, y in zip(points.T, self._references.T, strict=True):
            change = x[point].astype(np.float64) - y[row]
            squared += change * change
        first = np.searchsorted(point, np.arange(len(points)))
        return np.asarray(0.5 * np.minimum.reduceat(squared, first), np.float64)
