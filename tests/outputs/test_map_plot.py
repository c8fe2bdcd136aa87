"""Map of a log with patches beside it."""

import math
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.observations import NS_PER_S, PoseBlock, ScanBlock, ScanGeometry
from mpap_cli.outputs.map_plot import MOST_PATCHES, MapPatch, _sides, _unbroken, plot_map
from mpap_cli.outputs.map_sketch import MapSketch
from mpap_cli.params import ScanParams


def sketch(*, scans: bool = True) -> MapSketch:
    """Drive four metres along a line."""
    drawn = MapSketch(ScanParams(), 0.0)
    stamps_ns = np.arange(40) * (NS_PER_S // 10)
    drawn.add_poses(PoseBlock(stamps_ns, np.outer(np.arange(40) / 10, (1.0, 0.5, 0.0))))
    if scans:
        ranges = np.full((40, 90), 1.5, np.float32)
        geometry = ScanGeometry(90, -1.5, 0.033, 0.1, 8.0)
        drawn.add_scans(ScanBlock(stamps_ns, ranges, geometry))
    return drawn


def patches(n: int) -> list[MapPatch]:
    """Make patches of one color each, seen along the way."""
    probabilities = [0.9, 0.1, math.nan]
    return [
        MapPatch(
            x_m=index / 5,
            y_m=index % 3,
            picture=np.full((40, 53, 3), 17 * index % 255, np.uint8),
            p_obstacle=probabilities[index % 3],
        )
        for index in range(n)
    ]


NOWHERE = MapPatch(math.nan, math.nan, np.zeros((40, 53, 3), np.uint8), 0.5)
DRAWINGS: dict[str, Callable[[Path], None]] = {
    "map": lambda path: plot_map(path, sketch(), patches(9), title="_$a.bag"),
    "too many patches": lambda path: plot_map(path, sketch(), patches(30)),
    "no patch": lambda path: plot_map(path, sketch(scans=False), [NOWHERE]),
    "no odometry": lambda path: plot_map(path, MapSketch(ScanParams(), 0.0), []),
}


@pytest.mark.parametrize("name", DRAWINGS)
def test_same_log_same_bytes(tmp_path: Path, name: str) -> None:
    """Every map is drawn, twice with the same bytes."""
    DRAWINGS[name](tmp_path / "a.png")
    DRAWINGS[name](tmp_path / "b.png")

    content = (tmp_path / "a.png").read_bytes()
    assert content == (tmp_path / "b.png").read_bytes()
    assert content.startswith(b"\x89PNG")


def test_patches_are_framed_by_what_they_are(tmp_path: Path) -> None:
    """An obstacle in vermilion, what is none in green; the threshold parts them."""
    one = [MapPatch(1.0, 1.0, np.full((40, 53, 3), 255, np.uint8), 0.4)]
    plot_map(tmp_path / "free.png", sketch(), one)
    plot_map(tmp_path / "obstacle.png", sketch(), one, threshold=0.4)

    free, obstacle = (cv2.imread(str(tmp_path / f"{name}.png")) for name in ("free", "obstacle"))

    assert free is not None
    assert obstacle is not None
    vermilion, green = (0, 0x5E, 0xD5), (0x73, 0x9E, 0)
    for image, there, away in ((free, green, vermilion), (obstacle, vermilion, green)):
        assert np.sum((image == there).all(axis=2)) > 500
        assert not (image == away).all(axis=2).any()


def test_patches_lie_on_the_side_where_they_were_seen() -> None:
    """The left half left, each side from the top down, no more than fit."""
    left, right = _sides(patches(MOST_PATCHES))

    assert len(left) == len(right) == MOST_PATCHES // 2
    assert max(patch.x_m for patch in left) <= min(patch.x_m for patch in right)
    for side in (left, right):
        heights = [patch.y_m for patch in side]
        assert heights == sorted(heights, reverse=True)


def test_way_breaks_where_the_odometry_began_anew() -> None:
    """A jump of metres is not driven."""
    way = np.array([[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0], [9, 9, 0], [9.1, 9, 0]])

    places = _unbroken(way)

    assert np.flatnonzero(np.isnan(places[:, 0])).tolist() == [3]
    assert _unbroken(way[:1]).tolist() == [[0, 0]]
