"""What was ahead of the robot, and whether it drove, at given moments (section 5.3.3)."""

import math

import numpy as np

from mpap_cli.features.scans.scan_bins import beam_bearings
from mpap_cli.features.scans.scan_cleaning import clean_ranges, range_limits
from mpap_cli.observations import (
    NS_PER_S,
    BoolArray,
    Float64Array,
    IntArray,
    PoseBlock,
    ScanBlock,
)
from mpap_cli.params import ScanParams
from mpap_cli.properties.driven import driven_ahead

AHEAD_RAD = math.radians(20)
PAIRED_NS = NS_PER_S // 5
# Odometry is looked at over half a second: the robot drives if it gets on by 5 cm.
_PACE_S = 0.5
_PACE_M = 0.05


def nearest_straight_ahead(
    block: ScanBlock, params: ScanParams, forward_rad: float, range_max: float | None = None
) -> Float64Array:
    """Return the nearest return within 20 degrees of straight ahead (section 5.3.3).

    Parameters
    ----------
    block : ScanBlock
        Scans as recorded; not changed.
    params : ScanParams
        How ranges are cleaned.
    forward_rad : float
        Direction of travel in the frame of the scanner.
    range_max : float, optional
        Metres, instead of an unusable ``range_max`` of the scans.

    Returns
    -------
    ndarray of shape (n,)
        Metres from the scanner; NaN where nothing came back from there.

    Raises
    ------
    UsageError
        If there is no usable maximum range.

    Examples
    --------
    >>> from mpap_cli.observations import ScanGeometry
    >>> geometry = ScanGeometry(3, -0.5, 0.5, 0.1, 8.0)
    >>> ranges = np.array([[0.5, 2.0, 9.0], [0.5, 9.0, 0.5]], np.float32)
    >>> block = ScanBlock(np.array([0, 1]), ranges, geometry)
    >>> nearest_straight_ahead(block, ScanParams(), 0.0).tolist()
    [2.0, nan]
    """
    ranges = returned_ranges(block, params, range_max)
    is_ahead = np.abs(beam_bearings(block.geometry, forward_rad)) <= AHEAD_RAD
    seen = is_ahead & ~np.isnan(ranges)
    nearest = np.min(ranges, axis=1, where=seen, initial=np.inf)
    return np.where(np.isinf(nearest), np.nan, nearest)


def returned_ranges(
    block: ScanBlock, params: ScanParams, range_max: float | None = None
) -> Float64Array:
    """Return the ranges (n, n_beams) in metres, NaN where nothing came back.

    Parameters and errors are those of :func:`nearest_straight_ahead`.
    """
    limits = range_limits(block.geometry, params, range_max)
    cleaned = clean_ranges(block.ranges, limits).astype(np.float64)
    return np.where((cleaned >= 0) & (cleaned < np.float32(limits.cap)), cleaned, np.nan)


def values_at(stamps_ns: IntArray, value_stamps_ns: IntArray, values: Float64Array) -> Float64Array:
    """Return for each moment the value nearest in time.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Moments.
    value_stamps_ns : ndarray of shape (m,)
        Stamps of the values, not decreasing.
    values : ndarray of shape (m,)
        For example the nearest ranges of the scans.

    Returns
    -------
    ndarray of shape (n,)
        NaN where no value is within 0.2 s; of two equally near the earlier one.

    Examples
    --------
    >>> values_at(np.array([0, NS_PER_S]), np.array([100_000_000]), np.array([2.5])).tolist()
    [2.5, nan]
    """
    if not value_stamps_ns.size:
        return np.full(stamps_ns.size, np.nan)
    after = np.searchsorted(value_stamps_ns, stamps_ns)
    low = np.maximum(after - 1, 0)
    high = np.minimum(after, value_stamps_ns.size - 1)
    to_low = np.abs(stamps_ns - value_stamps_ns[low])
    to_high = np.abs(value_stamps_ns[high] - stamps_ns)
    nearest = np.where(to_high < to_low, high, low)
    return np.where(np.minimum(to_low, to_high) <= PAIRED_NS, values[nearest], np.nan)


def drives_ahead(stamps_ns: IntArray, poses: PoseBlock) -> BoolArray:
    """Tell at which moments the robot drives forward, by its odometry.

    Returns
    -------
    ndarray of shape (n,)
        True where it got on by 5 cm or more over the half second before, in the direction
        it looked then; False where the odometry does not tell.
    """
    ahead_m = driven_ahead(stamps_ns - round(_PACE_S * NS_PER_S), poses, _PACE_S)
    return ahead_m >= _PACE_M
