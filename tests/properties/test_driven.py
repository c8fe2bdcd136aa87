"""How far the robot gets ahead."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.observations import NS_PER_S, PoseBlock
from mpap_cli.properties.driven import driven_ahead

TENTH_NS = NS_PER_S // 10
POSE = st.tuples(
    st.sampled_from([0, 1, 2, 11]),
    st.floats(-3, 3, allow_subnormal=False),
    st.floats(-3, 3, allow_subnormal=False),
    st.floats(-7, 7, allow_subnormal=False),
)


def reference(stamp_ns: int, poses: PoseBlock, within_ns: int) -> float:
    """Go through the poses one after the other."""
    before = [row for row, at_ns in enumerate(poses.stamps_ns) if at_ns <= stamp_ns]
    if not before or stamp_ns - poses.stamps_ns[before[-1]] > NS_PER_S:
        return math.nan
    x, y, heading = poses.poses[before[-1]]
    ahead = 0.0
    for at_ns, (to_x, to_y, _) in zip(poses.stamps_ns, poses.poses, strict=True):
        if stamp_ns < at_ns <= stamp_ns + within_ns:
            way = (to_x - x) * math.cos(heading) + (to_y - y) * math.sin(heading)
            ahead = max(ahead, way)
    return ahead


@given(st.lists(POSE, max_size=20), st.lists(st.integers(-5, 80), max_size=12))
def test_the_way_ahead_equals_that_of_the_definition(
    rows: list[tuple[int, float, float, float]], tenths: list[int]
) -> None:
    """For moments in any order, before, between and after the poses."""
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    poses = PoseBlock(np.cumsum(table[:, 0].astype(np.int64)) * TENTH_NS, table[:, 1:])
    stamps_ns = np.array(tenths, dtype=np.int64) * TENTH_NS

    driven = driven_ahead(stamps_ns, poses, within_s=2.0)

    wanted = [reference(int(stamp_ns), poses, 2 * NS_PER_S) for stamp_ns in stamps_ns]
    np.testing.assert_allclose(driven, wanted, atol=1e-12)


def test_turning_and_driving_elsewhere_is_not_ahead() -> None:
    """What the camera saw at first lies beside the way."""
    poses = PoseBlock(
        np.arange(3, dtype=np.int64) * NS_PER_S,
        np.array([[1.0, 1.0, 0.0], [1.0, 1.0, math.pi / 2], [1.0, 3.0, math.pi / 2]]),
    )

    driven = driven_ahead(poses.stamps_ns, poses, within_s=5.0)

    np.testing.assert_allclose(driven, [0.0, 2.0, 0.0], atol=1e-12)
