"""Where the pixels of a camera look, as seen from the floor below it."""

import math
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import Float32Array
from mpap_cli.simulation.rendering.arrays import BinArray

N_BINS = 512
_SHALLOWEST = 0.012


@dataclass(frozen=True, slots=True, kw_only=True)
class Mount:
    """Place and lens of the camera on the robot (base_link: x ahead, z up).

    With 62 degrees across, a 4:3 image sees the floor from 0.4 m ahead of the camera to
    just below the horizon.
    """

    x_m: float = 0.12
    z_m: float = 0.5
    pitch_rad: float = math.radians(26)
    across_rad: float = math.radians(62)

    def focal_px(self, width: int) -> float:
        """Return the focal length in pixels of an image of this width.

        >>> round(Mount().focal_px(640))
        533
        """
        return width / 2 / math.tan(self.across_rad / 2)


@dataclass(frozen=True, slots=True, eq=False)
class Rays:
    """Pixel by pixel: ``table`` (h, w, 6) as the renderer takes it, ``bins`` (h, w).

    A bin is one of ``N_BINS`` of the bearings from -``half_width_rad`` to it.
    """

    table: Float32Array
    bins: BinArray
    half_width_rad: float


def make_rays(mount: Mount, size: tuple[int, int], vignette: float) -> Rays:
    """Return the rays of every pixel.

    Parameters
    ----------
    mount : Mount
        Height, pitch and width of view.
    size : tuple of int
        Width and height in pixels.
    vignette : float
        Share of the light that is lost in a corner of a 4:3 image.
    """
    width, height = size
    focal = mount.focal_px(width)
    right = ((np.arange(width) + 0.5 - width / 2) / focal)[None, :]
    down = ((np.arange(height) + 0.5 - height / 2) / focal)[:, None]
    cosine, sine = math.cos(mount.pitch_rad), math.sin(mount.pitch_rad)
    ahead = cosine - down * sine + 0 * right
    left = -right + 0 * down
    level = np.hypot(ahead, left)
    # nothing is above the horizon, so that every ray ends at the floor
    slope = np.maximum((sine + down * cosine) / level, _SHALLOWEST)
    # a random level of detail between two hides where one ends and the next begins
    jitter = 2 ** np.random.default_rng(0).uniform(-0.5, 0.5, (height, width))
    pixel = jitter * np.sqrt(1 + slope**2) / focal
    # on the floor a pixel is longer than wide: take what is between
    stretched = pixel * np.sqrt(np.sqrt(1 + slope**2) / slope)
    corner2 = (1 + 0.75**2) * (width / 2 / focal) ** 2
    lens = 1 - vignette * (right**2 + down**2) / corner2
    bearing = np.arctan2(left, ahead)
    half_width = float(np.abs(bearing).max()) + 0.01
    bins = np.floor((bearing + half_width) * N_BINS / (2 * half_width)).astype(np.int16)
    table = np.stack((ahead / level, left / level, 1 / slope, pixel, stretched, lens), axis=2)
    return Rays(table.astype(np.float32), bins, half_width)
