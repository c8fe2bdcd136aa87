"""The texture of a patch: a histogram of local binary patterns (section 4.2.2).

A pixel's code says which of its eight neighbors are not darker than it, one bit each,
against the clock from the right. Codes whose bits change at most twice around the circle
are uniform and have a bin each; all others share the last (Ojala et al. 2002).
"""

import numpy as np

from mpap_cli.observations import IntArray

NEIGHBORS = 8


def uniform_codes() -> IntArray:
    """Return the codes that have a bin of their own, in the order of the bins.

    Returns
    -------
    ndarray of shape (58,), int64
        The code without a bit, eight codes for each number of bits from 1 to 7, which are
        turned one step at a time with the clock, the code of all bits; the order of
        scikit-image's ``nri_uniform``, whose bin 58 holds the codes that are not uniform.

    Examples
    --------
    >>> uniform_codes()[:4].tolist(), uniform_codes()[-1].item()
    ([0, 1, 128, 64], 255)
    """
    every = 1 << NEIGHBORS
    codes = [0]
    for n_ones in range(1, NEIGHBORS):
        ones = (1 << n_ones) - 1
        codes += [(ones >> turn | ones << (NEIGHBORS - turn)) % every for turn in range(NEIGHBORS)]
    return np.array([*codes, every - 1], np.int64)
