"""Procedural surfaces: tiles of color that can be laid side by side without a seam."""

from collections.abc import Callable, Sequence

import numpy as np

from mpap_cli.observations import Float64Array, IntArray

Color = tuple[float, float, float]
Painter = Callable[[np.random.Generator, int, Sequence[Color]], Float64Array]


def paint(family: str, colors: Sequence[Color], seed: tuple[int, ...], n: int) -> Float64Array:
    """Return one tile of a family.

    Parameters
    ----------
    family : str
        A key of ``FAMILIES``.
    colors : sequence of three colors
        Red, green, blue from 0 to 1: the main one, the second, the one of lines or gaps.
    seed : tuple of int
        Of everything left to chance.
    n : int
        Pixels a side, a multiple of 32.

    Returns
    -------
    ndarray of shape (n, n, 3)
        0 to 1; rows go up, the left edge continues the right one, the top the bottom.
    """
    tile = FAMILIES[family](np.random.default_rng(seed), n, colors)
    return np.asarray(np.clip(tile, 0.0, 1.0))


def clouds(rng: np.random.Generator, n: int, right: float, up: float) -> Float64Array:
    """Return noise of mean 0 and deviation 1 that is smooth over some pixels.

    Parameters
    ----------
    rng : Generator
        Source of the noise.
    n : int
        Pixels a side.
    right, up : float
        How far it is smooth to the right and upward, pixels.
    """
    x = np.fft.rfftfreq(n) * right
    y = np.fft.fftfreq(n) * up
    damped = np.exp(-20.0 * (x[None, :] ** 2 + y[:, None] ** 2))
    damped[0, 0] = 0.0
    smooth = np.fft.irfft2(np.fft.rfft2(rng.normal(size=(n, n))) * damped, s=(n, n))
    return np.asarray(smooth / smooth.std())


def _mix(first: Color, second: Color, share: Float64Array) -> Float64Array:
    """Return the first color where the share is 0, the second where it is 1."""
    part = np.clip(share, 0.0, 1.0)[..., None]
    return np.asarray(np.array(first) * (1 - part) + np.array(second) * part)


def _shade(tile: Float64Array, factor: Float64Array) -> Float64Array:
    return tile * factor[..., None]


def _grid(n: int) -> tuple[Float64Array, Float64Array]:
    """Return how far right and up each pixel is, 0 to 1."""
    up, right = np.mgrid[0:n, 0:n] / n
    return right, up


def _cells(rng: np.random.Generator, n: int, count: int) -> tuple[Float64Array, IntArray]:
    """Return distances (n, n, 2) to the two nearest of random points, and which is nearest."""
    from scipy.spatial import cKDTree  # noqa: PLC0415  # start-up

    points = rng.uniform(0, n, (count, 2))
    pixels = np.indices((n, n)).reshape(2, -1).T
    distances, numbers = cKDTree(points, boxsize=n).query(pixels, k=2)
    return distances.reshape(n, n, 2), numbers[:, 0].reshape(n, n)


def _bond(
    n: int, rows: int, columns: int, joint: float
) -> tuple[Float64Array, IntArray, Float64Array]:
    """Return the share of joint, the number of the brick, and the way along it, per pixel."""
    right, up = _grid(n)
    row = np.floor(up * rows).astype(np.int64)
    along = (right * columns + 0.5 * (row % 2)) % columns
    edge_x = np.minimum(along % 1, 1 - along % 1) / columns
    edge_y = np.minimum(up * rows % 1, 1 - up * rows % 1) / rows
    line = np.clip(1.5 - np.minimum(edge_x, edge_y) / joint, 0.0, 1.0)
    return line, row * columns + np.floor(along).astype(np.int64), along % 1


def _planks(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    line, board, _ = _bond(n, 8, 1, 0.003)
    grain = clouds(rng, n, 90.0, 3.0) + 0.7 * clouds(rng, n, 40.0, 1.0)
    tile = _mix(colors[0], colors[1], 0.35 + 0.22 * grain + rng.uniform(-0.25, 0.25, 8)[board])
    return np.asarray(tile * (1 - line[..., None]) + np.array(colors[2]) * line[..., None])


def _tiles(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    right, up = _grid(n)
    edge = np.minimum.reduce([right * 4 % 1, 1 - right * 4 % 1, up * 4 % 1, 1 - up * 4 % 1])
    line = np.clip(1.5 - edge / 0.02, 0.0, 1.0)
    number = np.floor(up * 4).astype(np.int64) * 4 + np.floor(right * 4).astype(np.int64)
    share = rng.uniform(0, 0.5, 16)[number] + 0.12 * clouds(rng, n, 30.0, 30.0)
    tile = _mix(colors[0], colors[1], share)
    return np.asarray(tile * (1 - line[..., None]) + np.array(colors[2]) * line[..., None])


def _carpet(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    pile = clouds(rng, n, 1.2, 1.2)
    worn = clouds(rng, n, 60.0, 60.0)
    tile = _mix(colors[0], colors[1], 0.45 + 0.3 * pile + 0.1 * worn)
    return _shade(tile, 1.0 + 0.12 * clouds(rng, n, 3.0, 3.0))


def _terrazzo(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    count = 500
    distances, chip = _cells(rng, n, count)
    size = rng.uniform(0.25, 0.75, count)[chip] * n / 22
    inside = np.clip((size - distances[..., 0]) / 1.5, 0.0, 1.0)
    tone = rng.random(count)[chip]
    chips = _mix(colors[1], colors[2], np.round(tone))
    ground = _shade(_mix(colors[0], colors[0], tone), 1.0 + 0.03 * clouds(rng, n, 2.0, 2.0))
    return np.asarray(ground * (1 - inside[..., None]) + chips * inside[..., None])


def _bricks(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    line, brick, _ = _bond(n, 12, 4, 0.007)
    rough = 0.15 * clouds(rng, n, 2.5, 2.5) + 0.1 * clouds(rng, n, 12.0, 12.0)
    tile = _mix(colors[0], colors[1], rng.random(48)[brick] + rough)
    tile = tile * (1 - line[..., None]) + np.array(colors[2]) * line[..., None]
    return _shade(tile, 1.0 + 0.4 * rough)


def _leaves(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    tile = np.broadcast_to(np.array(colors[2]), (n, n, 3)).copy()
    half = n // 14
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    for _ in range(900):
        turn, tone, length = rng.uniform(0, np.pi), rng.random(), rng.uniform(0.5, 1.0) * half
        along = x * np.cos(turn) + y * np.sin(turn)
        across = y * np.cos(turn) - x * np.sin(turn)
        shape = (along / length) ** 2 + (across / (0.28 * length)) ** 2
        rows, columns = (rng.integers(0, n, 2)[:, None] + np.arange(-half, half + 1)) % n
        vein = 1.0 - 0.35 * (np.abs(across) < 0.9)  # noqa: PLR2004  # a pixel or two
        leaf = _shade(_mix(colors[0], colors[1], np.full(shape.shape, tone)), vein)
        at = np.ix_(rows, columns)
        tile[at] = np.where(shape[..., None] < 1, leaf * (1 - 0.35 * shape[..., None]), tile[at])
    return tile


def _corrugated(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    right, _ = _grid(n)
    wave = 0.5 + 0.5 * np.sin(2 * np.pi * 16 * right)
    dirt = np.clip(0.25 * clouds(rng, n, 12.0, 70.0), 0.0, 1.0)
    tile = _mix(colors[1], colors[0], wave**0.7)
    return _mix_tiles(tile, colors[2], dirt)


def _mix_tiles(tile: Float64Array, color: Color, share: Float64Array) -> Float64Array:
    """Lay a color over a tile."""
    return np.asarray(tile * (1 - share[..., None]) + np.array(color) * share[..., None])


def _weave(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    right, up = _grid(n)
    threads = 32
    over = (np.floor(right * threads) + np.floor(up * threads)) % 2
    bulge_x = np.sin(np.pi * (right * threads % 1))
    bulge_y = np.sin(np.pi * (up * threads % 1))
    light = np.where(over > 0, bulge_x, bulge_y) ** 0.6
    slub = 0.1 * np.where(over > 0, clouds(rng, n, 1.0, 60.0), clouds(rng, n, 60.0, 1.0))
    tile = _mix(colors[0], colors[1], over + slub)
    return _mix_tiles(tile, colors[2], np.clip(1.0 - light + slub, 0.0, 0.8))


def _plaster(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    cloud = clouds(rng, n, 50.0, 50.0)
    bumps = clouds(rng, n, 4.0, 4.0)
    tile = _mix(colors[0], colors[1], 0.4 + 0.25 * cloud)
    slope = bumps - np.roll(bumps, 1, axis=0)
    return _shade(_mix_tiles(tile, colors[2], np.clip(0.2 * bumps - 0.3, 0, 1)), 1 + 0.06 * slope)


def _gravel(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    count = 700
    distances, stone = _cells(rng, n, count)
    rim = distances[..., 1] - distances[..., 0]
    gap = np.clip(1.3 - rim / 4.0, 0.0, 1.0)
    tile = _mix(colors[0], colors[1], rng.random(count)[stone])
    tile = _shade(tile, rng.uniform(0.75, 1.15, count)[stone] + 0.06 * clouds(rng, n, 2.0, 2.0))
    return _mix_tiles(tile, colors[2], gap)


def _stripes(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    edges = np.sort(rng.choice(np.arange(1, 85), 23, replace=False)) * n // 85
    bar = np.searchsorted(edges, np.arange(n)) % 3
    tones = np.array(colors)[bar]
    tile = np.broadcast_to(tones, (n, n, 3))
    return _shade(tile, 1.0 + 0.07 * clouds(rng, n, 1.5, 40.0))


def _marble(rng: np.random.Generator, n: int, colors: Sequence[Color]) -> Float64Array:
    fold = clouds(rng, n, 45.0, 45.0) + 0.35 * clouds(rng, n, 12.0, 12.0)
    veins = np.exp(-((fold / 0.12) ** 2)) + 0.5 * np.exp(-(((fold - 0.9) / 0.08) ** 2))
    tile = _mix(colors[0], colors[1], 0.4 + 0.25 * clouds(rng, n, 60.0, 30.0))
    return _mix_tiles(tile, colors[2], veins)


FAMILIES: dict[str, Painter] = {
    "planks": _planks,
    "carpet": _carpet,
    "plaster": _plaster,
    "weave": _weave,
    "tiles": _tiles,
    "terrazzo": _terrazzo,
    "bricks": _bricks,
    "corrugated": _corrugated,
    "gravel": _gravel,
    "leaves": _leaves,
    "stripes": _stripes,
    "marble": _marble,
}
