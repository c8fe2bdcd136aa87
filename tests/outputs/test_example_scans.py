"""Scans with and without a collision."""

import math
from pathlib import Path

import cv2
import numpy as np

from mpap_cli.observations import ScanGeometry
from mpap_cli.outputs.canvas import probability_color
from mpap_cli.outputs.example_scans import ExampleScan, write_example_scans

GEOMETRY = ScanGeometry(180, -math.pi / 2, math.pi / 180, 0.02, 8.0)
GREEN = np.full((48, 64, 3), (0, 200, 0), np.uint8)


def example(*, in_contact: bool, with_image: bool = False) -> ExampleScan:
    """Return a scan of a wall all round."""
    return ExampleScan(
        time_s=3.0,
        in_contact=in_contact,
        ranges=np.full(180, 2.0, np.float32),
        geometry=GEOMETRY,
        forward_rad=0.0,
        range_max=None,
        image=GREEN if with_image else None,
    )


def shows(path: Path, color: tuple[int, int, int]) -> bool:
    """Tell whether a picture holds a color."""
    image = cv2.imread(str(path))
    assert image is not None
    return bool(np.all(image == color, axis=2).any())


def test_contact_has_its_color_and_the_image_stands_beside(tmp_path: Path) -> None:
    """Blue without, vermilion with a collision; an image where there is one."""
    clear, hit = tmp_path / "clear.png", tmp_path / "hit.png"

    write_example_scans(clear, [example(in_contact=False)])
    write_example_scans(hit, [example(in_contact=True, with_image=True)])

    blue, vermilion = probability_color(0.0), probability_color(1.0)
    assert (shows(clear, blue), shows(clear, vermilion), shows(clear, (0, 200, 0))) == (
        True,
        False,
        False,
    )
    assert (shows(hit, blue), shows(hit, vermilion), shows(hit, (0, 200, 0))) == (False, True, True)


def test_a_log_without_scans_gives_a_page_that_says_so(tmp_path: Path) -> None:
    """No example is no error."""
    write_example_scans(tmp_path / "empty.png", [])

    assert (tmp_path / "empty.png").stat().st_size > 0
