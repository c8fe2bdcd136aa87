"""Curves over one range: they rise, they follow the counts, they join by log odds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.isotonic import IsotonicRegression

from mpap_cli.distance import embed
from mpap_cli.observations import Float64Array
from mpap_cli.properties.kernel import Kernel
from mpap_cli.properties.range_curves import (
    N_ANGLES,
    block_angles,
    join,
    read_range_curve,
    rising,
)

KERNEL = Kernel(theta=0.08, neighbors=20, prior_counts=2.0)


def angles_of(ranges_m: list[float]) -> Float64Array:
    """Return the angles of blocks of one range between 0.2 and 1 m."""
    inverse = [1 / r for r in ranges_m]
    return block_angles(embed([[near, 5.0 - near] for near in inverse]), 0)


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(0.1, 9)), min_size=1, max_size=30))
def test_rising_is_isotonic_regression(points: list[tuple[float, float]]) -> None:
    """Pools of neighbors are those of scikit-learn."""
    values, weights = np.array(points).T

    found = rising(values, weights)

    wanted = (
        IsotonicRegression()
        .fit(np.arange(values.size), values, weights)
        .predict(np.arange(values.size))
    )
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    assert (np.diff(found) >= 0).all()


def test_nearer_is_never_less_probable() -> None:
    """Contacts at half a metre count for every nearer range, also for those never seen."""
    angles = angles_of([0.3, 0.4, 0.5, 0.6, 0.9])
    counts = np.array([[50, 0], [50, 0], [20, 60], [50, 0], [500, 0]])
    at = angles_of([0.21, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9, 0.99])

    p = read_range_curve(at, angles, counts, 0.04, KERNEL)

    assert (np.diff(p) <= 0).all()
    assert p[0] == p[1]
    assert p[3] > 3 * p[5]
    assert p[6] == p[7] < 0.04


def test_a_curve_is_the_kernel_mean_of_all_counts() -> None:
    """Where the counts rise by themselves nothing is pooled."""
    angles, counts = angles_of([0.25, 0.9]), np.array([[10, 30], [400, 4]])
    base_rate = 34 / 444

    found = read_range_curve(angles, angles, counts, base_rate, KERNEL)

    between = 1 - np.cos(angles[0] - angles[1])
    weight = np.exp(-between / (2 * 0.08**2))
    for i, other in ((0, 1), (1, 0)):
        both = counts[i] + weight * counts[other]
        assert found[i] == pytest.approx((both[1] + 2 * base_rate) / (both.sum() + 2))


def test_one_reference_makes_a_flat_curve() -> None:
    """All angles of the grid are the same then."""
    angles = angles_of([0.5])

    p = read_range_curve(angles_of([0.25, 0.5, 0.9]), angles, np.array([[1, 1]]), 0.5, KERNEL)

    assert p.tolist() == pytest.approx([0.5] * 3)
    assert N_ANGLES > 1


@given(
    p=st.floats(0.001, 0.999),
    curves=st.lists(st.floats(0.001, 0.999), min_size=1, max_size=3),
    share=st.floats(0, 1),
)
def test_joined_odds_are_the_weighted_geometric_mean(
    p: float, curves: list[float], share: float
) -> None:
    """The curves share their weight; what joins lies between what is joined."""
    found = join(np.array([p]), [np.array([curve]) for curve in curves], share)[0]

    odds = np.array([p, *curves]) / (1 - np.array([p, *curves]))
    weights = np.array([1 - share, *[share / len(curves)] * len(curves)])
    joined = np.exp(weights @ np.log(odds))
    assert found == pytest.approx(joined / (1 + joined))
    assert min(p, *curves) - 1e-12 <= found <= max(p, *curves) + 1e-12
