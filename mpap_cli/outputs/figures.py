"""What all plots share: a figure in one look, whatever the user's settings are.

Nothing global is touched, and the same numbers give the same bytes.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpap_cli.outputs.text_table import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PREDICTION = "#0072B2"
_DIGITS = 5
_LOOK: dict[str, Any] = {
    "font.size": 11.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E2E2E2",
    "axes.axisbelow": True,
    "legend.frameon": False,
    "svg.hashsalt": "mpap",
}


@contextmanager
def figure_for(path: Path, size: tuple[float, float]) -> Iterator["Figure"]:
    """Give a figure of this size in inches to draw on, then write it as PNG and SVG.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    from matplotlib import style  # noqa: PLC0415  # slow to import
    from matplotlib.figure import Figure  # noqa: PLC0415

    with style.context(_LOOK, after_reset=True), warnings.catch_warnings():
        # a log may be called anything; what the font has no sign for is drawn as a box
        warnings.filterwarnings("ignore", "Glyph .* missing from font", UserWarning)
        figure = Figure(figsize=size)
        figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.1)
        yield figure
        _settle(figure)
        figure.savefig(path, dpi=150, format="png", metadata={"Software": None})
        nothing = {"Date": None, "Creator": None}
        figure.savefig(path.with_suffix(".svg"), format="svg", metadata=nothing)


def _settle(figure: "Figure") -> None:
    """Lay the figure out once, to places that the last digits of the solver do not change."""
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
    figure.set_layout_engine("none")
    for axes in figure.axes:
        left, bottom, width, height = (
            round(float(value), _DIGITS) for value in axes.get_position().bounds
        )
        axes.set_position((left, bottom, width, height))


def plain(text: str) -> str:
    r"""Return a text that matplotlib can draw, does not read as a formula or hide in a legend.

    >>> plain("_cost: 1 $" + chr(27))
    'cost: 1 \\$?'
    """
    return printable(text).replace("$", r"\$").lstrip("_")


def say(axis: "Axes", words: str) -> None:
    """Write in the middle of an empty plot why it is empty."""
    paper = {"facecolor": "white", "edgecolor": "none"}
    axis.text(0.5, 0.5, words, ha="center", va="center", transform=axis.transAxes, bbox=paper)
