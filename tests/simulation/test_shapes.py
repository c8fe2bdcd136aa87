"""The nearest shape is found as by looking at each one."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mpap_cli.simulation.shapes import Shapes

NO_SEGMENTS, NO_CIRCLES = np.empty((0, 4)), np.empty((0, 3))
coordinate = st.floats(-5, 5).map(lambda value: round(value, 3))


def gap_to_segment(x: float, y: float, segment: tuple[float, ...]) -> float:
    """Return the distance to a segment, found among 2,001 of its points."""
    x0, y0, x1, y1 = segment
    shares = np.linspace(0, 1, 2001)
    return float(np.hypot(x0 + shares * (x1 - x0) - x, y0 + shares * (y1 - y0) - y).min())


@given(
    point=st.tuples(coordinate, coordinate),
    segments=st.lists(st.tuples(*[coordinate] * 4), max_size=4),
    circles=st.lists(st.tuples(coordinate, coordinate, st.floats(0.01, 2)), min_size=1, max_size=4),
)
def test_nearest_is_the_least_of_all_distances(
    point: tuple[float, float],
    segments: list[tuple[float, ...]],
    circles: list[tuple[float, ...]],
) -> None:
    """No shape is nearer than the one returned, and it is that far away."""
    # in the very center of a circle no side is nearer than the others
    assume(all(math.dist(point, circle[:2]) > 1e-3 for circle in circles))
    shapes = Shapes(np.array(segments, float).reshape(-1, 4), np.array(circles))

    nearest = shapes.nearest(*point)

    gaps = [gap_to_segment(*point, segment) for segment in segments]
    gaps += [math.dist(point, circle[:2]) - circle[2] for circle in circles]
    assert nearest.distance_m == pytest.approx(min(gaps), abs=4e-3)
    assert gaps[nearest.index] == pytest.approx(min(gaps), abs=4e-3)
    touched = math.dist(point, (nearest.x, nearest.y))
    assert touched == pytest.approx(abs(nearest.distance_m), abs=1e-6)


def test_a_point_stands_for_a_segment_without_length() -> None:
    """A segment whose ends are one point is that point."""
    shapes = Shapes(np.array([[1.0, 1.0, 1.0, 1.0]]), NO_CIRCLES)

    nearest = shapes.nearest(1.0, 3.0)

    assert nearest.distance_m == 2.0


def test_nothing_is_infinitely_far() -> None:
    """Without shapes there is no nearest one."""
    shapes = Shapes(NO_SEGMENTS, NO_CIRCLES)

    nearest = shapes.nearest(0.0, 0.0)

    assert (nearest.index, nearest.distance_m) == (-1, math.inf)
    assert len(shapes) == 0


def test_shapes_keep_no_hold_of_what_they_were_made_from() -> None:
    """Changing the arrays afterwards changes no shape."""
    segments = np.array([[0.0, 1.0, 1.0, 1.0]])
    shapes = Shapes(segments, NO_CIRCLES)

    segments[:] = 9.0

    assert shapes.nearest(0.5, 0.0).distance_m == 1.0
