"""Plots of an evaluation: ROC curves (Fig. 10), timeline (Fig. 9) and calibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpap_cli.observations import Float64Array, FloatArray, IntArray
from mpap_cli.outputs.figures import PREDICTION, figure_for, plain, say
from mpap_cli.outputs.timeline_plot import Timeline, plot_timeline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Reliability", "RocLine", "Timeline", "plot_calibration", "plot_roc", "plot_timeline"]

# Okabe and Ito: distinguishable for the color-blind; line styles tell apart in print.
_COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_STYLES = ("-", "--", "-.", ":")


@dataclass(frozen=True, slots=True, eq=False)
class RocLine:
    """One ROC curve: corners ``fpr`` and ``tpr`` (m,), and the panel it is drawn in.

    ``label`` names the method (``global-diff``), ``panel`` what is above the panel
    (``6 bins``); ``auc`` is None where there is none.
    """

    label: str
    panel: str
    fpr: FloatArray
    tpr: FloatArray
    auc: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Reliability:
    """Predictions gathered in bins of equal width, each array (n_bins,).

    ``mean_p`` and ``share_positive`` are NaN in an empty bin.
    """

    scans: IntArray
    mean_p: Float64Array
    share_positive: Float64Array


def plot_roc(path: Path, lines: Sequence[RocLine], title: str = "") -> None:
    """Draw ROC curves, a panel for each name of a panel (Fig. 10).

    Parameters
    ----------
    path : Path
        PNG to write.
    lines : sequence of RocLine
        Curves; a label has the same color in every panel. Without any, the picture says
        that there is no curve.
    title : str
        Heading: protocol, target and truth.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    panels = list(dict.fromkeys(line.panel for line in lines)) or [""]
    labels = list(dict.fromkeys(line.label for line in lines))
    looks = dict(zip(labels, zip(cycle(_COLORS), cycle(_STYLES), strict=False), strict=False))
    with figure_for(path, (5.6 * len(panels) + 0.4, 6.3)) as figure:
        axes = figure.subplots(1, len(panels), squeeze=False)[0]
        for panel, axis in zip(panels, axes, strict=True):
            _chance_line(axis)
            for line in lines:
                if line.panel == panel:
                    _roc_line(axis, line, looks[line.label])
            axis.set(xlabel="false positive rate", ylabel="true positive rate", title=panel)
            axis.legend(loc="lower right", fontsize=10, title="area under curve")
        if not lines:
            say(axes[0], "no ROC curve: one class only")
        figure.suptitle(title)


def _chance_line(axis: "Axes") -> None:
    """Draw the diagonal of a guess and the frame of the unit square."""
    axis.plot([0, 1], [0, 1], color="#999999", lw=1, ls=(0, (2, 3)), label="chance  .50")
    axis.set_box_aspect(1)
    axis.set(xlim=(-0.01, 1.01), ylim=(-0.01, 1.01))
    axis.set_xticks(np.linspace(0, 1, 6))
    axis.set_yticks(np.linspace(0, 1, 6))


def _roc_line(axis: "Axes", line: RocLine, look: tuple[str, str]) -> None:
    """Draw one curve."""
    area = "" if line.auc is None else f"  {line.auc:.2f}".replace(" 0.", " .")
    color, style = look
    axis.plot(line.fpr, line.tpr, color=color, ls=style, lw=2, label=plain(line.label) + area)


def plot_calibration(path: Path, reliability: Reliability, title: str = "") -> None:
    """Draw how often a collision came at each probability, and how many scans that is.

    Parameters
    ----------
    path : Path
        PNG to write.
    reliability : Reliability
        Predictions in bins.
    title : str
        Heading: method and scores.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    n_bins = reliability.scans.size
    edges = np.linspace(0, 1, n_bins + 1)
    with figure_for(path, (5.8, 7.2)) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": [3, 1]})
        _draw_reliability(upper, reliability)
        centers = (edges[:-1] + edges[1:]) / 2
        lower.bar(centers, reliability.scans, width=0.9 / n_bins, color=PREDICTION, alpha=0.75)
        lower.set(xlabel="predicted probability", ylabel="scans", xlim=(-0.02, 1.02))
        lower.set_yscale("symlog", linthresh=1)
        lower.set_ylim(0, 6 * max(1, int(reliability.scans.max(initial=0))))
        for x, n in zip(centers, reliability.scans.tolist(), strict=True):
            lower.annotate(
                f"{n:,}", (x, n), (0, 2), ha="center", fontsize=8, textcoords="offset points"
            )
        figure.suptitle(title)


def _draw_reliability(axis: "Axes", reliability: Reliability) -> None:
    """Draw the upper plot: frequency over probability with 95 % intervals."""
    axis.plot([0, 1], [0, 1], color="#999999", lw=1, ls=(0, (2, 3)), label="as predicted")
    full = reliability.scans > 0
    p, share = reliability.mean_p[full], reliability.share_positive[full]
    low, high = _wilson(share, reliability.scans[full])
    gaps = np.maximum(np.stack((share - low, high - share)), 0.0)
    axis.errorbar(p, share, gaps, fmt="none", ecolor=PREDICTION, lw=1.2, capsize=3)
    axis.plot(
        p,
        share,
        "o-",
        color=PREDICTION,
        ms=6,
        lw=1.6,
        label="observed (95 % interval of independent scans)",
    )
    axis.set(ylabel="observed share of positive scans", ylim=(-0.02, 1.02))
    axis.legend(loc="upper left", fontsize=10)
    if not full.any():
        say(axis, "no scan was scored")


def _wilson(share: Float64Array, n: IntArray) -> tuple[Float64Array, Float64Array]:
    """Return Wilson's 95 % interval of shares of n; it counts every scan as independent."""
    z = 1.96
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z * np.sqrt(share * (1 - share) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return middle - half, middle + half
