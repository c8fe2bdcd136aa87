"""A camera at the front of the robot that looks down ahead of it."""

import math
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import Float64Array
from mpap_cli.simulation.lights import LIGHTS
from mpap_cli.simulation.rendering.arrays import Image
from mpap_cli.simulation.rendering.drawing import Renderer
from mpap_cli.simulation.rendering.lens import Mount
from mpap_cli.simulation.rendering.pixels._kernels import add_noise
from mpap_cli.simulation.rendering.scene import body_arrays, floor_maps, join, make_surfaces
from mpap_cli.simulation.world import Body, World, turned_corners

_NOISE_LENGTH = 1 << 20
_DRIFT_S = 10.0


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """One image (h, w, 3), blue first, and what each pixel shows: (h, w), into ``NAMES``."""

    image: Image
    labels: Image


class Camera:
    """Takes images of a world.

    Parameters
    ----------
    world : World
        What there is to see.
    size : tuple of int
        Width and height in pixels.
    looks : tuple of str
        Keys of ``PALETTES`` and of ``LIGHTS``.
    period_s : float
        Time between two images.
    seeds : tuple of int
        Of the world's surfaces, and of noise and exposure.
    """

    def __init__(
        self,
        world: World,
        size: tuple[int, int],
        looks: tuple[str, str],
        period_s: float,
        seeds: tuple[int, int],
    ) -> None:
        palette, light = looks
        self.light = LIGHTS[light]
        self.size = size
        self.focal_px = Mount().focal_px(size[0])
        chance = np.random.default_rng((seeds[0], 7))
        self._bodies = body_arrays(world.bodies, chance)
        maps = floor_maps(world, self.light, chance)
        self._renderer = Renderer(Mount(), size, self.light, make_surfaces(palette), maps)
        self._rng = np.random.default_rng((seeds[1], 8))
        noise = np.rint(self._rng.normal(0.0, self.light.noise, _NOISE_LENGTH))
        self._noise = np.clip(noise, -127, 127).astype(np.int8)
        self._kept = math.exp(-period_s / _DRIFT_S)
        self._drift = 0.0

    def take(self, pose: Float64Array, turn_radps: float, foot_rad: float | None) -> Shot:
        """Take one image, the next of a row: the exposure drifts from one to the next.

        Parameters
        ----------
        pose : ndarray of shape (3,)
            x, y and heading of the robot; metres and radians.
        turn_radps : float
            How fast it turns, which smears the image.
        foot_rad : float or None
            Where a foot touches the robot, to the left of straight ahead.
        """
        import cv2  # noqa: PLC0415  # start-up

        change = self._rng.normal(0.0, self.light.drift * math.sqrt(1 - self._kept**2))
        self._drift = self._drift * self._kept + change
        bodies = self._bodies
        if foot_rad is not None:
            foot = _foot(pose, foot_rad)
            bodies = join(bodies, body_arrays(foot, np.random.default_rng(0)))
        image, labels = self._renderer.draw(bodies, pose, math.exp(self._drift))
        smear = round(abs(turn_radps) * self.light.exposure_s * self.focal_px)
        if smear > 1:
            image = np.asarray(cv2.blur(image, (smear, 1)), np.uint8)
        sigma = 0.2 + 0.6 * self.size[0] / 640
        image = np.asarray(cv2.GaussianBlur(image, (3, 3), sigma), np.uint8)
        add_noise(image, self._noise, int(self._rng.integers(_NOISE_LENGTH)))
        return Shot(image, labels)


def _foot(pose: Float64Array, bearing_rad: float) -> tuple[Body, Body]:
    """Return shoe and leg of somebody whose toes touch the robot."""
    x, y, heading = pose.tolist()
    toward = heading + bearing_rad

    def ahead(distance_m: float) -> tuple[float, float]:
        return x + distance_m * math.cos(toward), y + distance_m * math.sin(toward)

    shoe = tuple(turned_corners(ahead(0.34), (0.28, 0.1), toward))
    leg = Body("foot", (ahead(0.4),), radius_m=0.055, top_m=1.0)
    return Body("foot", shoe, top_m=0.1), leg
