"""The fast search finds what comparing all finds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.distance import squared_distances
from mpap_cli.observations import Float32Array
from mpap_cli.systems import _kernels, nearest
from mpap_cli.systems.nearest import nearest_exemplars


def points_of(n: int, random: np.random.Generator) -> Float32Array:
    """Return points of length 1."""
    points = random.normal(size=(n, 5)).astype(np.float32)
    unit: Float32Array = points / np.linalg.norm(points, axis=1, keepdims=True)
    return unit


@given(st.integers(0, 99), st.integers(1, 12), st.integers(0, 60), st.sampled_from([0.0, 1e-7, 1]))
def test_neighbors_are_those_of_the_plain_search(seed: int, k: int, f: int, spread: float) -> None:
    """Also among exemplars that are equal, or that a float32 product cannot tell apart."""
    random = np.random.default_rng(seed)
    kinds = points_of(4, random)[random.integers(0, 4, size=f)]
    exemplars = (kinds + spread * random.normal(size=(f, 5))).astype(np.float32)
    exemplars /= np.linalg.norm(exemplars, axis=1, keepdims=True).astype(np.float32)
    points = np.concatenate([points_of(5, random), exemplars[:3]])

    rows, squared = nearest_exemplars(points, exemplars, k)

    if f == 0:
        assert (rows == -1).all()
        assert np.isinf(squared).all()
        return
    every = squared_distances(points, exemplars)
    wanted = np.argsort(every, axis=1, kind="stable")[:, :k]
    exact = np.take_along_axis(every, wanted, axis=1)
    np.testing.assert_allclose(squared, exact, rtol=1e-12, atol=1e-15)
    same = rows == wanted
    # sums of squares that differ in the last digit may come in the other order
    np.testing.assert_allclose(squared[~same], exact[~same], rtol=1e-12, atol=1e-15)
    assert all(len(set(found)) == len(found) for found in rows.tolist())


def test_the_size_of_the_pieces_does_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Memory is bounded by searching for a few points at a time."""
    random = np.random.default_rng(1)
    points, exemplars = points_of(50, random), points_of(40, random)
    rows, squared = nearest_exemplars(points, exemplars, 3)
    monkeypatch.setattr(nearest, "_MOST_DISTANCES", 1)

    again, exact = nearest_exemplars(points, exemplars, 3)

    assert again.tolist() == rows.tolist()
    np.testing.assert_allclose(exact, squared, rtol=1e-14)


def test_no_points_have_no_neighbors() -> None:
    """An empty block stays empty."""
    rows, squared = nearest_exemplars(np.zeros((0, 5), np.float32), np.eye(5, dtype=np.float32), 2)

    assert (rows.shape, squared.shape) == ((0, 2), (0, 2))


def test_the_kernel_is_plain_python_too() -> None:
    """Not compiled it finds the same."""
    random = np.random.default_rng(2)
    points, exemplars = points_of(4, random), points_of(9, random)
    rows, squared = np.empty((4, 3), np.int64), np.empty((4, 3))
    closeness = points @ exemplars.T

    _kernels._find_several.py_func(points, exemplars, closeness, np.float32(1), rows, squared)

    wanted, exact = nearest_exemplars(points, exemplars, 3)
    assert rows.tolist() == wanted.tolist()
    np.testing.assert_allclose(squared, exact, rtol=1e-12)
