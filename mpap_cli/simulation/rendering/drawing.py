"""Draws a scene as one camera sees it."""

import math

import numpy as np

from mpap_cli.observations import Float64Array, IntArray
from mpap_cli.simulation.lights import Light
from mpap_cli.simulation.rendering._kernels import draw_pixels
from mpap_cli.simulation.rendering.arrays import Image
from mpap_cli.simulation.rendering.bearings._kernels import list_bins
from mpap_cli.simulation.rendering.lens import N_BINS, Mount, make_rays
from mpap_cli.simulation.rendering.scene import Bodies, FloorMaps, Surfaces

_CURVE_STEPS = 4096
_REACH_M = 45.0


class Renderer:
    """Draws what a camera sees.

    Parameters
    ----------
    mount : Mount
        Place and lens of the camera.
    size : tuple of int
        Width and height in pixels.
    light : Light
        The light, and the settings of the camera.
    surfaces : Surfaces
        What bodies and floors are covered with.
    maps : FloorMaps
        Light and kind of the floor.
    """

    def __init__(
        self,
        mount: Mount,
        size: tuple[int, int],
        light: Light,
        surfaces: Surfaces,
        maps: FloorMaps,
    ) -> None:
        self._mount = mount
        self._light = light
        self._surfaces = surfaces
        self._maps = maps
        self._rays = make_rays(mount, size, light.vignette)
        self._curve = _tone_curve(light.gamma)
        azimuth = math.radians(light.azimuth_deg)
        self._toward = np.array((math.cos(azimuth), math.sin(azimuth)))

    def draw(self, bodies: Bodies, pose: Float64Array, exposure: float) -> tuple[Image, Image]:
        """Return the image and what each pixel shows.

        Parameters
        ----------
        bodies : Bodies
            What stands on the floor.
        pose : ndarray of shape (3,)
            x, y, heading of the robot; metres and radians.
        exposure : float
            Factor on the light.

        Returns
        -------
        image : ndarray of shape (height, width, 3)
            Blue first, sharp and without noise.
        labels : ndarray of shape (height, width)
            Places in ``NAMES``.
        """
        x, y, heading = pose.tolist()
        cosine, sine = math.cos(heading), math.sin(heading)
        eye = (x + self._mount.x_m * cosine, y + self._mount.x_m * sine)
        turn = np.array(((cosine, -sine), (sine, cosine)))
        points = (bodies.points - eye) @ turn
        toward = self._toward @ turn
        half_width_rad = self._rays.half_width_rad
        bins = list_bins(points, bodies.counts, bodies.solids, _REACH_M, half_width_rad, N_BINS)
        lit = self._edge_light(points, bodies.counts, toward)
        image = np.empty((*self._rays.bins.shape, 3), np.uint8)
        labels = np.empty(self._rays.bins.shape, np.uint8)
        surfaces = self._surfaces
        draw_pixels(
            self._rays.table,
            self._rays.bins,
            np.array((*eye, self._mount.z_m, cosine, sine, *self._maps.place)),
            points,
            bodies.counts,
            bodies.solids,
            np.concatenate((bodies.lengths, lit), axis=2),
            bodies.numbers,
            *bins,
            surfaces.densities,
            surfaces.tiles,
            surfaces.level_starts,
            surfaces.detail,
            self._maps.values,
            self._light_values(toward, exposure),
            self._curve,
            image,
            labels,
        )
        return image, labels

    def _edge_light(
        self, points: Float64Array, counts: IntArray, toward: Float64Array
    ) -> Float64Array:
        """Return the light on each edge (n, 4, 1), on the side that the camera sees."""
        following = np.roll(points, -1, axis=1)
        following[np.arange(len(points)), counts - 1] = points[:, 0]
        along = following - points
        normal = np.stack((along[..., 1], -along[..., 0]), axis=-1)
        normal /= np.maximum(np.hypot(normal[..., 0], normal[..., 1]), 1e-9)[..., None]
        behind = (normal * points).sum(axis=-1, keepdims=True) > 0
        normal = np.where(behind, -normal, normal)
        level = math.cos(math.radians(self._light.elevation_deg))
        facing = np.maximum(normal @ toward, 0.0) * level
        return np.asarray(self._light.ambient + self._light.direct * facing)[..., None]

    def _light_values(self, toward: Float64Array, exposure: float) -> Float64Array:
        """Return the light as the kernel takes it; textures hold square roots."""
        light = self._light
        elevation = math.radians(light.elevation_deg)
        on_tops = light.ambient + light.direct * math.sin(elevation)
        aside = light.direct * math.cos(elevation)
        scale = exposure * light.gain * _CURVE_STEPS / 2 * np.array(light.balance[::-1])
        gains = scale * light.color[::-1] / (255 * 256) ** 2
        haze = scale * light.haze[::-1] * light.ambient
        return np.array((on_tops, light.ambient, aside, *toward, light.haze_m, *gains, *haze))


def _tone_curve(gamma: float) -> Image:
    """Return the value of a pixel for light from 0 to 2; bright light is squeezed together."""
    light = np.arange(_CURVE_STEPS) / (_CURVE_STEPS / 2)
    soft = np.where(light < 0.7, light, 0.7 + 0.3 * np.tanh((light - 0.7) / 0.3))  # noqa: PLR2004
    return np.asarray(np.rint(255 * soft ** (1 / gamma)), np.uint8)
