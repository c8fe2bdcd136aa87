"""exemplars.png and members.png: what the clusters of image patches look like (Fig. 14, 15).

Drawn with OpenCV alone, so that learning need not load a plotting library.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.outputs.canvas import (
    GRID,
    PALE_INK,
    UNKNOWN,
    Box,
    Image,
    blank,
    fill_box,
    frame,
    paste,
    probability_color,
    put_text,
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

_EDGE = 26
_TITLE = 100
_FOOT = 34
_BORDER = 4
_SMALL = 0.45
# a patch of the paper is 53 x 40 pixels; tiles have its proportions
_TILE = (200, 152)
_TILE_HEAD = 42
_TILE_FOOT = 44
_TILE_GAP = 22
_MOST_TILES_A_ROW = 6
_THUMB = (106, 80)
_THUMB_GAP = 8
_ROW_HEAD = 190
_ROW_GAP = 18
_MOST_MEMBERS = 12
_MOST_SIGNS = 22


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PatchCluster:
    """One cluster of image patches, and what it means.

    ``p_obstacle`` is NaN or None where there are no labels; ``observations`` counts its
    patches, ``presses`` the distinct presses among their labels (None: there is no bumper).
    ``exemplar`` and ``members`` are pictures (height, width, 3), BGR, uint8, of any size;
    the exemplar is None where its image cannot be read any more. ``note`` says what the
    patches are, where that is known otherwise.
    """

    cluster: int
    p_obstacle: float | None
    observations: int
    presses: int | None
    exemplar: Image | None
    members: tuple[Image, ...] = ()
    note: str = ""


def write_patch_exemplars(path: Path, clusters: Sequence[PatchCluster], limit: int = 48) -> None:
    """Draw one tile a cluster into a PNG, the most likely obstacle first (Fig. 14).

    Parameters
    ----------
    path : Path
        File to write.
    clusters : sequence of PatchCluster
        In any order.
    limit : int
        Most clusters drawn. Of more, those with the highest and the lowest probability
        are drawn, two to one, and a line says how many lie between.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    shown, left_out = divide(_ranked(clusters), limit)
    columns = min(_MOST_TILES_A_ROW, max(4, math.ceil(math.sqrt(len(shown)))))
    width = 2 * _EDGE + columns * _TILE[0] + (columns - 1) * _TILE_GAP
    tile_height = _TILE_HEAD + _TILE[1] + _TILE_FOOT
    rows = -(-len(shown) // columns)
    page = _page((width, rows * tile_height), clusters, "exemplar patches", left_out)
    for index, one in enumerate(shown):
        x = _EDGE + (index % columns) * (_TILE[0] + _TILE_GAP)
        y = _TITLE + (index // columns) * tile_height
        _draw_tile(page, Box(x, y, *_TILE), one)
    write_png(path, page, photographs=True)


def write_members(path: Path, clusters: Sequence[PatchCluster], limit: int = 24) -> None:
    """Draw one row a cluster into a PNG: its exemplar, framed, then members (Fig. 15).

    Parameters
    ----------
    path : Path
        File to write.
    clusters : sequence of PatchCluster
        In any order; of each at most 12 members are drawn.
    limit : int
        Most clusters drawn, as in :func:`write_patch_exemplars`.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    shown, left_out = divide(_ranked(clusters), limit)
    most = max((len(one.members[:_MOST_MEMBERS]) for one in shown), default=0)
    thumbs = max(6, 1 + most)
    width = 2 * _EDGE + _ROW_HEAD + thumbs * (_THUMB[0] + _THUMB_GAP) + _THUMB_GAP
    row_height = _THUMB[1] + _ROW_GAP
    size = (width, len(shown) * row_height)
    page = _page(size, clusters, "exemplar (framed) and members", left_out)
    for index, one in enumerate(shown):
        _draw_row(page, _TITLE + index * row_height, one)
    write_png(path, page, photographs=True)


def _ranked(clusters: Sequence[PatchCluster]) -> list[PatchCluster]:
    """Return the clusters, the most likely obstacle first."""
    return sorted(clusters, key=lambda one: (-rank(one.p_obstacle), one.cluster))


def _page(
    size: tuple[int, int],
    clusters: Sequence[PatchCluster],
    what: str,
    left_out: Sequence[PatchCluster],
) -> Image:
    """Return a white page with title, key and a line for what is left out."""
    width, height = size
    n_clusters = len(clusters)
    page = blank(width, _TITLE + height + (_FOOT if left_out else 0))
    title = f"{n_clusters} cluster{'' if n_clusters == 1 else 's'}: {what}"
    put_text(page, title, (_EDGE, 42), size=0.8, weight=2)
    if any(not one.note for one in clusters):
        words = "the most likely obstacles first"
        put_text(page, words, (_EDGE, 70), size=_SMALL, color=PALE_INK)
        draw_key(page, "obstacle", width - _EDGE, 70)
    if left_out:
        text = left_out_text([one.p_obstacle for one in left_out])
        put_text(page, text, (_EDGE, page.shape[0] - 16), size=_SMALL)
    return page


def _draw_tile(page: Image, tile: Box, one: PatchCluster) -> None:
    """Draw one cluster: its number and probability, its exemplar, what it is made of."""
    p = number(one.p_obstacle)
    put_text(page, f"cluster {one.cluster}", (tile.x, tile.y + 18), size=0.55, weight=2)
    put_text(page, _p_text(p), (tile.right, tile.y + 18), size=0.55, align=1)
    draw_bar(page, Box(tile.x, tile.y + 26, tile.width, 8), p)
    box = Box(tile.x, tile.y + _TILE_HEAD, tile.width, tile.height)
    _draw_patch(page, box, one.exemplar, p)
    put_text(page, _counts(one), (tile.x, box.bottom + 18), size=_SMALL, color=PALE_INK)


def _draw_row(page: Image, y: int, one: PatchCluster) -> None:
    """Draw one cluster: what it is on the left, its exemplar, its members."""
    p = number(one.p_obstacle)
    put_text(page, f"cluster {one.cluster}", (_EDGE, y + 16), size=0.55, weight=2)
    known = "" if one.note else _p_text(p, "p ")
    put_text(page, known, (_EDGE + _ROW_HEAD - 20, y + 16), size=0.5, align=1)
    draw_bar(page, Box(_EDGE, y + 25, _ROW_HEAD - 20, 8), p)
    for line, words in enumerate([*_counts(one).split(", "), one.note[:_MOST_SIGNS]]):
        place = (_EDGE, y + 53 + 20 * line)
        put_text(page, words, place, size=_SMALL, color=PALE_INK)
    x = _EDGE + _ROW_HEAD
    _draw_patch(page, Box(x, y, *_THUMB), one.exemplar, p)
    x += _THUMB[0] + 3 * _THUMB_GAP
    for member in one.members[:_MOST_MEMBERS]:
        paste(page, member, Box(x, y, *_THUMB))
        x += _THUMB[0] + _THUMB_GAP
    if not one.members:
        put_text(page, "no other picture", (x, y + _THUMB[1] / 2 + 5), size=_SMALL, color=UNKNOWN)


def _draw_patch(page: Image, box: Box, patch: Image | None, p: float) -> None:
    """Draw an exemplar in a frame that has the color of its probability."""
    if patch is None:
        frame(page, box, GRID)
        middle = (box.x + box.width / 2, box.y + box.height / 2 + 5)
        put_text(page, "no image", middle, size=_SMALL, color=UNKNOWN, align=0.5)
        return
    last = (box.width - 1, box.height - 1)
    fill_box(page, (box.x, box.y), last, probability_color(p))
    inner = (box.x + _BORDER, box.y + _BORDER)
    paste(page, patch, Box(*inner, box.width - 2 * _BORDER, box.height - 2 * _BORDER))


def _p_text(p: float, before: str = "") -> str:
    """Return a probability in two digits, or say that there is none."""
    return "no labels" if math.isnan(p) else f"{before}{p:.2f}"


def _counts(one: PatchCluster) -> str:
    """Return how many patches and presses a cluster stands for."""
    patches = f"{one.observations:,} patch{'' if one.observations == 1 else 'es'}"
    if one.presses is None:
        return patches
    return f"{patches}, {one.presses:,} press{'' if one.presses == 1 else 'es'}"
