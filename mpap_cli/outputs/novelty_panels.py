"""Novelty over time in several environments, side by side (Fig. 13)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mpap_cli.evaluation.novelty import NoveltyRow
from mpap_cli.outputs.figures import figure_for, plain, say
from mpap_cli.outputs.novelty_curves import corners, courses_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Okabe and Ito; widths and dashes tell the lines apart in print too.
_LOOKS = (("#0072B2", "-", 2.2), ("#D55E00", "--", 1.8), ("#009E73", ":", 2.2))
_HEIGHT, _PANEL, _MARGIN = 4.4, 4.0, 0.6


@dataclass(frozen=True, slots=True)
class NoveltyPanel:
    """One environment: its name, and for each line the label and the windows of one log."""

    title: str
    lines: Sequence[tuple[str, Sequence[NoveltyRow]]]


def plot_novelty_panels(path: Path, panels: Sequence[NoveltyPanel]) -> None:
    """Draw the share of new observations over time, a panel for each environment (Fig. 13).

    Parameters
    ----------
    path : Path
        PNG to write.
    panels : sequence of NoveltyPanel
        At least one, drawn from left to right on one scale; at most three different
        labels, each with the same look in every panel.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    labels = list(dict.fromkeys(label for panel in panels for label, _ in panel.lines))
    looks = dict(zip(labels, _LOOKS, strict=False))
    with figure_for(path, (_PANEL * len(panels) + _MARGIN, _HEIGHT)) as figure:
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, panel in zip(axes, panels, strict=True):
            axis.set(title=plain(panel.title), xlabel="minutes", ylim=(0, 101))
            axis.set_yticks(range(0, 101, 20))
            axis.margins(x=0)
            for label, rows in panel.lines:
                _draw(axis, rows, label, looks[label])
            if not any(rows for _, rows in panel.lines):
                say(axis, "nothing was observed")
        axes[0].set_ylabel("novel observations in %")
        figure.legend(
            *axes[0].get_legend_handles_labels(),
            loc="outside lower center",
            ncols=max(1, len(labels)),
        )


def _draw(
    axis: "Axes", rows: Sequence[NoveltyRow], label: str, look: tuple[str, str, float]
) -> None:
    """Draw the line of one log, time counted from its first window."""
    color, style, width = look
    axis.plot([], [], color=color, ls=style, lw=width, label=plain(label))
    for course in courses_of(rows):
        x, novel = corners(course, course.novel)
        axis.plot(x, novel, color=color, ls=style, lw=width)
