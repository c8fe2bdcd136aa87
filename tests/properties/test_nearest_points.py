"""The nearest of many points: the distances of all of them are the reference."""

import numpy as np
import pytest

from mpap_cli.distance import embed, squared_distances
from mpap_cli.observations import Float64Array
from mpap_cli.properties.nearest_points import NearestPoints


def _points(n: int, seed: int, bins: int = 12) -> Float64Array:
    """Return embedded histograms."""
    histograms = np.random.default_rng(seed).dirichlet(np.full(bins, 0.4), n)
    return np.asarray(embed(histograms), np.float64)


@pytest.mark.parametrize("n", [1, 63, 64, 65, 700, 9000])
def test_distances_are_those_of_a_full_search_to_the_last_bit(n: int) -> None:
    """Whatever is ruled out, the bytes are those of the smallest of all distances."""
    references, points = _points(n, seed=1), _points(300, seed=2)

    least = NearestPoints(references).least_squared(points)

    assert least.tobytes() == squared_distances(points, references).min(axis=1).tobytes()


def test_points_that_nearly_coincide_are_told_apart_in_float64() -> None:
    """Differences below the precision of float32 count."""
    points = _points(50, seed=3)
    references = np.concatenate([points * (1 + shift) for shift in (3e-9, 1e-9, 2e-9)])

    least = NearestPoints(references).least_squared(points)

    assert least.tobytes() == squared_distances(points, references).min(axis=1).tobytes()
    assert (least > 0).all()


def test_points_of_any_length_are_found() -> None:
    """Means need not be of length 1."""
    references, points = 30.0 * _points(500, seed=4), _points(100, seed=5).astype(np.float32)

    least = NearestPoints(references).least_squared(points)

    assert least.tobytes() == squared_distances(points, references).min(axis=1).tobytes()


@pytest.mark.parametrize(("n", "m"), [(0, 3), (5, 0), (0, 0)])
def test_without_points_nothing_is_near(n: int, m: int) -> None:
    """No reference is infinitely far away; no point has no distance."""
    least = NearestPoints(_points(9, seed=6)[:n]).least_squared(_points(9, seed=7)[:m])

    assert least.tolist() == [np.inf] * m
