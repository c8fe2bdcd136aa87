"""exemplars.png: what the clusters look like, with their collision probability (Fig. 11).

Drawn with OpenCV alone, so that learning need not load a plotting library.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpap_cli.observations import Float32Array, ScanGeometry
from mpap_cli.outputs.canvas import (
    GRID,
    INK,
    PALE_INK,
    UNKNOWN,
    Box,
    Image,
    blank,
    draw_line,
    frame,
    paste,
    probability_color,
    put_text,
    shorten,
    text_width,
    write_png,
)
from mpap_cli.outputs.probabilities import (
    divide,
    draw_bar,
    draw_key,
    left_out_text,
    number,
    rank,
)
from mpap_cli.outputs.scan_views import (
    SeenScan,
    common_scale,
    draw_above,
    draw_polar,
    half_view,
    see,
)

_EDGE = 26
_TITLE = 104
_HEAD = 64
_PLOT = 270
_POLAR = 470
_PICTURE = 360
_GAP = 14
_SMALL = 0.55
_KEY = (
    "left: range (m) over angle, grey ticks at the top are beams without return; "
    "right: from above, the robot drives up"
)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ExemplarPicture:
    """The exemplar of one cluster, and what the cluster means.

    ``ranges`` (n_beams,) in metres as recorded, ``forward_rad`` the direction of travel in
    the frame of the scanner, ``range_max`` None: take the geometry's. ``p_collision``,
    ``p_low`` and ``p_high`` are NaN or None where there are no labels. ``image`` is the
    image (height, width, 3), BGR, uint8, of the same moment, or None.
    """

    cluster: int
    p_collision: float | None
    p_low: float | None
    p_high: float | None
    observations: int
    first_seen_s: float
    log: str
    time_s: float
    ranges: Float32Array
    geometry: ScanGeometry
    forward_rad: float
    range_max: float | None = None
    image: Image | None = None


def write_exemplars(path: Path, exemplars: Sequence[ExemplarPicture], limit: int = 12) -> None:
    """Draw the exemplars into a PNG, the most dangerous first.

    Parameters
    ----------
    path : Path
        File to write.
    exemplars : sequence of ExemplarPicture
        One a cluster, in any order.
    limit : int
        Most clusters drawn. Of more, those with the highest and the lowest probability
        are drawn, two to one, and a line says how many lie between.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    ranked = sorted(exemplars, key=lambda one: (-rank(one.p_collision), one.cluster))
    shown, left_out = divide(ranked, limit)
    with_image = any(one.image is not None for one in shown)
    card_width = _POLAR + _GAP + _PLOT + (_GAP + _PICTURE if with_image else 0)
    columns = 1 if len(shown) == 1 else 2
    rows = -(-len(shown) // columns)
    card_height = _HEAD + _PLOT + 40
    width = 2 * _EDGE + columns * card_width + (columns - 1) * 2 * _EDGE
    page = blank(width, _TITLE + rows * card_height + (34 if left_out else 0))
    _draw_title(page, len(ranked))
    seen = [see(one.ranges, one.geometry, one.forward_rad, one.range_max) for one in shown]
    scale = (common_scale(seen), half_view(seen)) if seen else (1.0, 180.0)
    for index, (one, scan) in enumerate(zip(shown, seen, strict=True)):
        x = _EDGE + (index % columns) * (card_width + 2 * _EDGE)
        y = _TITLE + (index // columns) * card_height
        _draw_card(page, Box(x, y, card_width, card_height), one, (scan, *scale))
    if left_out:
        text = left_out_text([one.p_collision for one in left_out])
        put_text(page, text, (_EDGE, page.shape[0] - 16), size=0.6)
    write_png(path, page)


def _draw_title(page: Image, n_clusters: int) -> None:
    """Draw the heading and the key of the colors."""
    title = f"{n_clusters} cluster{'' if n_clusters == 1 else 's'}: exemplar scans"
    put_text(page, title, (_EDGE, 42), size=0.9, weight=2)
    if n_clusters == 0:
        return
    room = page.shape[1] - 2 * _EDGE
    size = _SMALL * min(1.0, room / text_width(_KEY, _SMALL))
    put_text(page, _KEY, (_EDGE, 70), size=size, color=PALE_INK)
    draw_key(page, "collision", page.shape[1] - _EDGE, 40)


def _draw_card(
    page: Image, card: Box, one: ExemplarPicture, view: tuple[SeenScan, float, float]
) -> None:
    """Draw one cluster: what it means, its exemplar two ways, and the image."""
    p = number(one.p_collision)
    color = probability_color(p)
    _draw_head(page, card, one)
    scan, top_m, half = view
    y = card.y + _HEAD
    draw_polar(page, Box(card.x, y, _POLAR, _PLOT), scan, (top_m, half, color))
    draw_above(page, Box(card.x + _POLAR + _GAP, y, _PLOT, _PLOT), scan, (top_m, half, color))
    box = Box(card.x + _POLAR + _PLOT + 2 * _GAP, y, _PICTURE, _PLOT)
    if one.image is not None:
        paste(page, one.image, box)
    elif card.right > box.x:
        frame(page, box)
        middle = (box.x + box.width / 2, box.y + box.height / 2)
        put_text(page, "no image", middle, color=UNKNOWN, align=0.5)


def _draw_head(page: Image, card: Box, one: ExemplarPicture) -> None:
    """Draw the two lines above a scan, and the probability as a bar with its interval."""
    p, low, high = (number(value) for value in (one.p_collision, one.p_low, one.p_high))
    rule = np.array([[card.x, card.y - 8.0], [card.right, card.y - 8.0]])
    draw_line(page, rule, GRID)
    known = "no labels" if math.isnan(p) else f"p(collision) {p:.2f}"
    if not math.isnan(p + low + high):
        known += f"  [{low:.2f}, {high:.2f}]"
    name = f"cluster {one.cluster}"
    put_text(page, name, (card.x, card.y + 20), size=0.7, weight=2)
    put_text(page, known, (card.x + text_width(name, 0.7, 2) + 24, card.y + 20), size=0.62)
    scans = f"{one.observations:,} scan{'' if one.observations == 1 else 's'}"
    words = f"{scans}, first seen at {one.first_seen_s:.1f} s; shown: {one.time_s:.1f} s of "
    room = card.width - text_width(words, _SMALL)
    line = words + shorten(one.log, room, _SMALL)
    put_text(page, line, (card.x, card.y + 46), size=_SMALL, color=PALE_INK)
    if math.isnan(p):
        return
    left, length = card.x + _POLAR + _GAP, _PLOT
    y = card.y + 7
    draw_bar(page, Box(left, y, length, 14), p)
    if not math.isnan(low + high):
        whisker = np.array([[left + length * low, y + 7], [left + length * high, y + 7]])
        draw_line(page, whisker, INK, 2)
