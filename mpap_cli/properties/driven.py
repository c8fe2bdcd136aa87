"""How far the robot gets ahead after each moment, by its odometry (section 4.2.3)."""

import numpy as np

from mpap_cli.observations import NS_PER_S, Float64Array, IntArray, PoseBlock

OLDEST_POSE_NS = NS_PER_S


def driven_ahead(stamps_ns: IntArray, poses: PoseBlock, within_s: float) -> Float64Array:
    """Return how far the robot gets ahead of where it was, in the direction it looked.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Moments, in any order.
    poses : PoseBlock
        Odometry, in time order.
    within_s : float
        Seconds after each moment that are looked at.

    Returns
    -------
    ndarray of shape (n,)
        Metres, 0 or more: the largest way along the heading at the moment. Turning and
        driving back count nothing. NaN where the last pose at or before the moment is more
        than a second old, or there is none.

    Examples
    --------
    >>> stamps_ns = np.array([0, 1, 2]) * NS_PER_S
    >>> poses = PoseBlock(stamps_ns, np.array([[0.0, 0, 0], [0.5, 0, 0], [0.4, 0, 3.14]]))
    >>> driven_ahead(stamps_ns, poses, within_s=2.0).tolist()
    [0.5, 0.0, 0.0]
    """
    driven = np.full(len(stamps_ns), np.nan)
    start = np.searchsorted(poses.stamps_ns, stamps_ns, side="right") - 1
    stop = np.searchsorted(poses.stamps_ns, stamps_ns + round(within_s * NS_PER_S), side="right")
    known = np.flatnonzero(start >= 0)
    known = known[stamps_ns[known] - poses.stamps_ns[start[known]] <= OLDEST_POSE_NS]
    if not known.size:
        return driven
    start, length = start[known], (stop - start)[known]
    begins = np.cumsum(length) - length
    pose = np.arange(length.sum()) + np.repeat(start - begins, length)
    from_start = poses.poses[pose, :2] - np.repeat(poses.poses[start, :2], length, axis=0)
    heading = np.repeat(poses.poses[start, 2], length)
    ahead = from_start[:, 0] * np.cos(heading) + from_start[:, 1] * np.sin(heading)
    driven[known] = np.maximum.reduceat(ahead, begins)
    return driven
