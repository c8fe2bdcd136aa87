"""How much of each log is unknown to the others, as a matrix of shares."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mpap_cli.observations import Float64Array
from mpap_cli.outputs.figures import figure_for, plain

_CELL = 0.85
_DARK = 0.6
_NAME_LETTERS = 24


def plot_comparison(path: Path, names: Sequence[str], shares: Float64Array) -> None:
    """Draw a matrix: rows are logs, columns what was learnt of each, last of all others.

    Parameters
    ----------
    path : Path
        PNG to write.
    names : sequence of str
        Base names of the k logs.
    shares : ndarray of shape (k, k + 1)
        Share of each log that is unknown.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    short = [plain(_shortened(name)) for name in names]
    size = (3.4 + _CELL * (len(names) + 1), 2.2 + _CELL * len(names))
    with figure_for(path, size) as figure:
        axis = figure.subplots()
        shown = np.where(np.eye(len(names), len(names) + 1, dtype=bool), np.nan, shares)
        axis.imshow(shown, cmap="Blues", vmin=0, vmax=1, aspect="auto")
        axis.grid(visible=False)
        axis.set_xticks(range(len(names) + 1), [*short, "all others"], rotation=35, ha="right")
        axis.set_yticks(range(len(names)), short)
        axis.set(xlabel="what was learnt of", ylabel="log")
        for (row, column), share in np.ndenumerate(shown):
            color = "white" if share > _DARK else "black"
            words = "" if np.isnan(share) else f"{100 * share:.0f} %"
            axis.text(column, row, words, ha="center", va="center", color=color)
        figure.suptitle("unknown")


def _shortened(name: str) -> str:
    """Return the end of a long name, which tells logs apart."""
    return name if len(name) <= _NAME_LETTERS else f"...{name[3 - _NAME_LETTERS :]}"
