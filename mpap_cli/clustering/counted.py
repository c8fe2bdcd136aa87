"""What counts that come out of a file may be."""

import numpy as np

from mpap_cli.observations import IntArray

MOST_COUNTED = 1 << 53


def are_counts(counts: IntArray, least: int = 0) -> bool:
    """Whether all counts are large enough, and their sum so small that no sum overflows.

    Parameters
    ----------
    counts : ndarray of any shape
        From a file that is not trusted.
    least : int
        What each must be at least.

    Examples
    --------
    >>> are_counts(np.array([3, 0])), are_counts(np.array([3, 0]), least=1)
    (True, False)
    >>> are_counts(np.array([1 << 62, 1 << 62]))
    False
    """
    fit = bool((counts >= least).all())
    return fit and float(counts.sum(dtype=np.float64)) < MOST_COUNTED
