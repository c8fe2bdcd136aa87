"""The compiled loop draws what a plain ray against every thing sees."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from mpap_cli.observations import Float64Array
from mpap_cli.simulation.lights import LIGHTS
from mpap_cli.simulation.palettes import NAMES
from mpap_cli.simulation.rendering import _kernels, drawing
from mpap_cli.simulation.rendering.arrays import Image
from mpap_cli.simulation.rendering.bearings import _kernels as bearings
from mpap_cli.simulation.rendering.drawing import Renderer
from mpap_cli.simulation.rendering.lens import Mount
from mpap_cli.simulation.rendering.scene import (
    Bodies,
    Surfaces,
    body_arrays,
    floor_maps,
    make_surfaces,
)
from mpap_cli.simulation.world import Body, World, WorldBuilder, turned_corners

SIZE = (40, 30)
SLOW_SIZE = (8, 6)


def make_world() -> World:
    """Return a room with a box, a low step, a post and a seat on thin air."""
    builder = WorldBuilder(np.random.default_rng(1))
    builder.add_line("wall", [(-2, -2), (4, -2), (4, 2), (-2, 2), (-2, -2)])
    builder.add_box("box", (1.6, 0.5), (0.5, 0.4), 0.4)
    builder.add_box("low step", (1.0, -0.4), (0.4, 0.2), -0.2)
    builder.add_circle("table leg", (2.2, -0.5), 0.05)
    seat = tuple(turned_corners((2.6, 0.0), (0.4, 0.4), 0.3))
    builder.bodies.append(Body("chair seat", seat, bottom_m=0.41))
    builder.rooms.append((1.2, -2.0, 4.0, 2.0))
    return builder.build((-1, -1, 0, 1))


def make_renderer(world: World, size: tuple[int, int], surfaces: Surfaces) -> Renderer:
    """Return a renderer of the world in daylight."""
    maps = floor_maps(world, LIGHTS["day"], np.random.default_rng(2))
    return Renderer(Mount(), size, LIGHTS["day"], surfaces, maps)


def draw_plainly(inputs: tuple[Any, ...]) -> tuple[Image, Image]:
    """Draw pixel by pixel, asking every thing, with real numbers throughout."""
    rays, _, view, points, counts, solids, edges, numbers, _, _, _, densities, *rest = inputs
    tiles, level_starts, detail, maps, light, curve, _, labels = rest
    image = np.zeros((*labels.shape, 3), np.uint8)
    shown = np.zeros_like(labels)
    on_floor, cell = False, np.zeros(2)
    for row, column in np.ndindex(*labels.shape):
        dx, dy, flat, pixel, stretched, lens = rays[row, column].astype(float)
        slope = 1 / flat
        direction = np.array((dx, dy))
        t, z, hit = view[2] / slope, 0.0, None
        for i in range(len(counts)):
            enter, leave, edge, share = cross(points[i, : counts[i]], solids[i, 0], direction)
            z_in = view[2] - enter * slope
            t_top = (view[2] - solids[i, 2]) / slope
            if enter < t and solids[i, 1] <= z_in <= solids[i, 2]:
                t, z, hit = enter, z_in, (i, edge, share)
            elif enter < t_top <= leave and t_top < t:
                t, z, hit = t_top, solids[i, 2], (i, -1, 0.0)
        x = view[0] + t * (dx * view[3] - dy * view[4])
        y = view[1] + t * (dx * view[4] + dy * view[3])
        u, v, width_m, tint = x, y, t * stretched, np.ones(3)
        if hit is None:
            if column % 2 == 0 or not on_floor:
                cell = maps_at(maps, (x - view[5]) * view[7], (y - view[6]) * view[7])
            lit, slot = cell[0] * 256 * view[8], int(cell[1] >= 128)
            shown[row, column] = slot
        else:
            i, edge, share = hit
            slot, tint, shown[row, column] = int(solids[i, 7]), solids[i, 3:6], numbers[i]
            lit = light[0]
            if edge >= 0:
                v, width_m = z, t * pixel
                if counts[i] == 1:
                    normal = (direction * t - points[i, 0]) / solids[i, 0]
                    lit = light[1] + light[2] * max(normal @ light[3:5], 0.0)
                    u = solids[i, 6] + solids[i, 0] * math.asin(share)
                else:
                    u = solids[i, 6] + edges[i, edge, 0] + share * edges[i, edge, 1]
                    lit = edges[i, edge, 2]
                lit *= 0.65 + 0.35 * min(4 * z, 1.0)
        texels = width_m * densities[slot, 1]
        if texels < 1:
            c, r = (math.floor(w * 4000) % len(detail) for w in (u, v))
            lit *= 1 + detail[r, c] * (1 - texels)
        level = min(max(math.ceil(math.log2(texels) - 0.5), 0), 7)
        color = texel(
            tiles[slot], level_starts, level, u * densities[slot, 0], v * densities[slot, 0]
        )
        clear = light[5] / (light[5] + t)
        reflected = tint * (color * 256) ** 2 * lit * clear * light[6:9] + (1 - clear) * light[9:12]
        on_floor = hit is None
        image[row, column] = curve[np.minimum(reflected * lens, len(curve) - 1).astype(int)]
    return image, shown


def cross(
    points: Float64Array, radius: float, direction: Float64Array
) -> tuple[float, float, int, float]:
    """Return where a ray enters and leaves a thing, by which edge, and where on it."""
    if len(points) == 1:
        ahead, aside = points[0] @ direction, points[0] @ (direction[1], -direction[0])
        if abs(aside) > radius or ahead < 0:
            return math.inf, -1.0, 0, 0.0
        half = math.sqrt(radius**2 - aside**2)
        return max(ahead - half, 0.0), ahead + half, 0, -aside / radius
    crossings = []
    for i in range(len(points) if len(points) > 2 else 1):
        along = points[(i + 1) % len(points)] - points[i]
        matrix = np.array((direction, -along)).T
        if abs(np.linalg.det(matrix)) > 1e-9:
            t, s = np.linalg.solve(matrix, points[i])
            if t > 0 and 0 <= s <= 1:
                crossings.append((t, i, s))
    if not crossings:
        return math.inf, -1.0, 0, 0.0
    return min(crossings)[0], max(crossings)[0], *min(crossings)[1:]


def texel(tile: Any, starts: Any, level: int, u: float, v: float) -> Float64Array:
    """Return blue, green, red between four texels of a mip level."""
    n = 512 >> level
    plane = tile[starts[level] : starts[level + 1]].reshape(n, n)
    channels = np.stack((plane & 255, plane >> 8 & 255, plane >> 16), axis=2).astype(float)
    x, y = u * n - 0.5, v * n - 0.5
    c, r = math.floor(x), math.floor(y)
    weights = ((1 - (y - r), 1 - (x - c)), (y - r, x - c))
    color = np.zeros(3)
    for i, j in np.ndindex(2, 2):
        color += weights[i][0] * weights[j][1] * channels[(r + i) % n, (c + j) % n]
    return color


def maps_at(maps: Any, x: float, y: float) -> Float64Array:
    """Return light and kind of the floor between four cells."""
    both = np.stack((maps & 0xFFFF, maps >> 16), axis=2).astype(float)
    c, r = int(x), int(y)
    low = both[r, c] * (1 - (x - c)) + both[r, c + 1] * (x - c)
    high = both[r + 1, c] * (1 - (x - c)) + both[r + 1, c + 1] * (x - c)
    return np.asarray(low * (1 - (y - r)) + high * (y - r))


@pytest.fixture(scope="module")
def surfaces() -> Surfaces:
    """Return the surfaces of one palette."""
    return make_surfaces("a")


@pytest.mark.parametrize(
    "pose", [(0.0, 0.0, 0.0), (0.9, 0.6, -0.4), (0.4, -0.35, 0.1), (3.8, 0.0, 0.0), (0, 0, 3.1)]
)
def test_every_pixel_is_what_a_plain_ray_meets(
    pose: tuple[float, float, float], surfaces: Surfaces, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Labels are equal but for rims, colors within 3 of 255, from afar and in contact."""
    world = make_world()
    renderer = make_renderer(world, SIZE, surfaces)
    bodies = body_arrays(world.bodies, np.random.default_rng(3))
    calls: list[tuple[Any, ...]] = []

    def draw(*inputs: Any) -> None:
        calls.append(inputs)
        _kernels.draw_pixels(*inputs)

    monkeypatch.setattr(drawing, "draw_pixels", draw)

    image, labels = renderer.draw(bodies, np.array(pose), 1.0)

    plain_image, plain_labels = draw_plainly(calls[0])
    same = labels == plain_labels
    off = np.abs(image.astype(int) - plain_image.astype(int)).max(axis=2)
    assert same.mean() > 0.995
    assert np.mean(off[same] <= 3) > 0.98
    assert off[same].mean() < 1


def test_things_are_seen_over_and_under(surfaces: Surfaces) -> None:
    """Behind a low step and under a seat there is floor; a wall hides what is behind it."""
    world = make_world()
    renderer = make_renderer(world, SIZE, surfaces)
    bodies = body_arrays(world.bodies, np.random.default_rng(3))

    _, labels = renderer.draw(bodies, np.array((0.0, -0.4, 0.0)), 1.0)
    _, nearer = renderer.draw(bodies, np.array((1.4, 0.0, 0.0)), 1.0)

    column = [NAMES[label] for label in labels[:, SIZE[0] // 2]]
    order = [name for name, before in zip(column, ["", *column], strict=False) if name != before]
    rows, columns = np.nonzero(nearer == NAMES.index("chair seat"))
    below = {NAMES[label] for label in nearer[rows.max() + 1 :, columns[rows.argmax()]]}
    assert order == ["wall", "floor2", "low step", "floor"]
    assert below == {"wall", "floor2"}


def test_nothing_at_all_may_stand_there(surfaces: Surfaces) -> None:
    """A floor without any thing is drawn up to the horizon."""
    world = make_world()
    renderer = make_renderer(world, SIZE, surfaces)
    bodies = body_arrays(world.bodies, np.random.default_rng(3))
    none = Bodies(*(getattr(bodies, field.name)[:0] for field in dataclasses.fields(Bodies)))

    _, labels = renderer.draw(none, np.zeros(3), 1.0)

    assert set(labels.ravel()) <= {0, 1}


def test_loops_do_the_same_uncompiled(surfaces: Surfaces, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiled and plain Python draw the same few pixels."""
    world = make_world()
    renderer = make_renderer(world, SLOW_SIZE, surfaces)
    bodies = body_arrays(world.bodies, np.random.default_rng(3))
    poses = [np.array(pose) for pose in ((0.0, 0.0, 0.0), (0.7, 0.0, 0.3), (3.8, 0.0, 0.0))]
    compiled = [renderer.draw(bodies, pose, 1.0) for pose in poses]
    for module in (_kernels, bearings):
        for name in dir(module):
            kernel = getattr(module, name)
            if hasattr(kernel, "py_func"):
                monkeypatch.setattr(module, name, kernel.py_func)
    monkeypatch.setattr(drawing, "draw_pixels", _kernels.draw_pixels)

    plain = [renderer.draw(bodies, pose, 1.0) for pose in poses]

    for (image, labels), (plain_image, plain_labels) in zip(compiled, plain, strict=True):
        np.testing.assert_array_equal(labels, plain_labels)
        np.testing.assert_array_equal(image, plain_image)
