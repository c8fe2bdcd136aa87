"""Cleaning of laser ranges, beam by beam, before they are binned (section 4.1).

Drivers write "nothing in range" as infinity, NaN, 0, a negative number or a code above
range_max, and "too near" as minus infinity or a range below range_min. The paper draws
beams without return at the maximum range; so do we.
"""

import math
from dataclasses import dataclass

import numpy as np

from mpap_cli.errors import UsageError
from mpap_cli.features.scans import _kernels
from mpap_cli.observations import Float32Array, ScanGeometry
from mpap_cli.params import ScanParams


@dataclass(frozen=True, slots=True)
class RangeLimits:
    """What ranges of one geometry are held against and replaced by, in metres.

    ``reach`` is the longest range that counts as a return, ``cap`` (at most ``reach``) the
    longest that is told apart. ``near``, ``zero`` and ``none`` replace a beam that is too
    near, zero, or without return; -1 stands for a beam that is left out.
    """

    range_min: float
    reach: float
    cap: float
    near: float
    zero: float
    none: float

    def as_array(self) -> Float32Array:
        """Return the fields in order, as the kernels take them."""
        values = (self.range_min, self.reach, self.cap, self.near, self.zero, self.none)
        return np.array(values, np.float32)


def range_limits(
    geometry: ScanGeometry, params: ScanParams, range_max: float | None = None
) -> RangeLimits:
    """Settle the limits for scans of one geometry.

    Parameters
    ----------
    geometry : ScanGeometry
        Its ``range_max`` counts if it is finite and above ``range_min``.
    params : ScanParams
        ``max_range`` caps the ranges; above range_max it says that the scanner sees
        farther than its messages claim. A return between cap and range_max counts as the
        cap, and is not left out under ``no_return="drop"``.
    range_max : float, optional
        Metres, instead of an unusable ``range_max`` of the geometry.

    Returns
    -------
    RangeLimits
        All values finite.

    Raises
    ------
    UsageError
        If there is no usable maximum at all.

    Examples
    --------
    >>> geometry = ScanGeometry(181, -1.57, 0.01745, 0.05, 8.0)
    >>> range_limits(geometry, ScanParams(no_return="drop")).none
    -1.0
    """
    range_min = geometry.range_min if 0 < geometry.range_min < math.inf else 0.0
    usable = range_min < geometry.range_max < math.inf
    reach = geometry.range_max if usable else range_max
    reach = params.max_range if reach is None else max(reach, params.max_range or 0.0)
    if reach is None or not 0 < reach < math.inf:
        msg = (
            f"range_max of the scans: found {geometry.range_max}, which cannot be used; "
            "say how far the scanner sees with --max-range METRES"
        )
        raise UsageError(msg)
    cap = params.max_range or reach
    none = cap if params.no_return == "max" else _kernels.DROPPED
    near = min(range_min, cap) if params.near == "min" else none
    zero = near if params.zero == "near" else none
    return RangeLimits(range_min, reach, cap, near, zero, none)


def clean_ranges(ranges: Float32Array, limits: RangeLimits) -> Float32Array:
    """Clean ranges.

    Parameters
    ----------
    ranges : ndarray of shape (n, n_beams), float32
        Metres as recorded; anything a driver writes.
    limits : RangeLimits
        What they are held against.

    Returns
    -------
    ndarray of shape (n, n_beams), float32
        Metres in [0, cap]; -1 where a beam is left out.

    Examples
    --------
    >>> limits = RangeLimits(0.1, 8.0, 8.0, 0.1, 8.0, 8.0)
    >>> clean_ranges(np.array([[0.05, 0.0, 3.0, np.inf]], np.float32), limits).tolist()
    [[0.10000000149011612, 8.0, 3.0, 8.0]]
    """
    return _kernels.clean_block(np.ascontiguousarray(ranges, np.float32), limits.as_array())
