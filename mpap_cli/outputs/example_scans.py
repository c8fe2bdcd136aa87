"""Scans with and without a collision, two views each and the image of the moment (Fig. 11)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.observations import Float32Array, ScanGeometry
from mpap_cli.outputs.canvas import (
    PALE_INK,
    UNKNOWN,
    Box,
    Image,
    blank,
    frame,
    paste,
    probability_color,
    put_text,
    write_png,
)
from mpap_cli.outputs.scan_views import common_scale, draw_above, draw_polar, half_view, see

_EDGE, _GAP = 26, 18
_HEAD, _ROW = 76, 300
_POLAR, _SIDE, _PICTURE = 380, 250, 330


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ExampleScan:
    """One scan: when it was taken, whether in contact, and what the camera saw then.

    ``ranges`` (n_beams,) in metres as recorded; ``forward_rad`` and ``range_max`` as in
    :func:`mpap_cli.outputs.scan_views.see`; ``image`` BGR, None without one.
    """

    time_s: float
    in_contact: bool
    ranges: Float32Array
    geometry: ScanGeometry
    forward_rad: float
    range_max: float | None
    image: Image | None


def write_example_scans(path: Path, examples: Sequence[ExampleScan]) -> None:
    """Draw one row a scan: range over angle, from above, the image.

    Parameters
    ----------
    path : Path
        PNG to write.
    examples : sequence of ExampleScan
        In the order drawn; none gives a page that says so.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    width = 2 * _EDGE + _POLAR + _SIDE + _PICTURE + 2 * _GAP
    page = blank(width, _HEAD + max(1, len(examples)) * _ROW)
    words = "range over angle (gray ticks: beams without return), from above, image"
    put_text(page, "Scans with and without a collision", (_EDGE, 36), size=0.8, weight=2)
    put_text(page, words, (_EDGE, 60), color=PALE_INK)
    if not examples:
        put_text(page, "no scan was taken", (_EDGE, _HEAD + 40), color=UNKNOWN)
    seen = [see(one.ranges, one.geometry, one.forward_rad, one.range_max) for one in examples]
    scale = (common_scale(seen), half_view(seen)) if seen else (1.0, 180.0)
    for index, (one, scan) in enumerate(zip(examples, seen, strict=True)):
        y = _HEAD + index * _ROW
        view = (*scale, probability_color(float(one.in_contact)))
        state = "collision" if one.in_contact else "no collision"
        put_text(page, f"{state}, at {one.time_s:.1f} s", (_EDGE, y + 16), size=0.6, weight=2)
        top = y + 26
        draw_polar(page, Box(_EDGE, top, _POLAR, _SIDE), scan, view)
        draw_above(page, Box(_EDGE + _POLAR + _GAP, top, _SIDE, _SIDE), scan, view)
        _draw_image(page, Box(width - _EDGE - _PICTURE, top, _PICTURE, _SIDE), one.image)
    write_png(path, page, photographs=True)


def _draw_image(page: Image, box: Box, image: Image | None) -> None:
    """Draw the image of the moment, or say that there is none."""
    if image is not None:
        paste(page, image, box)
        return
    frame(page, box)
    middle = (box.x + box.width / 2, box.y + box.height / 2)
    put_text(page, "no image", middle, color=UNKNOWN, align=0.5)
