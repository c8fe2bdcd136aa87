"""Equation 7: identities, bounds and the cases where it is not defined."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mpap_cli.distance import MOST_CLUSTERED, distance, embed, similarities, squared_distances
from mpap_cli.errors import SettingError
from mpap_cli.observations import Float64Array

HISTOGRAMS = arrays(
    np.float64, (4, 6), elements=st.floats(0, 1e3).map(lambda x: 0.0 if x < 1e-6 else x)
)


def printed_equation_7(one: Float64Array, two: Float64Array) -> float:
    """Equation 7 exactly as the paper prints it."""
    coefficient = np.sum(np.sqrt(one * two) / np.sqrt(one.sum() * two.sum()))
    return float(np.sqrt(max(0.0, 1 - coefficient)))


@given(HISTOGRAMS)
def test_embedded_histograms_have_length_1(histograms: Float64Array) -> None:
    """Empty or not, an embedded histogram lies on the unit sphere."""
    lengths = np.linalg.norm(embed(histograms), axis=1)

    assert np.allclose(lengths, 1.0)


@given(HISTOGRAMS)
def test_distance_is_equation_7(histograms: Float64Array) -> None:
    """The embedded distance equals the printed formula."""
    one, two = histograms[:2] + 0.01

    found = distance(embed(one), embed(two))

    # the printed form loses half of the digits near zero
    assert found == pytest.approx(printed_equation_7(one, two), abs=1e-7)


@given(HISTOGRAMS)
def test_distance_is_what_opencv_calls_bhattacharyya(histograms: Float64Array) -> None:
    """OpenCV's compareHist gives the same figure."""
    one, two = (histograms[:2] + 0.01).astype(np.float32)

    found = distance(embed(one), embed(two))

    expected = cv2.compareHist(one[:, None], two[:, None], cv2.HISTCMP_BHATTACHARYYA)
    assert found == pytest.approx(expected, abs=1e-3)


@given(HISTOGRAMS)
def test_distance_is_a_metric(histograms: Float64Array) -> None:
    """It is symmetric, in [0, 1], zero for equals and keeps the triangle inequality."""
    u = embed(histograms)

    d = np.sqrt(squared_distances(u, u))

    assert (d == d.T).all()
    assert (np.diagonal(d) == 0).all()
    assert d.max() <= 1 + 1e-12
    assert (d[0, 2] <= d[0, 1] + d[1, 2] + 1e-12).all()


@given(HISTOGRAMS, st.floats(0.01, 100))
def test_distance_forgets_the_scale(histograms: Float64Array, factor: float) -> None:
    """A histogram and a multiple of it are at distance 0, as equation 7 has it."""
    histogram = histograms[0] + 0.01

    found = distance(embed(histogram), embed(factor * histogram))

    assert found == pytest.approx(0.0, abs=1e-7)


def test_empty_histograms_are_alike_and_far_from_all_others() -> None:
    """The zero coordinate makes d(0, 0) = 0 and d(0, other) = 1."""
    u = embed([[0.0, 0.0], [0.0, 0.0], [1.0, 2.0]])

    squared = squared_distances(u, u)

    assert squared[0].tolist() == [0.0, 0.0, pytest.approx(1.0)]


def test_mass_below_1e12_is_empty() -> None:
    """Rounding dust is no histogram."""
    assert embed([1e-13, 0.0]).tolist() == [0.0, 0.0, 1.0]
    assert embed([1e-11, 0.0]).tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_values_without_meaning_are_an_error(bad: float) -> None:
    """Negative and infinite values are not clipped in silence."""
    with pytest.raises(ValueError, match="1 of 2 values are negative or not finite"):
        embed([1.0, bad])


def test_embed_keeps_float32_and_leading_axes() -> None:
    """float32 stays float32, all else becomes float64, blocks stay blocks."""
    block = np.ones((2, 3, 4), np.float32)

    assert embed(block).dtype == np.float32
    assert embed(block).shape == (2, 3, 5)
    assert embed(np.ones((3, 4), np.int64)).dtype == np.float64


def test_euclidean_points_have_no_factor() -> None:
    """Points that are not normalized keep their plain squared distances."""
    points = np.array([[0.0, 0.0], [3.0, 4.0]])

    squared = squared_distances(points[:1], points, normalized=False)

    assert squared.tolist() == [[0.0, 25.0]]


def test_similarities_fall_with_distance() -> None:
    """One rule takes -d^2, the other -d."""
    points = np.array([[0.0, 0.0], [3.0, 4.0]])

    assert similarities(points, normalized=False).tolist() == [[0.0, -25.0], [-25.0, 0.0]]
    assert similarities(points, "neg-distance", normalized=False)[0, 1] == -5.0


def test_arguments_stay_as_they_are() -> None:
    """No function writes into what it is given."""
    histograms = np.array([[1.0, 2.0], [0.0, 0.0]])
    before = histograms.copy()

    u = embed(histograms)
    kept = u.copy()
    similarities(u)

    assert (histograms == before).all()
    assert (u == kept).all()


def test_many_points_have_the_same_distances_as_few() -> None:
    """The way for large sets gives the same bits as the one for small sets."""
    points = np.random.default_rng(0).random((300, 18)).astype(np.float32)

    many = squared_distances(points, points)

    few = [squared_distances(points[row : row + 1], points) for row in range(len(points))]
    assert (many == np.concatenate(few)).all()


def test_more_points_than_memory_takes_pairs_of_are_refused() -> None:
    """One line with what to change, before any memory is taken."""
    points = np.zeros((MOST_CLUSTERED + 1, 1), np.float32)

    with pytest.raises(SettingError, match=r"found 20,001 points, .* make theta .* larger"):
        similarities(points)
