"""Rows of image patches, a name before each (Fig. 7)."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from mpap_cli.outputs.canvas import Box, Image, blank, paste, put_text, shorten, write_png

_EDGE, _GAP, _NAME = 20, 8, 150
_TILE = (104, 80)
_SIZE = 0.55


class PatchLine(NamedTuple):
    """A name and some patches, BGR, of any size."""

    name: str
    patches: Sequence[Image]


def write_patch_sheet(path: Path, lines: Sequence[PatchLine]) -> None:
    """Draw one row of patches below the other.

    Parameters
    ----------
    path : Path
        PNG to write.
    lines : sequence of PatchLine
        At least one.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    most = max(len(line.patches) for line in lines)
    width, height = (side + _GAP for side in _TILE)
    page = blank(2 * _EDGE + _NAME + most * width - _GAP, 2 * _EDGE + len(lines) * height - _GAP)
    for row, line in enumerate(lines):
        y = _EDGE + row * height
        name = shorten(line.name, _NAME - _GAP, _SIZE)
        put_text(page, name, (_EDGE, y + _TILE[1] / 2 + 5), size=_SIZE)
        for column, patch in enumerate(line.patches):
            paste(page, patch, Box(_EDGE + _NAME + column * width, y, *_TILE))
    write_png(path, page, photographs=True)
