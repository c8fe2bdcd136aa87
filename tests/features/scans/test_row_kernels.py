"""The kernels of rows of values equal readable loops, and embedding equals equation 7."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.distance import ZERO_MASS, embed
from mpap_cli.features.scans.rows import _kernels
from mpap_cli.observations import Float32Array, Float64Array


@given(
    gaps=st.lists(st.integers(0, 5), max_size=30),
    window=st.integers(0, 12),
    n_before=st.integers(0, 5),
)
def test_window_minimum_equals_the_search_of_every_window(
    gaps: list[int], window: int, n_before: int
) -> None:
    """The queue finds what a search over all rows of each window finds."""
    stamps = np.cumsum(np.array(gaps, np.int64))
    n_before = min(n_before, len(gaps))
    values = np.random.default_rng(len(gaps)).integers(0, 9, (len(gaps), 3)).astype(np.float64)

    minima = _kernels.window_minimum(stamps, values, n_before, window)

    for i in range(n_before, len(gaps)):
        inside = (stamps >= stamps[i] - window) & (np.arange(len(gaps)) <= i)
        np.testing.assert_array_equal(minima[i - n_before], values[inside].min(axis=0))


def embedded(histograms: Float64Array, root: float) -> tuple[Float32Array, int]:
    """Embed with a column to spare on either side."""
    n_rows, n_bins = histograms.shape
    points = np.full((n_rows, n_bins + 3), 7.0, np.float32)
    n_bad = _kernels.embed_rows(histograms, root, ZERO_MASS, points, 1)
    assert (points[:, [0, -1]] == 7.0).all()
    return points[:, 1:-1], n_bad


@pytest.mark.parametrize("n_bins", [1, 2, 7, 8, 9, 12, 13, 24, 61, 128])
def test_embedding_is_that_of_equation_7_to_the_bit(n_bins: int) -> None:
    """Also of rows that are empty, nearly empty, or hold a single value."""
    rng = np.random.default_rng(n_bins)
    histograms = rng.gamma(0.5, 3.0, (300, n_bins))
    histograms[0], histograms[1], histograms[2, 1:] = 0.0, 1e-14 / n_bins, 0.0

    points, n_bad = embedded(histograms, 0.7)

    assert n_bad == 0
    np.testing.assert_array_equal(points, (0.7 * embed(histograms)).astype(np.float32))


def test_more_bins_than_numpy_sums_at_once_are_embedded_too() -> None:
    """Where the order of a sum is another one, only rounding differs."""
    histograms = np.random.default_rng(0).gamma(0.5, 3.0, (20, 360))

    points, _ = embedded(histograms, 1.0)

    np.testing.assert_allclose(points, embed(histograms), rtol=1e-6)


@pytest.mark.parametrize("bad", [-1e-9, np.nan, np.inf, -np.inf])
def test_values_that_no_histogram_has_are_counted(bad: float) -> None:
    """They are for the caller to refuse."""
    histograms = np.ones((3, 4))
    histograms[1, 2] = histograms[2, 0] = bad

    _, n_bad = embedded(histograms, 1.0)

    assert n_bad == 2


def test_bodies_run_as_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the compiler the kernels give the same values."""
    stamps, rows = np.arange(4), np.array([[3.0], [1.0], [2.0], [4.0]])
    histograms = np.random.default_rng(0).gamma(0.5, 3.0, (5, 11))
    histograms[2] = 0.0
    points, _ = embedded(histograms, 0.5)
    minima = _kernels.window_minimum(stamps, rows, 1, 1)
    for name, kernel in list(vars(_kernels).items()):
        if hasattr(kernel, "py_func"):
            monkeypatch.setattr(_kernels, name, kernel.py_func)

    plain, _ = embedded(histograms, 0.5)

    np.testing.assert_array_equal(plain, points)
    np.testing.assert_array_equal(_kernels.window_minimum(stamps, rows, 1, 1), minima)
