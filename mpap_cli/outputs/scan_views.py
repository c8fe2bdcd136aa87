"""One laser scan seen two ways (Fig. 11): range over angle, and from above."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array, FloatArray, ScanGeometry
from mpap_cli.outputs.canvas import (
    GRID,
    INK,
    PALE_INK,
    Box,
    Color,
    Image,
    draw_circle,
    draw_dots,
    draw_line,
    fill_polygon,
    frame,
    pale,
    put_text,
)

_TOPS_M = (0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 30.0, 50.0, 100.0)
_TICK = 0.5
_BACKWARDS = 100.0
_MARGIN_LEFT = 46
_MARGIN_BOTTOM = 40


@dataclass(frozen=True, eq=False)
class SeenScan:
    """A scan by angle about forward.

    ``angles`` (n,) in degrees, left positive, ascending, and ``ranges`` (n,) in metres,
    NaN where nothing came back.
    """

    angles: Float64Array
    ranges: Float64Array

    @cached_property
    def returned(self) -> BoolArray:
        """Which beams came back."""
        return ~np.isnan(self.ranges)


def see(
    ranges: FloatArray, geometry: ScanGeometry, forward_rad: float, range_max: float | None
) -> SeenScan:
    """Turn a recorded scan so that forward is 0 degrees.

    Parameters
    ----------
    ranges : ndarray of shape (n_beams,)
        Metres as recorded.
    geometry : ScanGeometry
        Where the beams point.
    forward_rad : float
        Direction of travel in the frame of the scanner.
    range_max : float or None
        Replaces the one of the geometry.

    Returns
    -------
    SeenScan
        0, NaN, infinity and what lies outside of range_min and range_max is no return.
    """
    steps = geometry.angle_min + geometry.angle_increment * np.arange(ranges.size)
    turned = np.rad2deg(steps - forward_rad)
    # a beam straight behind counts as 180 degrees left
    angles = 180.0 - np.mod(180.0 - turned, 360.0)
    top = geometry.range_max if range_max is None else range_max
    good = np.isfinite(ranges) & (ranges > 0) & (ranges >= geometry.range_min) & (ranges < top)
    order = np.argsort(angles, kind="stable")
    return SeenScan(angles[order], np.where(good, ranges, np.nan)[order].astype(np.float64))


def common_scale(scans: list[SeenScan]) -> float:
    """Return the range in metres that the views of all scans reach, so that they compare."""
    returned = np.concatenate([scan.ranges[scan.returned] for scan in scans])
    if returned.size == 0:
        return 1.0
    wanted = float(np.quantile(returned, 0.95))
    return next((top for top in _TOPS_M if top >= wanted), _TOPS_M[-1])


def half_view(scans: list[SeenScan]) -> float:
    """Return how many degrees the views reach to each side."""
    widest = max(float(np.abs(scan.angles).max(initial=0.0)) for scan in scans)
    return next(half for half in (45.0, 90.0, 135.0, 180.0, np.inf) if widest <= half + 1.0)


def range_ticks(top_m: float) -> list[float]:
    """Return the ranges that are labelled, without 0.

    >>> range_ticks(5.0)
    [1.0, 2.0, 3.0, 4.0, 5.0]
    """
    step = next(step for step in (0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0) if top_m / step <= 5)  # noqa: PLR2004  # labels that stay apart
    return [step * index for index in range(1, int(top_m / step) + 1)]


def draw_polar(image: Image, box: Box, scan: SeenScan, scale: tuple[float, float, Color]) -> None:
    """Draw range over angle: left beams on the left, no return as a grey tick at the top.

    Parameters
    ----------
    image : Image
        Drawn on.
    box : Box
        Where, with the labels of the axes.
    scan : SeenScan
        The scan.
    scale : tuple
        Highest range in metres, degrees to each side, color.
    """
    top_m, half, color = scale
    plot = Box(
        box.x + _MARGIN_LEFT, box.y, box.width - _MARGIN_LEFT - 6, box.height - _MARGIN_BOTTOM
    )
    _polar_axes(image, plot, top_m, half)
    x = plot.x + (half - scan.angles) / (2 * half) * (plot.width - 1)
    y = plot.bottom - 1 - np.minimum(scan.ranges / top_m, 1.0) * (plot.height - 9)
    for run in runs_of(scan.returned):
        line = np.stack((x[run], y[run]), axis=1)
        ends = np.array([[x[run][-1], plot.bottom - 1], [x[run][0], plot.bottom - 1]])
        fill_polygon(image, np.concatenate((line, ends)), pale(color))
        draw_line(image, line, color, 2)
        if len(line) == 1:
            draw_dots(image, line, color, 1.5)
    for place in x[~scan.returned]:
        draw_line(image, np.array([[place, plot.y + 1], [place, plot.y + 5]]), (150, 150, 150))
    frame(image, plot, PALE_INK)


def _polar_axes(image: Image, plot: Box, top_m: float, half: float) -> None:
    """Draw the grid and the labels of the polar view."""
    for tick in range_ticks(top_m):
        y = plot.bottom - 1 - tick / top_m * (plot.height - 9)
        draw_line(image, np.array([[plot.x, y], [plot.right - 1, y]]), GRID)
        put_text(image, f"{tick:g}", (plot.x - 6, y + 5), size=_TICK, align=1)
    put_text(image, "m", (plot.x - 6, plot.bottom - 1), size=_TICK, color=PALE_INK, align=1)
    step = 90.0 if half > 90.0 else 45.0  # noqa: PLR2004  # right angles where they fit
    for tick in np.arange(-np.floor(half / step), np.floor(half / step) + 1) * step:
        x = plot.x + (half - tick) / (2 * half) * (plot.width - 1)
        draw_line(image, np.array([[x, plot.y], [x, plot.bottom - 1]]), GRID)
        align = 0.5 if abs(tick) < half else (0.15 if tick > 0 else 0.85)
        put_text(image, f"{tick:g}", (x, plot.bottom + 15), size=_TICK, align=align)
    middle = plot.x + plot.width / 2
    words = "left  <  degrees from straight ahead  >  right"
    put_text(image, words, (middle, plot.bottom + 33), size=0.48, color=PALE_INK, align=0.5)


def runs_of(flags: BoolArray) -> list[slice]:
    """Return the unbroken runs of true values.

    >>> runs_of(np.array([True, True, False, True]))
    [slice(0, 2, None), slice(3, 4, None)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False]))))
    return [slice(int(start), int(end)) for start, end in edges.reshape(-1, 2)]


def draw_above(image: Image, box: Box, scan: SeenScan, scale: tuple[float, float, Color]) -> None:
    """Draw the scan from above: the robot at the bottom center, forward up.

    The robot stands higher where the scanner looks backwards too. Parameters as in
    :func:`draw_polar`.
    """
    top_m, half, color = scale
    ahead = 0.68 if half > _BACKWARDS else 0.92
    center = (box.x + box.width / 2, box.y + ahead * box.height)
    per_metre = ahead * box.height / (top_m * 1.04)
    view = np.ascontiguousarray(image[box.y : box.bottom, box.x : box.right])
    origin = np.array((center[0] - box.x, center[1] - box.y))
    angles = np.deg2rad(scan.angles)
    # left of the robot is left in the picture, ahead is up
    beams = np.stack((-np.sin(angles), -np.cos(angles)), axis=1)
    points = origin + per_metre * scan.ranges[:, None] * beams
    for run in runs_of(scan.returned):
        fill_polygon(view, np.concatenate((points[run], origin[None])), pale(color))
    for tick in range_ticks(top_m):
        draw_circle(view, (origin[0], origin[1]), tick * per_metre, (205, 205, 205))
    for tick in range_ticks(top_m):
        place = (origin[0] + 5, origin[1] - tick * per_metre + 14)
        put_text(view, f"{tick:g} m", place, size=_TICK, color=PALE_INK)
    draw_dots(view, points[scan.returned], color, 2.2)
    robot = np.array([[0.0, -13.0], [8.0, 8.0], [0.0, 4.0], [-8.0, 8.0]])
    fill_polygon(view, origin + robot, INK)
    image[box.y : box.bottom, box.x : box.right] = view
    frame(image, box, PALE_INK)
