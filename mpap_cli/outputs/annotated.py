"""Camera images with what the model says of their patches and what the robot does (Fig. 6)."""

import functools
import math
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from mpap_cli.observations import BoolArray, Float64Array
from mpap_cli.outputs.action_signs import ACTION_SIGNS
from mpap_cli.outputs.canvas import (
    PALE_INK,
    UNKNOWN,
    Box,
    Color,
    Image,
    blank,
    paste,
    probability_color,
    put_text,
    shorten,
    text_width,
    write_png,
)

MOST_ON_SHEET = 24
"""Images that a sheet shows; of more, as many evenly spread."""

_NARROWEST, _WIDEST = 640, 1280
_STRIP = 52
_OBSTACLE: Color = probability_color(1.0)
_FREE: Color = (115, 158, 0)  # a green that differs from vermilion for the color-blind
_TINT = 0.3
_HATCH = 14
_DASH = 8
_EDGE = 26
_TITLE = 64
_CAPTION = 30
_GAP = 20
_SHEET_COLUMNS = 4
_SHEET_TILE = 460


def annotate(
    image: Image, p: Float64Array, unknown: BoolArray, action: str, threshold: float
) -> Image:
    """Draw probabilities on the patches of an image, and the action below it.

    An obstacle is tinted and has a thick vermilion frame, a free patch a thin green one;
    an unknown patch is hatched in a dashed grey frame. So they differ in shape too.

    Parameters
    ----------
    image : Image
        The camera image (height, width, 3), BGR, of any size.
    p : ndarray of shape (rows, columns)
        Probability of an obstacle; NaN where the model has no labels: a plain grey frame.
    unknown : ndarray of shape (rows, columns)
        Which patches the model does not know.
    action : str
        straight, rotate-left, rotate-right or stop.
    threshold : float
        Probability from which a known patch is an obstacle.

    Returns
    -------
    Image
        640 to 1280 pixels wide, in the proportions of the image, and a strip below.

    Raises
    ------
    ValueError
        If the shapes differ or there is no such action.
    """
    if p.shape != unknown.shape or p.ndim != 2:  # noqa: PLR2004  # rows, columns
        msg = f"p has shape {p.shape}, unknown {unknown.shape}; expected one grid of patches"
        raise ValueError(msg)
    if action not in ACTION_SIGNS:
        msg = f"action: found {action}, expected one of {', '.join(ACTION_SIGNS)}"
        raise ValueError(msg)
    drawn = _enlarged(image)
    obstacle = ~unknown & (p >= threshold)
    free = ~unknown & (p < threshold)
    for row, column in np.ndindex(*p.shape):
        box = _patch_box(drawn, p.shape, row, column)
        cell = drawn[box.y : box.bottom, box.x : box.right]
        if unknown[row, column]:
            _draw_unknown(cell)
        elif obstacle[row, column]:
            _draw_obstacle(cell)
        else:
            _draw_frame(cell, _FREE if free[row, column] else UNKNOWN, 2)
        _draw_number(cell, float(p[row, column]), is_unknown=bool(unknown[row, column]))
    strip = blank(drawn.shape[1], _STRIP)
    ACTION_SIGNS[action](strip)
    put_text(strip, action, (66, 33), size=0.7, weight=2)
    counts = (int(obstacle.sum()), int(free.sum()), int(unknown.sum()))
    _draw_counts(strip, (*counts, p.size - sum(counts)))
    return np.concatenate((drawn, strip))


def write_annotated_sheet(path: Path, images: Sequence[tuple[Image, str]]) -> None:
    """Draw annotated images with captions on one sheet, row by row.

    Parameters
    ----------
    path : Path
        File to write.
    images : sequence of (Image, str)
        Images in the order in which they are shown, each with the line below it.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    n_shown = min(len(images), MOST_ON_SHEET)
    spread = np.linspace(0, len(images) - 1, n_shown).round().astype(np.int64)
    shown = [images[index] for index in spread.tolist()]
    tile_height = max((round(_SHEET_TILE * _slope(image)) for image, _ in shown), default=0)
    columns = max(1, min(_SHEET_COLUMNS, n_shown))
    width = 2 * _EDGE + columns * _SHEET_TILE + (columns - 1) * _GAP
    page = blank(width, _TITLE + -(-n_shown // columns) * (tile_height + _CAPTION + _GAP))
    few = "" if n_shown == len(images) else f"{n_shown} of "
    title = f"{few}{len(images):,} image{'' if len(images) == 1 else 's'}: predicted obstacles"
    put_text(page, title, (_EDGE, 42), size=0.8, weight=2)
    for index, (image, caption) in enumerate(shown):
        x = _EDGE + (index % columns) * (_SHEET_TILE + _GAP)
        y = _TITLE + (index // columns) * (tile_height + _CAPTION + _GAP)
        paste(page, image, Box(x, y, _SHEET_TILE, tile_height))
        line = shorten(caption, _SHEET_TILE, 0.5)
        put_text(page, line, (x, y + tile_height + 20), size=0.5, color=PALE_INK)
    write_png(path, page, photographs=True)


def _slope(image: Image) -> float:
    """Return height over width."""
    return float(image.shape[0] / image.shape[1])


def _enlarged(image: Image) -> Image:
    """Return a copy wide enough for numbers on the patches, and not too large for a log."""
    height, width = image.shape[:2]
    scale = min(max(width, _NARROWEST), _WIDEST) / width
    if scale == 1.0:
        return image.copy()
    size = (round(width * scale), max(1, round(height * scale)))
    way = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, size, interpolation=way), dtype=np.uint8)


def _patch_box(image: Image, shape: tuple[int, ...], row: int, column: int) -> Box:
    """Return where a patch lies: equal whole sizes, the remainder split between the sides."""
    height, width = image.shape[0] // shape[0], image.shape[1] // shape[1]
    top = (image.shape[0] - shape[0] * height) // 2
    left = (image.shape[1] - shape[1] * width) // 2
    # a pixel between neighbors keeps their frames apart
    return Box(left + column * width, top + row * height, max(1, width - 1), max(1, height - 1))


def _draw_frame(cell: Image, color: Color, weight: int) -> None:
    """Draw the border of a patch inside of it."""
    cell[:weight] = cell[-weight:] = color
    cell[:, :weight] = cell[:, -weight:] = color


def _draw_obstacle(cell: Image) -> None:
    """Tint a patch and frame it thickly."""
    tint = np.full_like(cell, _OBSTACLE)
    cell[:] = cv2.addWeighted(cell, 1 - _TINT, tint, _TINT, 0)
    _draw_frame(cell, _OBSTACLE, 4)


def _draw_unknown(cell: Image) -> None:
    """Hatch a patch and frame it with dashes, light beside dark so that both show."""
    light, dark = _hatching(cell.shape[0], cell.shape[1])
    cell[light] = (235, 235, 235)
    cell[dark] = (90, 90, 90)


@functools.lru_cache(maxsize=16)
def _hatching(height: int, width: int) -> tuple[BoolArray, BoolArray]:
    """Return the light and the dark pixels of hatched patches of one size."""
    y, x = np.ogrid[:height, :width]
    border = np.minimum(np.minimum(y, height - 1 - y), np.minimum(x, width - 1 - x)) < 2  # noqa: PLR2004  # its width
    along = (x + y) // _DASH % 2 == 0
    line = (x + y) % _HATCH
    light = np.where(border, along, line == 0)
    dark = np.where(border, ~along, line == 1)
    return light, dark


def _draw_number(cell: Image, p: float, *, is_unknown: bool) -> None:
    """Write the probability into the upper left corner, on a plate of its own."""
    text = "?" if is_unknown else ""
    if not math.isnan(p):
        text += f"{p:.2f}".removeprefix("0")
    if not text:
        return
    size = 0.45 if cell.shape[1] >= 70 else 0.33  # noqa: PLR2004  # room for it
    width, height = text_width(text, size) + 6, round(36 * size)
    cell[4 : 4 + height, 4 : 4 + width] = (255, 255, 255)
    put_text(cell, text, (7, height), size=size)


def _draw_counts(strip: Image, counts: tuple[int, ...]) -> None:
    """Draw how many patches are what, right to left, each beside its sign."""
    right = strip.shape[1] - 12
    names = ("obstacle", "free", "unknown", "no labels")
    for kind in reversed(range(len(names))):
        if counts[kind] == 0 and names[kind] == "no labels":
            continue
        words = f"{counts[kind]} {names[kind]}"
        put_text(strip, words, (right, 32), size=0.5, align=1)
        right -= text_width(words, 0.5) + 32
        cell = strip[16:38, right : right + 26]
        cell[:] = (250, 250, 250)
        if kind == 0:
            _draw_obstacle(cell)
        elif kind == 2:  # noqa: PLR2004  # unknown
            _draw_unknown(cell)
        else:
            _draw_frame(cell, _FREE if kind == 1 else UNKNOWN, 2)
        right -= 12
