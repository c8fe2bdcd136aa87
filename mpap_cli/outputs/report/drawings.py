"""Small pictures inside the page: scans from above as SVG, photographs as data."""

import base64

import numpy as np
from markupsafe import Markup

from mpap_cli.observations import FloatArray
from mpap_cli.outputs.canvas import probability_color
from mpap_cli.outputs.scan_views import range_ticks, runs_of

_SIDE = 200
_BACKWARDS = 100.0


def data_uri(jpeg: bytes) -> str:
    """Return an encoded image as the address of a picture, empty for none."""
    return f"data:image/jpeg;base64,{base64.b64encode(jpeg).decode()}" if jpeg else ""


def color_of(p: float | None) -> str:
    """Return the color of a probability for a style sheet, grey without one.

    >>> color_of(None)
    'rgb(140 140 140)'
    """
    blue, green, red = probability_color(np.nan if p is None else p)
    return f"rgb({red} {green} {blue})"


def scan_svg(angles: FloatArray, ranges: FloatArray, top_m: float, label: str) -> Markup:
    """Draw a scan from above: the robot drives up.

    Parameters
    ----------
    angles, ranges : ndarray of shape (n,)
        Degrees about forward, left positive, ascending; metres, NaN without return.
    top_m : float
        Range that the picture reaches ahead.
    label : str
        What it shows, for those who hear it.

    Returns
    -------
    Markup
        An SVG element that takes its color from ``--c``.
    """
    ahead = 0.66 if np.abs(angles).max(initial=0.0) > _BACKWARDS else 0.9
    x0, y0, scale = _SIDE / 2, ahead * _SIDE, ahead * _SIDE / (1.04 * top_m)
    turned = np.deg2rad(angles)
    reach = scale * np.minimum(np.nan_to_num(ranges, nan=0.0), 4 * top_m)
    # left of the robot is left in the picture, ahead is up
    x, y = x0 - reach * np.sin(turned), y0 - reach * np.cos(turned)
    returned = ~np.isnan(ranges)
    points = [f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True)]
    rings = "".join(
        f'<circle class="ring" cx="{x0:g}" cy="{y0:g}" r="{tick * scale:.1f}"/>'
        f'<text x="{x0 + 3:g}" y="{y0 - tick * scale + 11:.1f}">{tick:g} m</text>'
        for tick in range_ticks(top_m)
    )
    free = "".join(
        f'<polygon class="free" points="{x0:g},{y0:g} {" ".join(points[run])}"/>'
        for run in runs_of(returned)
    )
    hits = "".join(f"M{point}h0" for point, back in zip(points, returned, strict=True) if back)
    dots = f'<path class="hit" d="{hits}"/>'
    robot = f'<path class="robot" d="M{x0:g} {y0 - 9:g} l6 15 l-6 -3 l-6 3 z"/>'
    return Markup(  # noqa: S704  # numbers, and a label that is escaped here
        f'<svg class="scan" viewBox="0 0 {_SIDE} {_SIDE}" role="img" aria-label="{{}}">'
        f"{free}{rings}{dots}{robot}</svg>"
    ).format(label)
