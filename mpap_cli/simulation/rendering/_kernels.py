"""Compiled loop over the pixels of one image.

Things are upright prisms in the frame of the camera's foot (x ahead, y left, floor at 0):
walls of two points, boxes of four corners, round things of one. Each pixel is a ray with a
direction in the plane and a slope; distances ``t`` are along the plane.
"""

import math

import numpy as np
from numba import njit

from mpap_cli.observations import Float32Array, Float64Array, IntArray
from mpap_cli.simulation.rendering.arrays import BinArray, Image, Packed

F32 = Float32Array
F64 = Float64Array
I16 = BinArray
I64 = IntArray
U8 = Image
U32 = Packed

_TINY = 1e-9
_OUTER = 0xFF00FF
_HALF = 128 << 8
_FINER = math.sqrt(2)
_WALL = 2


@njit(nogil=True, cache=True, error_model="numpy")
def _cross(
    points: F64, k: int, count: int, radius: float, dx: float, dy: float
) -> tuple[float, float, int, float]:
    """Return where a ray enters and leaves a thing, by which edge, and how far along it."""
    if count == 1:
        ahead = points[k, 0, 0] * dx + points[k, 0, 1] * dy
        aside = points[k, 0, 0] * dy - points[k, 0, 1] * dx
        rest = radius * radius - aside * aside
        if rest < 0 or ahead < 0:
            return math.inf, -1.0, 0, 0.0
        root = math.sqrt(rest)
        return max(ahead - root, 0.0), ahead + root, 0, -aside / radius
    t_in, t_out = math.inf, -1.0
    edge, share = 0, 0.0
    for i in range(count if count > _WALL else 1):
        j = (i + 1) % count
        ax, ay = points[k, i, 0], points[k, i, 1]
        ex, ey = points[k, j, 0] - ax, points[k, j, 1] - ay
        across = dx * ey - dy * ex
        if abs(across) < _TINY:
            continue
        t = (ax * ey - ay * ex) / across
        s = (ax * dy - ay * dx) / across
        if t <= 0 or s < 0 or s > 1:
            continue
        if t < t_in:
            t_in, edge, share = t, i, s
        t_out = max(t_out, t)
    return t_in, t_out, edge, share


@njit(nogil=True, cache=True, error_model="numpy")
def _texel(tiles: U32, slot: int, first: int, n: int, u: float, v: float) -> tuple[int, int, int]:
    """Return the color at a place (in tiles) of one mip level, in steps of 1/256.

    A texel is a number with 8 bits each of blue, green, red; two of them are weighted at a
    time, with weights that add up to 256.
    """
    x = math.floor(u * (n * 256)) - 128
    y = math.floor(v * (n * 256)) - 128
    fx = x & 255
    fy = y & 255
    c0 = (x >> 8) & (n - 1)
    c1 = (c0 + 1) & (n - 1)
    r0 = (y >> 8) & (n - 1)
    r1 = first + ((r0 + 1) & (n - 1)) * n
    r0 = first + r0 * n
    w11 = (fx * fy) >> 8
    w01 = fx - w11
    w10 = fy - w11
    w00 = 256 - fx - w10
    # unsigned numbers spare the test for places counted from the end
    k = np.uint64(slot)
    a, b = np.int64(tiles[k, np.uint64(r0 + c0)]), np.int64(tiles[k, np.uint64(r0 + c1)])
    c, d = np.int64(tiles[k, np.uint64(r1 + c0)]), np.int64(tiles[k, np.uint64(r1 + c1)])
    outer = w00 * (a & _OUTER) + w01 * (b & _OUTER) + w10 * (c & _OUTER) + w11 * (d & _OUTER)
    green = (
        w00 * ((a >> 8) & 255)
        + w01 * ((b >> 8) & 255)
        + w10 * ((c >> 8) & 255)
        + w11 * ((d >> 8) & 255)
    )
    return int(outer & 0xFFFF), int(green), int(outer >> 16)


@njit(nogil=True, cache=True, error_model="numpy")
def _floor_at(maps: U32, x: float, y: float) -> tuple[int, int]:
    """Return light and kind of the floor between four cells of the maps, likewise."""
    x = min(max(x, 0.0), maps.shape[1] - 1.01)
    y = min(max(y, 0.0), maps.shape[0] - 1.01)
    c = math.floor(x * 256)
    r = math.floor(y * 256)
    fx = c & 255
    fy = r & 255
    c >>= 8
    r >>= 8
    w11 = (fx * fy) >> 8
    w01 = fx - w11
    w10 = fy - w11
    w00 = 256 - fx - w10
    r0, c0, r1, c1 = np.uint64(r), np.uint64(c), np.uint64(r + 1), np.uint64(c + 1)
    both = (
        w00 * np.int64(maps[r0, c0])
        + w01 * np.int64(maps[r0, c1])
        + w10 * np.int64(maps[r1, c0])
        + w11 * np.int64(maps[r1, c1])
    )
    return int(both & 0xFFFF), int(both >> 16)


@njit(nogil=True, cache=True, error_model="numpy")
def draw_pixels(
    rays: F32,
    bins: I16,
    view: F64,
    points: F64,
    counts: I64,
    solids: F64,
    edges: F64,
    numbers: I64,
    near: F64,
    starts: I64,
    members: I64,
    densities: F64,
    tiles: U32,
    level_starts: I64,
    detail: F32,
    maps: U32,
    light: F64,
    curve: U8,
    image: U8,
    labels: U8,
) -> None:
    """Draw every pixel.

    ``rays`` (h, w, 6): direction x, y, 1 / slope, size of a pixel per metre, the same on a
    level surface, light of the lens. ``view``: x, y, height, cosine, sine of the camera;
    x, y, cells per metre and unit of light of the maps. ``solids``, ``edges``: see scene.py.
    ``densities`` (s, 2): tiles and texels per metre. ``light`` (12): on tops, from
    everywhere, direct; x, y toward it in the camera's frame; haze distance; gains and haze
    of blue, green, red.
    """
    height, width = labels.shape
    eye_x, eye_y, eye_z, cosine, sine = view[0], view[1], view[2], view[3], view[4]
    map_x, map_y, per_m = view[5], view[6], view[7]
    on_tops, ambient, direct, toward_x, toward_y = light[0], light[1], light[2], light[3], light[4]
    haze_m, gain_b, gain_g, gain_r = light[5], light[6], light[7], light[8]
    haze_b, haze_g, haze_r = light[9], light[10], light[11]
    size = int(math.sqrt(level_starts[1] - level_starts[0]) + 0.5)
    most = curve.size - 1.0
    n_detail = detail.shape[0]
    map_unit = view[8]
    bright = second = 0
    for row in range(height):
        on_floor = False
        for column in range(width):
            dx, dy = float(rays[row, column, 0]), float(rays[row, column, 1])
            t, z = eye_z * float(rays[row, column, 2]), 0.0
            hit, edge, share = -1, 0, 0.0
            on_top = False
            b = bins[row, column]
            for m in range(starts[b], starts[b + 1]):
                i = members[m]
                if near[i] >= t:
                    break
                t_in, t_out, e, s = _cross(points, i, counts[i], solids[i, 0], dx, dy)
                if t_in >= t:
                    continue
                slope = 1 / float(rays[row, column, 2])
                z_in = eye_z - t_in * slope
                top = solids[i, 2]
                if z_in <= top:
                    if z_in >= solids[i, 1]:
                        t, z, hit, on_top, edge, share = t_in, z_in, i, False, e, s
                else:
                    t_top = (eye_z - top) / slope
                    if t_top <= t_out and t_top < t:
                        t, z, hit, on_top = t_top, top, i, True
            x = eye_x + t * (dx * cosine - dy * sine)
            y = eye_y + t * (dx * sine + dy * cosine)
            u, v, pixel = x, y, t * rays[row, column, 4]
            tint_b = tint_g = tint_r = 1.0
            if hit < 0:
                # neighbors on the floor share a place of the map, whose cells are larger
                if column % 2 == 0 or not on_floor:
                    bright, second = _floor_at(maps, (x - map_x) * per_m, (y - map_y) * per_m)
                on_floor = True
                lit = bright * map_unit
                slot = 1 if second >= _HALF else 0
                labels[row, column] = slot
            else:
                on_floor = False
                slot = int(solids[hit, 7])
                labels[row, column] = numbers[hit]
                tint_b, tint_g, tint_r = solids[hit, 3], solids[hit, 4], solids[hit, 5]
                if on_top:
                    lit = on_tops
                else:
                    v, pixel = z, t * rays[row, column, 3]
                    if counts[hit] == 1:
                        across = math.sqrt(max(1 - share * share, 0.0))
                        nx, ny = -across * dx - share * dy, share * dx - across * dy
                        lit = ambient + direct * max(nx * toward_x + ny * toward_y, 0.0)
                        u = solids[hit, 6] + solids[hit, 0] * math.asin(share)
                    else:
                        lit = edges[hit, edge, 2]
                        u = solids[hit, 6] + edges[hit, edge, 0] + share * edges[hit, edge, 1]
                    # the foot of a thing is darker
                    lit *= 0.65 + 0.35 * min(z * 4.0, 1.0)
            pixel *= densities[slot, 1]
            if pixel < 1:
                # nearer than the texture is fine, the surface has a grain
                c = math.floor(u * 4000.0) & (n_detail - 1)
                r = math.floor(v * 4000.0) & (n_detail - 1)
                lit *= 1 + detail[r, c] * (1 - pixel)
            # a sum, since a loop that ends at random costs more than its comparisons
            level = int(pixel > _FINER) + int(pixel > 2 * _FINER) + int(pixel > 4 * _FINER)
            level += int(pixel > 8 * _FINER) + int(pixel > 16 * _FINER)
            level += int(pixel > 32 * _FINER) + int(pixel > 64 * _FINER)
            u *= densities[slot, 0]
            v *= densities[slot, 0]
            blue, green, red = _texel(tiles, slot, level_starts[level], size >> level, u, v)
            clear = haze_m / (haze_m + t)
            lit *= clear * rays[row, column, 5]
            haze = (1 - clear) * rays[row, column, 5]
            blue = tint_b * blue * blue * lit * gain_b + haze * haze_b
            green = tint_g * green * green * lit * gain_g + haze * haze_g
            red = tint_r * red * red * lit * gain_r + haze * haze_r
            image[row, column, 0] = curve[np.uint64(min(blue, most))]
            image[row, column, 1] = curve[np.uint64(min(green, most))]
            image[row, column, 2] = curve[np.uint64(min(red, most))]
