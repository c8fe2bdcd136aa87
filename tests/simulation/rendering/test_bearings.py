"""Every bin of bearing lists what can be seen there, nearest first."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mpap_cli.simulation.rendering.bearings._kernels import list_bins
from mpap_cli.simulation.world import turned_corners

REACH_M = 10.0
HALF_WIDTH = 0.7
N_BINS = 64

place = st.floats(-12, 12)
things = st.lists(
    st.tuples(place, place, st.floats(0.01, 2), st.floats(0, 3), st.sampled_from((1, 2, 4))),
    min_size=1,
    max_size=8,
)


@given(things)
@settings(deadline=None, max_examples=60)
def test_bins_hold_what_a_ray_could_meet(
    drawn: list[tuple[float, float, float, float, int]],
) -> None:
    """A point of a thing within reach and view is in the list of its bin."""
    points, counts = np.zeros((len(drawn), 4, 2)), np.array([n for *_, n in drawn], np.int64)
    solids = np.zeros((len(drawn), 8))
    for i, (x, y, side, turn, n) in enumerate(drawn):
        corners = turned_corners((x, y), (side, side / 2), turn)
        points[i, :n] = [(x, y)] if n == 1 else corners[:n]
        solids[i, 0] = side / 2 if n == 1 else 0.0

    bins = list_bins(points, counts, solids, REACH_M, HALF_WIDTH, N_BINS)

    for i, n in enumerate(counts):
        around = np.roll(points[i, :n], -1, axis=0)
        ends = (points[i, :n] + around) / 2 if n > 1 else points[i, :1]
        for x, y in [*points[i, :n], *ends]:
            bearing, gap = math.atan2(y, x), math.hypot(x, y)
            if gap > REACH_M or abs(bearing) > HALF_WIDTH - 0.001 or gap < 2.5:
                continue
            b = math.floor((bearing + HALF_WIDTH) * N_BINS / (2 * HALF_WIDTH))
            near_by = [bins.members[bins.starts[c] : bins.starts[c + 1]] for c in (b,)]
            assert i in near_by[0]
    for b in range(N_BINS):
        near = bins.near[bins.members[bins.starts[b] : bins.starts[b + 1]]]
        assert (np.diff(near) >= 0).all()
        assert (near <= REACH_M).all()
