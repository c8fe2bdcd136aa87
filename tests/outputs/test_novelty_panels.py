"""Environments side by side."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from mpap_cli.outputs.novelty_panels import NoveltyPanel, plot_novelty_panels
from tests.outputs.novelty_windows import windows

BLUE, VERMILION = (178, 114, 0), (0, 94, 213)


def draw(path: Path, *panels: NoveltyPanel) -> NDArray[np.uint8]:
    """Draw panels and read the picture."""
    plot_novelty_panels(path, panels)
    image = cv2.imread(str(path))
    assert image is not None
    return np.asarray(image, np.uint8)


def heights(image: NDArray[np.uint8], color: tuple[int, int, int], side: str) -> NDArray[np.int64]:
    """Return the rows above the legend in which a color is found in one of two panels."""
    height, width = (int(share * n) for share, n in zip((0.8, 0.45), image.shape[:2], strict=True))
    part = image[:height, :width] if side == "left" else image[:height, -width:]
    return np.asarray(np.nonzero((part == color).all(axis=2))[0])


def test_each_panel_has_its_own_curve_on_one_scale(tmp_path: Path) -> None:
    """What is more novel is drawn higher; the second label has the second color."""
    high = NoveltyPanel("Indoor", (("robust", windows(90, 90)), ("paper", windows(50, 50))))
    low = NoveltyPanel("Out$door_", (("robust", windows(10, 10)), ("paper", windows(60, 60))))

    image = draw(tmp_path / "a.png", high, low)

    top, below = heights(image, BLUE, "left"), heights(image, BLUE, "right")
    assert top.size > 100
    assert below.size > 100
    assert top.max() < below.min()
    middles = [heights(image, VERMILION, side).max() for side in ("left", "right")]
    assert middles[1] < middles[0]


def test_panels_make_a_picture_wider(tmp_path: Path) -> None:
    """Three panels take three times the room of one, but for the margin."""
    panel = NoveltyPanel("A", (("robust", windows(20)),))

    one, three = draw(tmp_path / "a.png", panel), draw(tmp_path / "b.png", panel, panel, panel)

    assert three.shape[1] - one.shape[1] == 2 * 600


def test_the_same_numbers_give_the_same_bytes(tmp_path: Path) -> None:
    """Also where nothing was observed."""
    panels = [
        NoveltyPanel("A", (("robust", windows(20, 5)),)),
        NoveltyPanel("B", (("robust", ()),)),
    ]

    for name in ("a.png", "b.png"):
        plot_novelty_panels(tmp_path / name, panels)

    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
