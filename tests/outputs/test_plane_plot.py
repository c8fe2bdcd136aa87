"""Clusterings of points in the plane."""

from pathlib import Path

import cv2
import numpy as np

from mpap_cli.outputs.plane_plot import Plane, plot_planes

POINTS = np.array([[0.0, 0.0], [1.0, 0.0], [9.0, 9.0]])
LABELS = np.array([0, 0, -1])


def drawn(path: Path, plane: Plane) -> bytes:
    """Return the picture of one plane."""
    plot_planes(path, [plane])
    return path.read_bytes()


def test_planes_are_drawn_two_in_a_row(tmp_path: Path) -> None:
    """Three panels take two rows, and the picture is in color."""
    path = tmp_path / "planes.png"

    plot_planes(path, [Plane(name, POINTS, LABELS) for name in ("$a", "_b", "c")])

    image = cv2.imread(str(path))
    assert image is not None
    assert image.shape[0] > image.shape[1] * 0.9
    assert (image.max(axis=2) != image.min(axis=2)).any()


def test_meta_points_are_drawn_as_circles(tmp_path: Path) -> None:
    """The same points look other with meta-points; the same panel has the same bytes."""
    bare = Plane("a", POINTS, LABELS)
    circled = Plane("a", POINTS, LABELS, np.array([[0.5, 0.0]]), radius=2.0)

    without, with_them = drawn(tmp_path / "1.png", bare), drawn(tmp_path / "2.png", circled)

    assert without != with_them
    assert drawn(tmp_path / "3.png", circled) == with_them
