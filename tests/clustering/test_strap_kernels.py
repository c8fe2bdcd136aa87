"""The compiled search for the nearest exemplar, against a plain one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.clustering.strap_rows import _kernels
from mpap_cli.clustering.strap_rows.arrays import single_items
from mpap_cli.distance import embed
from mpap_cli.observations import Float32Array, Float64Array, IntArray


def plain_nearest(points: Float32Array, exemplars: Float32Array) -> tuple[IntArray, Float64Array]:
    """All squared distances, summed from the first coordinate to the last."""
    squared = np.zeros((len(points), len(exemplars)))
    for u, e in zip(points.T.astype(np.float64), exemplars.T.astype(np.float64), strict=True):
        squared += np.square(u[:, None] - e)
    return squared.argmin(axis=1), 0.5 * squared.min(axis=1)


def assert_same(points: Float32Array, exemplars: Float32Array) -> None:
    """Rows and distances are equal, bit for bit."""
    rows, squared = _kernels.nearest(points, exemplars)

    expected_rows, expected = plain_nearest(points, exemplars)
    assert rows.tolist() == expected_rows.tolist()
    assert squared.tolist() == expected.tolist()


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1, 2, 15, 16, 17, 40, 100]),
    st.sampled_from([1, 3, 4, 19, 109]),
    st.sampled_from([2, 1000]),
)
def test_the_nearest_exemplar_is_found(seed: int, k: int, d: int, levels: int) -> None:
    """Also among copies, where the first of equals counts."""
    rng = np.random.default_rng(seed)
    points = embed(rng.integers(0, levels, (60, d)).astype(np.float32)).astype(np.float32)
    exemplars = points[rng.integers(0, 50, k)]

    assert_same(points, exemplars)


@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-8, 1e-7, 1e-6, 1e-5, 1e-4]))
def test_float32_never_decides(seed: int, scale: float) -> None:
    """Exemplars that differ by less than a float32 product can tell."""
    rng = np.random.default_rng(seed)
    center = rng.dirichlet(np.ones(40))
    exemplars = embed(np.abs(center + scale * rng.normal(size=(50, 40)))).astype(np.float32)
    points = embed(np.abs(center + 0.01 * rng.normal(size=(30, 40)))).astype(np.float32)

    assert_same(points, exemplars)


def test_chunks_of_the_product_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seven points a time, or all at once."""
    rng = np.random.default_rng(0)
    points = embed(rng.gamma(0.4, size=(200, 30))).astype(np.float32)
    at_once = _kernels.nearest(points, points[:20])

    monkeypatch.setattr(_kernels, "_CHUNK_BYTES", 4 * 20 * 7)
    in_chunks = _kernels.nearest(points, points[:20])

    assert at_once[0].tolist() == in_chunks[0].tolist()
    assert at_once[1].tolist() == in_chunks[1].tolist()


def test_no_points_no_rows() -> None:
    """An empty block is fine."""
    rows, squared = _kernels.nearest(np.zeros((0, 3), np.float32), np.eye(3, dtype=np.float32))

    assert (rows.size, squared.size) == (0, 0)


@pytest.mark.parametrize("window_ns", [0.0, 10.0])
def test_kernels_run_as_plain_python(window_ns: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The loops mean the same without compilation."""
    rng = np.random.default_rng(1)
    points = embed(rng.gamma(0.4, size=(20, 7))).astype(np.float32)
    exemplars, nothing = points[:19], np.zeros(19, np.int64)
    compiled, plain = (
        single_items(exemplars, np.arange(19), nothing, nothing, log_index=0) for _ in range(2)
    )
    rows, squared = _kernels.nearest(points, exemplars)
    stamps = np.arange(20)[::-1].copy()
    _kernels.absorb(compiled, rows, squared, stamps, window_ns)
    for name, kernel in list(vars(_kernels).items()):
        if hasattr(kernel, "py_func"):
            monkeypatch.setattr(_kernels, name, kernel.py_func)

    again = _kernels.nearest(points, exemplars)
    _kernels.absorb(plain, *again, stamps, window_ns)

    assert again[0].tolist() == rows.tolist()
    assert again[1].tolist() == squared.tolist()
    for name in compiled._fields:
        assert getattr(plain, name).tolist() == getattr(compiled, name).tolist(), name
