"""Values of bins become histograms, and histograms points (equation 7).

The points of inverse-min are made of blocks, each a histogram embedded by itself.
"""

import math
from collections.abc import Sequence

import numpy as np

from mpap_cli.distance import ZERO_MASS
from mpap_cli.features.scans.rows import _kernels
from mpap_cli.observations import Float32Array, Float64Array
from mpap_cli.params import ScanParams

APPROACH_STEP_M = 0.5
# range, slack, and whether the histogram is empty
_RANGE_BLOCK = 3


def embed_values(
    values: Float64Array, front: Float64Array, change: Float64Array, params: ScanParams, cap: float
) -> Float32Array:
    """Embed the values of scans.

    Parameters
    ----------
    values : ndarray of shape (n, bins)
        One value a bin.
    front, change : ndarray of shape (n,)
        For inverse-min: nearest range with what lies behind stretched, and change of the
        nearest range ahead, in metres.
    params : ScanParams
        Feature, slack, weights.
    cap : float
        The longest range, in metres.

    Returns
    -------
    ndarray of shape (n, d)
        Rows of length 1.
    """
    if params.feature != "inverse-min":
        if params.feature == "seq-diff-signed":
            values = np.concatenate([np.maximum(values, 0.0), np.maximum(-values, 0.0)], axis=1)
        return _embedded([(1.0, _with_slack(values, params.bins * cap, params))])
    near, most = inverse(values, params), 1.0 / params.near_floor_m
    in_front = inverse(front[:, None], params)
    blocks = (
        (params.ring_weight, _with_slack(near.max(axis=1, keepdims=True), most, params)),
        (params.front_weight, _with_slack(in_front, most, params)),
        (params.sector_weight, _with_slack(near, params.bins * most, params)),
        (params.approach_weight, _approach_histogram(change)),
    )
    total = sum(weight for weight, _ in blocks)
    return _embedded([(weight / total, block) for weight, block in blocks if weight > 0])


def _embedded(blocks: Sequence[tuple[float, Float64Array]]) -> Float32Array:
    """Embed histograms and put them beside one another; each has its share of the length.

    Raises
    ------
    ValueError
        If a value is negative or not finite, as `distance.embed` does.
    """
    n_rows, n_dims = len(blocks[0][1]), sum(block.shape[1] + 1 for _, block in blocks)
    points = np.empty((n_rows, n_dims), np.float32)
    begin = n_bad = 0
    for share, block in blocks:
        n_bad += _kernels.embed_rows(block, math.sqrt(share), ZERO_MASS, points, begin)
        begin += block.shape[1] + 1
    if n_bad:
        msg = f"values of bins: {n_bad} of {n_rows * n_dims} are negative or not finite"
        raise ValueError(msg)
    return points


def range_columns(params: ScanParams) -> tuple[int, ...]:
    """Return where the blocks of a single range begin: range, slack, and empty or not.

    None for a feature without such blocks, or without slack, where a block of one range
    says nothing.

    Examples
    --------
    >>> range_columns(ScanParams(keep_scale=True)), range_columns(ScanParams())
    ((0, 3), ())
    """
    if params.feature != "inverse-min" or not params.keep_scale:
        return ()
    weighty = [weight for weight in (params.ring_weight, params.front_weight) if weight > 0]
    return tuple(_RANGE_BLOCK * block for block in range(len(weighty)))


def inverse(values: Float64Array, params: ScanParams) -> Float64Array:
    """Return 1 / range, for ranges brought between floor and cap."""
    return 1.0 / np.clip(values, params.near_floor_m, params.near_cap_m)


def _with_slack(histogram: Float64Array, most: float, params: ScanParams) -> Float64Array:
    """Append what the sum of a histogram lacks of the most it can be, if scale is kept."""
    if not params.keep_scale:
        return histogram
    slack = np.maximum(most - histogram.sum(axis=1, keepdims=True), 0.0)
    return np.concatenate([histogram, slack], axis=1)


def _approach_histogram(change: Float64Array) -> Float64Array:
    """Return receding, approaching, still (n, 3) from the change of the nearest range."""
    step = np.clip(change, -APPROACH_STEP_M, APPROACH_STEP_M)
    parts = (np.maximum(step, 0.0), np.maximum(-step, 0.0), APPROACH_STEP_M - np.abs(step))
    return np.stack(parts, axis=1)
