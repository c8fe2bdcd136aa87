"""Truth about images: shares of patches, and the way that is free."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import OutputError
from mpap_cli.simulation.camera_truth import (
    CameraTruth,
    Sight,
    cell_edges,
    free_ahead,
    kind_shares,
    material_counts,
)
from mpap_cli.simulation.palettes import NAMES
from mpap_cli.simulation.shapes import Shapes

RADIUS_M = 0.2
NO_CIRCLES = np.empty((0, 3))
NO_SEGMENTS = np.empty((0, 4))


@given(st.integers(6, 2048), st.integers(1, 6))
def test_cells_are_equal_and_what_is_left_is_split(n_pixels: int, n_cells: int) -> None:
    """Cells have whole, equal sides; margins differ by at most one pixel."""
    edges = cell_edges(n_pixels, n_cells)

    assert set(np.diff(edges)) == {n_pixels // n_cells}
    assert 0 <= (n_pixels - edges[-1]) - edges[0] <= 1


def test_shares_are_of_floor_wall_and_the_rest() -> None:
    """A patch half floor, a quarter wall, a quarter box; shares add up to one."""
    labels = np.full((60, 60), NAMES.index("floor"), np.uint8)
    labels[:10, 5:10] = NAMES.index("box")
    labels[:5, 5:10] = NAMES.index("wall")
    labels[10:20] = NAMES.index("floor2")
    labels[20:30] = NAMES.index("foot")

    shares = kind_shares(material_counts(labels))

    assert shares.shape == (36, 3)
    assert shares[0].tolist() == [0.5, 0.25, 0.25]
    assert shares[6].tolist() == [1.0, 0.0, 0.0]
    assert shares[12].tolist() == [0.0, 0.0, 1.0]
    np.testing.assert_allclose(shares.sum(axis=1), 1)


@pytest.mark.parametrize(
    ("segment", "expected_m"),
    [
        ((1.0, -1.0, 1.0, 1.0), 0.8),
        ((1.0, 0.19, 1.0, 3.0), 0.8),
        ((1.0, 0.21, 1.0, 3.0), math.inf),
        ((-1.0, -1.0, -1.0, 1.0), math.inf),
        ((1.0, 0.0, 2.0, 0.0), 0.8),
        ((2.0, -1.0, 1.0, 1.0), 1.2),
        ((-1.0, 0.1, 1.0, 0.1), 0.0),
        ((0.1, -1.0, 0.1, 1.0), 0.0),
    ],
)
def test_free_way_ends_at_the_first_wall_in_the_corridor(
    segment: tuple[float, float, float, float], expected_m: float
) -> None:
    """The corridor is as wide as the robot; distances count from its front."""
    solid = Shapes(np.array([segment]), NO_CIRCLES)

    assert free_ahead(solid, np.zeros(3), RADIUS_M) == pytest.approx(expected_m)


@pytest.mark.parametrize(
    ("circle", "expected_m"),
    [
        ((1.0, 0.0, 0.1), 0.7),
        ((1.0, 0.3, 0.5), 1.0 - math.sqrt(0.5**2 - 0.1**2) - 0.2),
        ((1.0, 0.35, 0.1), math.inf),
        ((-1.0, 0.0, 0.1), math.inf),
    ],
)
def test_free_way_ends_at_the_first_round_thing(
    circle: tuple[float, float, float], expected_m: float
) -> None:
    """Round things that reach into the corridor end it where they do."""
    solid = Shapes(NO_SEGMENTS, np.array([circle]))

    assert free_ahead(solid, np.zeros(3), RADIUS_M) == pytest.approx(expected_m)


def test_free_way_turns_with_the_robot() -> None:
    """A robot that faces up the y axis meets what is there."""
    solid = Shapes(np.array([[-1.0, 3.0, 1.0, 3.0]]), np.array([[0.0, 5.0, 0.5]]))

    assert free_ahead(solid, np.array((0.0, 1.0, math.pi / 2)), RADIUS_M) == pytest.approx(1.8)


def test_tables_have_a_row_per_patch_and_per_image(tmp_path: Path) -> None:
    """Rows are written in order, with four decimals and millimetres."""
    patches, images = tmp_path / "p.csv", tmp_path / "i.csv"
    shares = np.full((36, 3), (0.5, 0.25, 0.25))

    with CameraTruth("day.mcap", patches, images) as truth:
        truth.add(7, Sight(shares, 1.23456))

    lines = patches.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "log,stamp_ns,row,column,floor,wall,obstacle"
    assert lines[8] == "day.mcap,7,1,1,0.5000,0.2500,0.2500"
    assert len(lines) == 37
    assert images.read_text(encoding="utf-8") == "log,stamp_ns,free_ahead_m\nday.mcap,7,1.235\n"


def test_tables_vanish_after_an_error(tmp_path: Path) -> None:
    """What was written in vain is removed; the error goes on."""
    tables = (tmp_path / "p.csv", tmp_path / "i.csv")

    with pytest.raises(KeyError), CameraTruth("day.mcap", *tables):
        raise KeyError

    assert list(tmp_path.iterdir()) == []


def test_tables_that_cannot_be_written_are_told(tmp_path: Path) -> None:
    """A folder that is not there is named, and nothing is left."""
    tables = (tmp_path / "p.csv", tmp_path / "none" / "i.csv")

    with (
        pytest.raises(OutputError, match=r"i\.csv: cannot be written"),
        CameraTruth("day.mcap", *tables),
    ):
        pass

    assert list(tmp_path.iterdir()) == []
