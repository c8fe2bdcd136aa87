"""A world as arrays for the renderer: bodies, surfaces, and a map of the light on the floor."""

import math
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from mpap_cli.observations import Float32Array, Float64Array, IntArray
from mpap_cli.simulation.lights import Light
from mpap_cli.simulation.palettes import NAMES, PALETTES, surface_of
from mpap_cli.simulation.rendering.arrays import Image, Packed
from mpap_cli.simulation.textures import clouds, paint
from mpap_cli.simulation.world import MATERIALS, Body, World

TILE = 512
_LOWEST_LEVEL = 4
_MARGIN_M = 0.5
_MOST_LIGHT = 2.0
_LONGEST_SHADOW_M = 1.2
_ROUND_CORNERS = 12
_HEIGHT_SPREAD = {"box": 0.3, "rock": 0.4, "bush": 0.4, "grass": 0.4, "shelf": 0.2}


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """Everything that stands on the floor, in the frame of the world.

    ``points`` (n, 4, 2) with ``counts`` (n,) of them in use; ``solids`` (n, 8): radius,
    bottom, top, tint of blue, green, red, where the texture begins, surface;
    ``lengths`` (n, 4, 2): length of the edges before and of each edge; ``numbers`` (n,):
    place of the material in ``NAMES``.
    """

    points: Float64Array
    counts: IntArray
    solids: Float64Array
    lengths: Float64Array
    numbers: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """The textures of a palette: tiles (s, texels), mip levels one after the other.

    A texel has 8 bits each of blue, green and red, the square root of what is reflected.
    """

    tiles: Packed
    level_starts: IntArray
    densities: Float64Array
    detail: Float32Array


@dataclass(frozen=True, slots=True, eq=False)
class FloorMaps:
    """The floor cell by cell (h, w): 16 bits of light, 16 bits of which floor it is.

    Both are 0 to 255; from 128 on it is the second floor. ``place``: x, y of the first
    cell, cells per metre, unit of light (per 1/256).
    """

    values: Packed
    place: Float64Array


def body_arrays(bodies: tuple[Body, ...], rng: np.random.Generator) -> Bodies:
    """Return bodies as arrays; their heights and tints differ a little by chance."""
    n = len(bodies)
    points = np.zeros((n, 4, 2))
    solids = np.zeros((n, 8))
    lengths = np.zeros((n, 4, 2))
    for i, body in enumerate(bodies):
        high, bright, begin = rng.random(3)
        corners = np.array(body.points)
        points[i, : len(corners)] = corners
        if len(corners) > 1:
            along = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
            lengths[i, : len(corners), 1] = along
            lengths[i, : len(corners), 0] = np.cumsum(along) - along
        spread = _HEIGHT_SPREAD.get(body.name, 0.0)
        top = MATERIALS[body.name].height_m if body.top_m is None else body.top_m
        top *= 1 + spread * (2 * high - 1)
        slot, tint = surface_of(body.name)
        tints = np.array(tint[::-1]) * (0.9 + 0.2 * bright)
        solids[i] = (body.radius_m, body.bottom_m, top, *tints, 3 * begin, slot)
    counts = np.array([len(body.points) for body in bodies], np.int64)
    numbers = np.array([NAMES.index(body.name) for body in bodies], np.int64)
    return Bodies(points, counts, solids, lengths, numbers)


def join(first: Bodies, second: Bodies) -> Bodies:
    """Return the bodies of both."""
    pairs = [(getattr(first, field.name), getattr(second, field.name)) for field in fields(Bodies)]
    return Bodies(*(np.concatenate(pair) for pair in pairs))


def make_surfaces(palette: str) -> Surfaces:
    """Return the textures of a palette with their mip levels, blue first."""
    looks = PALETTES[palette]
    tiles, starts = [], [0]
    for i, look in enumerate(looks):
        level = paint(look.family, look.colors, (ord(palette), i), TILE)[..., ::-1]
        levels = [level]
        while level.shape[0] > _LOWEST_LEVEL:
            n = level.shape[0] // 2
            level = np.sqrt((level.reshape(n, 2, n, 2, 3) ** 2).mean(axis=(1, 3)))
            levels.append(level)
        tiles.append(np.concatenate([level.reshape(-1, 3) for level in levels]))
        starts = [0, *np.cumsum([level.shape[0] ** 2 for level in levels]).tolist()]
    per_m = np.array([1 / look.tile_m for look in looks])
    detail = 0.06 * clouds(np.random.default_rng(ord(palette)), 256, 2.0, 2.0)
    channels = np.rint(np.array(tiles) * 255).astype(np.int64)
    return Surfaces(
        tiles=(channels * (1, 1 << 8, 1 << 16)).sum(axis=2).astype(np.uint32),
        level_starts=np.array(starts, np.int64),
        densities=np.stack((per_m, per_m * TILE), axis=1),
        detail=detail.astype(np.float32),
    )


def floor_maps(world: World, light: Light, rng: np.random.Generator) -> FloorMaps:
    """Return the light on the floor: dark near things, shadows to one side, pools of light."""
    import cv2  # noqa: PLC0415  # start-up

    ends = np.array([point for body in world.bodies for point in body.points])
    low, high = ends.min(axis=0) - _MARGIN_M, ends.max(axis=0) + _MARGIN_M
    cell_m = max(0.04, float((high - low).max()) / 700)
    width, height = (int(n) for n in np.ceil((high - low) / cell_m) + 1)
    stands = np.full((height, width), 255, np.uint8)
    shadow = np.zeros((height, width), np.uint8)
    azimuth, elevation = math.radians(light.azimuth_deg), math.radians(light.elevation_deg)
    away = -np.array((math.cos(azimuth), math.sin(azimuth))) / math.tan(elevation)
    for body in world.bodies:
        outline = _outline(body)
        reach = min(MATERIALS[body.name].height_m, _LONGEST_SHADOW_M) * away
        _fill(stands, (outline - low) / cell_m, 0)
        _fill(shadow, (np.concatenate((outline, outline + reach)) - low) / cell_m, 255)
    gap_m = cv2.distanceTransform(stands, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * cell_m
    open_sky = 0.5 + 0.5 * np.minimum(gap_m / 0.3, 1.0)
    shade = cv2.GaussianBlur(shadow, (0, 0), 0.05 / cell_m) / 255
    pools = 1 + 0.12 * clouds(rng, max(width, height), 2.0 / cell_m, 2.0 / cell_m)
    direct = light.direct * math.sin(elevation) * (1 - 0.85 * shade)
    lit = (light.ambient * open_sky + direct) * pools[:height, :width]
    second = _second_floor(world, (height, width), low, cell_m, rng)
    place = np.array((*low, 1 / cell_m, _MOST_LIGHT / 255 / 256))
    bright = np.rint(np.clip(lit / _MOST_LIGHT, 0.0, 1.0) * 255).astype(np.uint32)
    kind = np.rint(np.clip(second, 0.0, 1.0) * 255).astype(np.uint32)
    return FloorMaps(bright | kind << 16, place)


def _outline(body: Body) -> Float64Array:
    """Return corners of what a body covers of the floor."""
    if len(body.points) > 1:
        return np.array(body.points)
    turns = np.arange(_ROUND_CORNERS) * (2 * math.pi / _ROUND_CORNERS)
    around = np.stack((np.cos(turns), np.sin(turns)), axis=1)
    return np.asarray(np.array(body.points[0]) + body.radius_m * around)


def _fill(mask: Image, points: Any, value: int) -> None:
    """Fill the convex hull of points, given in cells, and its rim."""
    import cv2  # noqa: PLC0415  # start-up

    hull = cv2.convexHull(np.rint(points).astype(np.int32))
    cv2.fillConvexPoly(mask, hull, value)
    cv2.polylines(mask, [hull], isClosed=True, color=value)


def _second_floor(
    world: World,
    shape: tuple[int, int],
    low: Float64Array,
    cell_m: float,
    rng: np.random.Generator,
) -> Float64Array:
    """Return where the second floor lies: some rooms, or else patches in the open."""
    if not world.rooms:
        patches = clouds(rng, max(shape), 8.0 / cell_m, 8.0 / cell_m)
        return np.asarray(0.5 + 0.25 * patches[: shape[0], : shape[1]])
    y, x = np.mgrid[0 : shape[0], 0 : shape[1]] * cell_m
    second = np.zeros(shape)
    for x0, y0, x1, y1 in world.rooms:
        inside = np.minimum.reduce(
            [x + low[0] - x0, x1 - x - low[0], y + low[1] - y0, y1 - y - low[1]]
        )
        second = np.maximum(second, np.clip(0.5 + 0.5 * inside / cell_m, 0.0, 1.0))
    return second
