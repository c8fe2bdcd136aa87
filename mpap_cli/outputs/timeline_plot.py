"""Truth and prediction over time (Fig. 9)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpap_cli.observations import Float64Array
from mpap_cli.outputs.figures import PREDICTION, figure_for, plain, say

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TRUTH, _THRESHOLD = "#C1272D", "#333333"


@dataclass(frozen=True, slots=True, eq=False)
class Timeline:
    """What was predicted and what was true, scan by scan, in one log.

    ``time_s`` (n,) ascending; ``truth`` and ``predicted`` (n,) 1, 0, or NaN where not
    known; ``p_collision`` (n,) NaN where there is none.
    """

    log: str
    time_s: Float64Array
    truth: Float64Array
    predicted: Float64Array
    p_collision: Float64Array


def plot_timeline(
    path: Path, timelines: Sequence[Timeline], threshold: float, limit: int = 6
) -> None:
    """Draw truth above prediction for each log, and the probability below (Fig. 9).

    Parameters
    ----------
    path : Path
        PNG to write.
    timelines : sequence of Timeline
        One a log, in order.
    threshold : float
        Probability from which a collision is predicted.
    limit : int
        Most logs drawn: the first of those with the most contact; a line says how many
        are left out.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    shown = _most_contact(timelines, limit)
    n_rows = 3 * max(1, len(shown))
    with figure_for(path, (11.0, 0.8 + 3.3 * max(1, len(shown)))) as figure:
        ratios = [0.55, 0.55, 1.4] * max(1, len(shown))
        axes = figure.subplots(n_rows, 1, squeeze=False, gridspec_kw={"height_ratios": ratios})
        for index, timeline in enumerate(shown):
            _draw_timeline(axes[3 * index : 3 * index + 3, 0].tolist(), timeline, threshold)
        if not shown:
            for axis in axes[:, 0]:
                axis.set_axis_off()
            say(axes[2, 0], "no scan was scored")
        axes[-1, 0].set_xlabel("time in the log, s")
        left_out = len(timelines) - len(shown)
        if left_out:
            words = f"{left_out} more log{'' if left_out == 1 else 's'} in timeline.csv"
            figure.supxlabel(words, fontsize=10, color="#555555", x=0.99, ha="right")


def _most_contact(timelines: Sequence[Timeline], limit: int) -> list[Timeline]:
    """Return the logs with the most contact, in the order given; empty ones never."""
    full = [index for index, timeline in enumerate(timelines) if timeline.time_s.size]
    full.sort(key=lambda index: -float(np.nansum(timelines[index].truth)))
    return [timelines[index] for index in sorted(full[:limit])]


def _draw_timeline(axes: Sequence["Axes"], timeline: Timeline, threshold: float) -> None:
    """Draw the three strips of one log."""
    top, middle, bottom = axes
    reduced = _with_gaps(_thinned(timeline))
    for axis, values, color, name in (
        (top, reduced.truth, _TRUTH, "truth"),
        (middle, reduced.predicted, PREDICTION, "predicted"),
    ):
        axis.fill_between(reduced.time_s, np.nan_to_num(values), step="post", color=color, lw=0.8)
        axis.set(ylim=(0, 1.05), yticks=[0, 1], xticklabels=[])
        axis.set_ylabel(name, rotation=0, ha="right", va="center")
        axis.grid(visible=False, axis="y")
    top.set_title(plain(timeline.log), loc="left", fontsize=11)
    bottom.plot(reduced.time_s, reduced.p_collision, color=PREDICTION, lw=1.2)
    bottom.axhline(threshold, color=_THRESHOLD, lw=1.2, ls="--", zorder=3)
    place = bottom.get_yaxis_transform()
    bottom.text(1.005, threshold, f"p = {threshold:g}", va="center", fontsize=9, transform=place)
    bottom.set(ylim=(0, 1.05), yticks=[0, 0.5, 1])
    bottom.set_ylabel("p(collision)", rotation=0, ha="right", va="center")
    span = float(reduced.time_s[-1] - reduced.time_s[0]) or 1.0
    for axis in axes:
        axis.set_xlim(reduced.time_s[0] - 0.005 * span, reduced.time_s[-1] + 0.005 * span)


def _thinned(timeline: Timeline, n_columns: int = 3000) -> Timeline:
    """Keep the highest value of each column of pixels, so that no short press is lost."""
    if timeline.time_s.size <= n_columns:
        return timeline
    starts = np.linspace(0, timeline.time_s.size, n_columns, endpoint=False).astype(np.int64)

    def highest(values: Float64Array) -> Float64Array:
        return np.fmax.reduceat(values, starts)

    return Timeline(
        log=timeline.log,
        time_s=timeline.time_s[starts],
        truth=highest(timeline.truth),
        predicted=highest(timeline.predicted),
        p_collision=highest(timeline.p_collision),
    )


def _with_gaps(timeline: Timeline) -> Timeline:
    """Put an unknown moment behind every scan that no other follows soon."""
    steps = np.diff(timeline.time_s)
    usual = float(np.median(steps)) if steps.size else 0.0
    gaps = np.flatnonzero(steps > max(10 * usual, 1.0))

    def broken(values: Float64Array) -> Float64Array:
        return np.insert(values, gaps + 1, np.nan)

    return Timeline(
        log=timeline.log,
        time_s=np.insert(timeline.time_s, gaps + 1, timeline.time_s[gaps] + usual),
        truth=broken(timeline.truth),
        predicted=broken(timeline.predicted),
        p_collision=broken(timeline.p_collision),
    )
