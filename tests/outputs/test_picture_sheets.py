"""Pictures put together on one sheet."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.errors import OutputError
from mpap_cli.outputs.canvas import Image, blank, write_png
from mpap_cli.outputs.picture_sheets import join_pictures, write_rows


def plain(color: tuple[int, int, int], width: int = 64, height: int = 48) -> Image:
    """Return a picture of one color."""
    return np.full((height, width, 3), color, np.uint8)


def read(path: Path) -> Image:
    """Read a picture back."""
    image = cv2.imread(str(path))
    assert image is not None
    return np.asarray(image, np.uint8)


def test_rows_stand_below_one_another(tmp_path: Path) -> None:
    """Each picture fills its field, from left to right after the name."""
    red, blue = (0, 0, 200), (200, 0, 0)

    write_rows(
        tmp_path / "a.png", [("A", "day", [plain(red), plain(blue)]), ("B", "", [plain(blue)])]
    )

    sheet = read(tmp_path / "a.png")
    assert sheet.shape == (2 * 26 + 2 * 192 + 10, 2 * 26 + 150 + 2 * 256 + 10, 3)
    centers = [
        sheet[26 + 96 + 202 * row, 176 + 128 + 266 * column]
        for row, column in ((0, 0), (0, 1), (1, 0))
    ]
    assert [tuple(color.tolist()) for color in centers] == [red, blue, blue]
    assert (sheet[26 + 202 :, 176 + 266 :] == 255).all()
    assert (sheet[26:218, 26:170] < 128).any()


def test_a_row_without_pictures_says_so(tmp_path: Path) -> None:
    """There is ink where the first picture would be."""
    write_rows(tmp_path / "a.png", [("A", "", [])])

    assert (read(tmp_path / "a.png")[:, 176:] < 200).any()


@pytest.mark.parametrize("beside", [True, False])
def test_pictures_keep_their_size(tmp_path: Path, beside: bool) -> None:
    """Side by side or one below the other, each under its heading; what is short is filled up."""
    parts = []
    for name, picture in (
        ("one", plain((9, 9, 9), 300, 100)),
        ("two", plain((9, 9, 99), 200, 160)),
    ):
        write_png(tmp_path / f"{name}.png", picture)
        parts.append((name, tmp_path / f"{name}.png"))

    join_pictures(tmp_path / "a.png", parts, beside=beside)

    sheet = read(tmp_path / "a.png")
    assert sheet.shape == ((216, 500, 3) if beside else (372, 300, 3))
    assert int((sheet == (9, 9, 9)).all(axis=2).sum()) == 300 * 100
    assert int((sheet == (9, 9, 99)).all(axis=2).sum()) == 200 * 160
    second = sheet[56, 300] if beside else sheet[56 + 100 + 56, 0]
    assert second.tolist() == [9, 9, 99]


def test_a_missing_picture_is_named(tmp_path: Path) -> None:
    """What cannot be read is an error, not a hole."""
    write_png(tmp_path / "a.png", blank(10, 10))

    with pytest.raises(OutputError, match=r"b\.png: no picture"):
        join_pictures(
            tmp_path / "c.png", [("A", tmp_path / "a.png"), ("B", tmp_path / "b.png")], beside=True
        )
