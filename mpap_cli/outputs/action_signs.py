"""Signs for what the robot does, drawn into the left 60 pixels of a strip 52 pixels high."""

import functools
from collections.abc import Callable

import numpy as np

from mpap_cli.outputs.canvas import INK, Image, draw_line, fill_polygon, probability_color

_STOP = probability_color(1.0)


def _draw_straight(strip: Image) -> None:
    """Draw an arrow ahead."""
    draw_line(strip, np.array([[30.0, 44.0], [30.0, 20.0]]), INK, 5)
    fill_polygon(strip, np.array([[30.0, 6.0], [18.0, 23.0], [42.0, 23.0]]), INK)


def _draw_turn(strip: Image, side: int) -> None:
    """Draw a bent arrow to the left (side -1) or to the right (1)."""
    angles = np.deg2rad(np.linspace(-40, 175, 25))
    mirrored = np.array((-side, 1.0))
    outwards = np.stack((np.cos(angles), -np.sin(angles)), axis=1) * mirrored
    bow = np.array((30.0, 27.0)) + 14 * outwards
    draw_line(strip, bow, INK, 5)
    end, across = bow[-1], outwards[-1]
    ahead = np.array((-np.sin(angles[-1]), -np.cos(angles[-1]))) * mirrored
    fill_polygon(strip, np.stack((end + 13 * ahead, end + 10 * across, end - 10 * across)), INK)


def _draw_stop(strip: Image) -> None:
    """Draw the octagon of a stop sign."""
    corners = np.deg2rad(np.arange(22.5, 360, 45))
    octagon = np.stack((np.cos(corners), np.sin(corners)), axis=1)
    fill_polygon(strip, np.array([30.0, 26.0]) + 20 * octagon, _STOP)
    fill_polygon(strip, np.array([[20.0, 22.5], [40, 22.5], [40, 29.5], [20, 29.5]]), (255,) * 3)


ACTION_SIGNS: dict[str, Callable[[Image], None]] = {
    "straight": _draw_straight,
    "rotate-left": functools.partial(_draw_turn, side=-1),
    "rotate-right": functools.partial(_draw_turn, side=1),
    "stop": _draw_stop,
}
