"""Clusterings of points in the plane, side by side (Fig. 8)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpap_cli.observations import FloatArray, IntArray
from mpap_cli.outputs.figures import figure_for, plain

_NOISE, _RING = "#B4B4B4", "#222222"
_A_ROW = 2


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """Points (n, 2) with the cluster of each (n,), -1 for noise.

    ``meta_points`` (m, 2) are drawn as circles of ``radius``; None without any.
    """

    title: str
    points: FloatArray
    labels: IntArray
    meta_points: FloatArray | None = None
    radius: float = 0.0


def plot_planes(path: Path, planes: Sequence[Plane]) -> None:
    """Draw each clustering in a panel of its own, two in a row (Fig. 8).

    Parameters
    ----------
    path : Path
        PNG to write.
    planes : sequence of Plane
        At least one.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    from matplotlib import colormaps  # noqa: PLC0415  # slow to import
    from matplotlib.collections import EllipseCollection  # noqa: PLC0415

    n_rows = math.ceil(len(planes) / _A_ROW)
    shades = colormaps["tab20"]
    with figure_for(path, (5.4 * _A_ROW, 5.3 * n_rows)) as figure:
        axes = figure.subplots(n_rows, _A_ROW, squeeze=False).ravel().tolist()
        for axis, plane in zip(axes, planes, strict=False):
            known = plane.labels >= 0
            axis.scatter(*plane.points[~known].T, s=3, color=_NOISE, lw=0)
            # neighboring numbers get unlike colors
            shade = shades(plane.labels[known] * 7 % 20)
            axis.scatter(*plane.points[known].T, s=4, c=shade, lw=0)
            if plane.meta_points is not None:
                wide = np.full(len(plane.meta_points), 2 * plane.radius)
                rings = EllipseCollection(
                    wide.tolist(),
                    wide.tolist(),
                    np.zeros(wide.size).tolist(),
                    units="xy",
                    offsets=plane.meta_points.tolist(),
                    offset_transform=axis.transData,
                    facecolors="none",
                    edgecolors=_RING,
                    linewidths=0.7,
                )
                axis.add_collection(rings)
            axis.set_title(plain(plane.title), fontsize=11)
            axis.set_aspect("equal")
        for axis in axes[len(planes) :]:
            axis.set_axis_off()
