"""How many beams come back in contact and otherwise: why max-value does well, or not (5.2)."""

import numpy as np

from mpap_cli.commands.reproducing.laser_logs import Scene
from mpap_cli.observations import BoolArray, IntArray, ScanBlock


def lost_shares(scene: Scene) -> tuple[float | None, float | None]:
    """Return the percentage of beams without return in contact, and in all other scans.

    Parameters
    ----------
    scene : Scene
        Logs with the contacts that are scored.

    Returns
    -------
    tuple of float or None
        None where there is no such scan. What lies outside of range_min and range_max is
        no return.
    """
    lost, beams = np.zeros(2), np.zeros(2)
    presses = scene.truth or tuple(log.presses or () for log in scene.logs)
    for log, of_log in zip(scene.logs, presses, strict=True):
        ends = np.array([(one.start_ns, one.end_ns) for one in of_log], np.int64).reshape(-1, 2)
        for block in log.blocks():
            in_contact = _inside(block.stamps_ns, ends)
            without = _without_return(block, log.range_max)
            for index, chosen in enumerate((in_contact, ~in_contact)):
                lost[index] += without[chosen].sum()
                beams[index] += without[chosen].size
    in_contact_share, other_share = (
        100 * part / whole if whole else None for part, whole in zip(lost, beams, strict=True)
    )
    return in_contact_share, other_share


def _inside(stamps_ns: IntArray, ends_ns: IntArray) -> BoolArray:
    """Tell which stamps lie within one of the intervals (m, 2)."""
    begun = stamps_ns[:, None] >= ends_ns[None, :, 0]
    return np.asarray((begun & (stamps_ns[:, None] < ends_ns[None, :, 1])).any(axis=1))


def _without_return(block: ScanBlock, range_max: float | None) -> BoolArray:
    """Tell which beams (n, n_beams) of a block did not come back."""
    top = block.geometry.range_max if range_max is None else range_max
    ranges = block.ranges
    good = (
        np.isfinite(ranges) & (ranges > 0) & (ranges >= block.geometry.range_min) & (ranges < top)
    )
    return np.asarray(~good)
