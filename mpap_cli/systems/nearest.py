"""The exemplars nearest to patches, found fast and decided in float64 (section 4.2.5)."""

import numpy as np

from mpap_cli.observations import Float32Array, Float64Array, IntArray

_MOST_DISTANCES = 1 << 20


def nearest_exemplars(
    points: Float32Array, exemplars: Float32Array, k: int
) -> tuple[IntArray, Float64Array]:
    """Find the nearest exemplars of each point.

    Parameters
    ----------
    points, exemplars : ndarray of shape (m, d) and (f, d)
        Embedded patches, of length 1.
    k : int
        How many; all of them if there are fewer.

    Returns
    -------
    tuple of ndarray of shape (m, max(1, min(k, f)))
        Rows of the exemplars and squared distances (equation 7, float64), the nearest
        first, of equals the first. Row -1 at distance inf if there is no exemplar.
    """
    m, f = len(points), len(exemplars)
    if not f:
        return np.full((m, 1), -1, dtype=np.int64), np.full((m, 1), np.inf)
    if k == 1:
        from mpap_cli.clustering.strap_rows._kernels import nearest  # noqa: PLC0415  # slow: numba

        rows, squared = nearest(points, exemplars)
        return rows[:, None], squared[:, None]
    from mpap_cli.systems._kernels import find_several  # noqa: PLC0415  # slow: numba

    step = max(1, _MOST_DISTANCES // f)
    parts = [
        find_several(points[at : at + step], exemplars, min(k, f))
        for at in range(0, max(1, m), step)
    ]
    return np.concatenate([rows for rows, _ in parts]), np.concatenate([s for _, s in parts])
