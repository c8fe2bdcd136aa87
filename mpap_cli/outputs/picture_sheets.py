"""Pictures put together on one sheet with OpenCV: rows with names (Fig. 16), halves (14, 15)."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from mpap_cli.errors import OutputError
from mpap_cli.outputs.canvas import (
    PALE_INK,
    UNKNOWN,
    Box,
    Image,
    blank,
    paste,
    put_text,
    shorten,
    write_png,
)

_EDGE = 26
_HEAD = 56
_NAME = 150
_TILE = (256, 192)
_GAP = 10
_SIZE = 0.9


def write_rows(path: Path, rows: Sequence[tuple[str, str, Sequence[Image]]]) -> None:
    """Draw one row of pictures for each place, its name on the left (Fig. 16).

    Parameters
    ----------
    path : Path
        PNG to write.
    rows : sequence of (str, str, sequence of Image)
        Name, a short line below it, and pictures (height, width, 3), BGR, of any size;
        rows need not be equally long.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    longest = max((len(pictures) for _, _, pictures in rows), default=0)
    width = 2 * _EDGE + _NAME + max(1, longest) * (_TILE[0] + _GAP) - _GAP
    page = blank(width, 2 * _EDGE + len(rows) * (_TILE[1] + _GAP) - _GAP)
    for number, (name, below, pictures) in enumerate(rows):
        y = _EDGE + number * (_TILE[1] + _GAP)
        room = _NAME - _GAP
        middle = y + _TILE[1] / 2
        put_text(page, shorten(name, room, _SIZE), (_EDGE, middle), size=_SIZE, weight=2)
        words = shorten(below, room, 0.5)
        put_text(page, words, (_EDGE, middle + 26), size=0.5, color=PALE_INK)
        for column, picture in enumerate(pictures):
            x = _EDGE + _NAME + column * (_TILE[0] + _GAP)
            paste(page, picture, Box(x, y, *_TILE))
        if not pictures:
            put_text(page, "no image", (_EDGE + _NAME, middle), size=0.5, color=UNKNOWN)
    write_png(path, page, photographs=True)


def join_pictures(path: Path, parts: Sequence[tuple[str, Path]], *, beside: bool) -> None:
    """Put whole pictures on one sheet, each below its heading (Fig. 14, 15).

    Parameters
    ----------
    path : Path
        PNG to write.
    parts : sequence of (str, Path)
        Heading and PNG of each picture, at least one; none is scaled.
    beside : bool
        From left to right; otherwise from the top down.

    Raises
    ------
    OutputError
        If a picture cannot be read.
    OSError
        If the file cannot be written.
    """
    pictures = [_headed(heading, _read(part)) for heading, part in parts]
    along = 1 if beside else 0
    longest = max(picture.shape[1 - along] for picture in pictures)
    filled = [_filled(picture, longest, along) for picture in pictures]
    write_png(path, np.concatenate(filled, axis=along), photographs=True)


def _read(path: Path) -> Image:
    """Read a picture."""
    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        msg = f"{path}: no picture; draw it first"
        raise OutputError(msg)
    return np.asarray(image, dtype=np.uint8)


def _headed(heading: str, picture: Image) -> Image:
    """Return a picture with a heading above it."""
    strip = blank(picture.shape[1], _HEAD)
    words = shorten(heading, picture.shape[1] - 2 * _EDGE, 1.1)
    put_text(strip, words, (_EDGE, _HEAD - 14), size=1.1, weight=2)
    return np.concatenate((strip, picture))


def _filled(picture: Image, length: int, along: int) -> Image:
    """Return a picture with white at its lower or right edge, so that it is that long."""
    missing = [(0, 0), (0, 0), (0, 0)]
    missing[1 - along] = (0, length - picture.shape[1 - along])
    return np.pad(picture, missing, constant_values=255)
