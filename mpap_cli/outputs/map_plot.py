"""A map of one log with patches where they were seen, framed by what they are (Fig. 12)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpap_cli.observations import Float64Array
from mpap_cli.outputs.canvas import Image
from mpap_cli.outputs.figures import PREDICTION, figure_for, plain, say
from mpap_cli.outputs.map_sketch import MapSketch

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

MOST_PATCHES = 14
"""Patches that are shown; of more, the first."""

_RETURN = "#555555"
_JUMP_M = 1.0
_WIDTHS = (1.25, 7.0, 1.25)
# What a patch is: color of its frame, width of its frame, sign of its place.
_OBSTACLE, _FREE, _NOTHING = ("#D55E00", 5.0, "s"), ("#009E73", 3.0, "o"), ("#8C8C8C", 2.0, "^")
_KINDS = (("obstacle", _OBSTACLE), ("no obstacle", _FREE), ("no label", _NOTHING))
_Look = tuple[str, float, str]


@dataclass(frozen=True, slots=True, eq=False)
class MapPatch:
    """A patch and where the robot stood when it saw it.

    ``x_m`` and ``y_m`` are in the frame of the odometry; ``picture`` (h, w, 3) is BGR;
    ``p_obstacle`` is NaN where the model has no labels.
    """

    x_m: float
    y_m: float
    picture: Image
    p_obstacle: float


def plot_map(
    path: Path,
    sketch: MapSketch,
    patches: Sequence[MapPatch],
    threshold: float = 0.5,
    title: str = "",
) -> None:
    """Draw the way of the robot, what the laser met, and patches beside the map (Fig. 12).

    Parameters
    ----------
    path : Path
        PNG to write.
    sketch : MapSketch
        One log, in the frame of its odometry.
    patches : sequence of MapPatch
        At most ``MOST_PATCHES`` of them are drawn, each tied by a line to where it was
        seen from. An obstacle has a thick vermilion frame and a square for its place,
        what is none a thinner green frame and a dot.
    threshold : float
        Probability from which a patch is an obstacle.
    title : str
        Heading, for example the name of the log.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    placed = [patch for patch in patches if math.isfinite(patch.x_m + patch.y_m)][:MOST_PATCHES]
    with figure_for(path, (11.0, 7.2)) as figure:
        left, middle, right = figure.subfigures(1, 3, squeeze=False, width_ratios=_WIDTHS)[0]
        axis = middle.subplots()
        _draw_map(axis, sketch)
        for side, mine in zip((left, right), _sides(placed), strict=True):
            for patch_axis, patch in zip(_cells(side, len(mine)), mine, strict=True):
                look = _look(patch, threshold)
                _draw_patch(patch_axis, patch, look)
                _tie(figure, (patch_axis, axis), patch, look, at_left=side is left)
        for words, look in _KINDS:
            if any(_look(patch, threshold) is look for patch in placed):
                axis.plot([], [], look[2], color=look[0], ms=9, label=f"patch: {words}")
        if axis.get_legend_handles_labels()[1]:
            middle.legend(loc="outside lower center", ncols=3)
        middle.suptitle(plain(title))


def _draw_map(axis: "Axes", sketch: MapSketch) -> None:
    """Draw returns and way in metres, as seen from above."""
    way, returns = sketch.way, sketch.returns
    axis.set(xlabel="x in m, by odometry", ylabel="y in m")
    axis.set_aspect("equal", adjustable="datalim")
    if not way.size:
        say(axis, "no odometry")
        return
    if returns.size:
        axis.plot(*returns.T, ".", color=_RETURN, ms=1.6, mew=0, zorder=2)
        axis.plot([], [], ".", color=_RETURN, ms=6, label="laser returns")
    axis.plot(*_unbroken(way).T, color=PREDICTION, lw=1.2, zorder=3, label="way of the robot")
    axis.plot(*way[0, :2], "o", color=PREDICTION, mfc="white", ms=8, zorder=4, label="start")


def _unbroken(way: Float64Array) -> Float64Array:
    """Return x and y (n, 2) along the way, NaN where the odometry began anew."""
    places = way[:, :2]
    steps = np.hypot(*np.diff(places, axis=0).T)
    usual = float(np.median(steps)) if steps.size else 0.0
    jumps = np.flatnonzero(steps > max(_JUMP_M, 10 * usual))
    return np.insert(places, jumps + 1, np.nan, axis=0)


def _sides(patches: Sequence[MapPatch]) -> tuple[list[MapPatch], list[MapPatch]]:
    """Share patches out to the left and right of the map, each from the top down.

    Patches near in x to a side go there, so that few lines cross.
    """
    by_x = sorted(patches, key=lambda patch: patch.x_m)
    half = (len(by_x) + 1) // 2
    left, right = (
        sorted(part, key=lambda patch: -patch.y_m) for part in (by_x[:half], by_x[half:])
    )
    return left, right


def _cells(side: "SubFigure", n: int) -> list["Axes"]:
    """Divide a side into fields for n patches, which stay of one size."""
    rows = MOST_PATCHES // 2
    axes = side.subplots(rows, 1, squeeze=False)[:, 0]
    used = [int((index + 0.5) * rows / n) for index in range(n)]
    for axis in np.delete(axes, used):
        axis.set_axis_off()
    return [axes[index] for index in used]


def _look(patch: MapPatch, threshold: float) -> _Look:
    """Return how a patch is framed."""
    if math.isnan(patch.p_obstacle):
        return _NOTHING
    return _OBSTACLE if patch.p_obstacle >= threshold else _FREE


def _draw_patch(axis: "Axes", patch: MapPatch, look: _Look) -> None:
    """Draw the picture of a patch in its frame, its probability below."""
    axis.imshow(patch.picture[:, :, ::-1], interpolation="nearest")
    axis.set(xticks=[], yticks=[])
    for spine in axis.spines.values():
        spine.set(visible=True, color=look[0], linewidth=look[1])
    if not math.isnan(patch.p_obstacle):
        axis.set_xlabel(f"p = {patch.p_obstacle:.2f}", fontsize=10)


def _tie(
    figure: "Figure", axes: tuple["Axes", "Axes"], patch: MapPatch, look: _Look, *, at_left: bool
) -> None:
    """Draw the place of a patch on the map, and the line to its picture."""
    from matplotlib.patches import ConnectionPatch  # noqa: PLC0415  # slow to import

    beside, on_map = axes
    color, _, sign = look
    on_map.plot(patch.x_m, patch.y_m, sign, color=color, mec="white", ms=9, zorder=5)
    line = ConnectionPatch(
        xyA=(1.0 if at_left else 0.0, 0.5),
        coordsA=beside.transAxes,
        xyB=(patch.x_m, patch.y_m),
        coordsB=on_map.transData,
        color=color,
        linewidth=1.0,
        alpha=0.8,
        zorder=4,
    )
    figure.add_artist(line)
