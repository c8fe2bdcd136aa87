"""Rows of image patches."""

from pathlib import Path

import cv2
import numpy as np

from mpap_cli.outputs.patch_sheet import PatchLine, write_patch_sheet


def test_every_patch_is_on_the_sheet(tmp_path: Path) -> None:
    """Rows of unlike length and patches of unlike size are all drawn, names of any letters."""
    red, blue = (np.full((40, 52, 3), color, np.uint8) for color in ((0, 0, 200), (200, 0, 0)))
    large = np.full((90, 90, 3), (0, 200, 0), np.uint8)
    path = tmp_path / "sheet.png"

    write_patch_sheet(path, [PatchLine("brick " * 9, [red, blue]), PatchLine("\u00e9", [large])])

    image = cv2.imread(str(path))
    assert image is not None
    for color in ((0, 0, 200), (200, 0, 0), (0, 200, 0)):
        assert np.all(image == color, axis=2).sum() > 2000
