"""Kinds of arrays of the renderer."""

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
"""Values of 0 to 255: pixels (h, w, 3), blue first, or labels (h, w)."""

Packed = NDArray[np.uint32]
"""Several small numbers in the bits of one."""

BinArray = NDArray[np.int16]
"""Numbers of bins of bearing."""
