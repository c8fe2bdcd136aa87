"""What all plots share: a figure in one look, whatever the user's settings are.

Nothing global is touched, and the same numbers give the same bytes.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PREDICTION = "#0072B2"
_LOOK: dict[str, Any] = {
    "font.size": 11.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E2E2E2",
    "axes.axisbelow": True,
    "legend.frameon": False,
}


@contextmanager
def figure_for(path: Path, size: tuple[float, float]) -> Iterator["Figure"]:
    """Give a figure of this size in inches to draw on, then write it as PNG.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    from matplotlib import style  # noqa: PLC0415  # slow to import
    from matplotlib.figure import Figure  # noqa: PLC0415

    with style.context(_LOOK, after_reset=True):
        figure = Figure(figsize=size)
        figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.1)
        yield figure
        figure.savefig(path, dpi=150, format="png", metadata={"Software": None})


def plain(text: str) -> str:
    """Return a text that matplotlib does not read as a formula or hide from the legend."""
    return text.replace("$", r"\$").lstrip("_")


def say(axis: "Axes", words: str) -> None:
    """Write in the middle of an empty plot why it is empty."""
    paper = {"facecolor": "white", "edgecolor": "none"}
    axis.text(0.5, 0.5, words, ha="center", va="center", transform=axis.transAxes, bbox=paper)
