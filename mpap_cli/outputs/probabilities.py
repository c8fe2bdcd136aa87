"""How clusters are ranked by their probability, and how a probability is drawn."""

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from mpap_cli.outputs.canvas import Box, Image, fill_box, probability_color, put_text

_TRACK = (238, 238, 238)
_KEY_WIDTH = 140

Item = TypeVar("Item")


def number(value: float | None) -> float:
    """Return a probability; NaN where there is none."""
    return math.nan if value is None else value


def rank(p: float | None) -> float:
    """Return what clusters are sorted by, high first; those without labels come last.

    >>> sorted([0.2, None, 0.9], key=rank, reverse=True)
    [0.9, 0.2, None]
    """
    known = number(p)
    return -1.0 if math.isnan(known) else known


def divide(ranked: Sequence[Item], limit: int) -> tuple[list[Item], list[Item]]:
    """Return which clusters are drawn and which are left out.

    Parameters
    ----------
    ranked : sequence
        Clusters, the highest probability first.
    limit : int
        Most clusters drawn. Of more, those with the highest and the lowest probability
        are drawn, two to one.

    Examples
    --------
    >>> divide("abcdef", 3)
    (['a', 'b', 'f'], ['c', 'd', 'e'])
    """
    n_lowest = limit // 3 if len(ranked) > limit else 0
    behind = max(limit - n_lowest, len(ranked) - n_lowest)
    shown = [*ranked[: limit - n_lowest], *ranked[behind:]]
    return shown, list(ranked[limit - n_lowest : behind])


def left_out_text(ps: Sequence[float | None]) -> str:
    """Say how many clusters are not drawn, highest probability first.

    >>> left_out_text([0.5, 0.25])
    'and 2 more, in clusters.csv, with probabilities from 0.25 to 0.50 (not drawn)'
    """
    text = f"and {len(ps)} more, in clusters.csv"
    highest, lowest = rank(ps[0]), rank(ps[-1])
    if lowest < 0:
        return text
    return f"{text}, with probabilities from {lowest:.2f} to {highest:.2f} (not drawn)"


def draw_key(page: Image, name: str, right: int, baseline: int) -> None:
    """Draw what the colors of probabilities mean; it ends at ``right``."""
    put_text(page, "1", (right, baseline), size=0.5, align=1)
    left, top = right - 160, baseline - 12
    steps = [probability_color(step / (_KEY_WIDTH - 1)) for step in range(_KEY_WIDTH)]
    page[top : top + 14, left : left + _KEY_WIDTH] = np.array(steps, dtype=np.uint8)
    put_text(page, f"p({name})  0", (left - 8, baseline), size=0.5, align=1)


def draw_bar(page: Image, box: Box, p: float) -> None:
    """Draw a probability as a bar; nothing if it is NaN."""
    if math.isnan(p):
        return
    fill_box(page, (box.x, box.y), (box.width, box.height), _TRACK)
    fill_box(page, (box.x, box.y), (box.width * p, box.height), probability_color(p))
