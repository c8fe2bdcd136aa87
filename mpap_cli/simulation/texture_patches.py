"""Labelled image patches of procedural surfaces: the six classes of section 5.1.1."""

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from mpap_cli.observations import Float64Array, IntArray
from mpap_cli.simulation.textures import Color, paint

Image = NDArray[np.uint8]
PATCH_SIZE = (40, 52)
N_A_CLASS = 200
N_PHOTOGRAPHS = 2
_SIDE = 256
_SIGMA = 0.02


class _Surface(NamedTuple):
    """A family of textures with its colors, and how large it is seen: pixels over the tile's."""

    family: str
    colors: tuple[Color, Color, Color]
    zoom: float


SURFACES: dict[str, _Surface] = {
    "brick": _Surface("bricks", ((0.56, 0.28, 0.20), (0.66, 0.40, 0.30), (0.66, 0.62, 0.56)), 0.9),
    "asphalt": _Surface(
        "gravel", ((0.40, 0.40, 0.40), (0.52, 0.51, 0.49), (0.28, 0.28, 0.28)), 0.5
    ),
    "tree": _Surface("planks", ((0.34, 0.27, 0.21), (0.50, 0.43, 0.35), (0.16, 0.13, 0.11)), 1.0),
    "grass": _Surface("leaves", ((0.22, 0.38, 0.12), (0.44, 0.54, 0.22), (0.12, 0.18, 0.07)), 0.5),
    "wood chips": _Surface(
        "leaves", ((0.50, 0.38, 0.24), (0.70, 0.56, 0.38), (0.24, 0.17, 0.11)), 0.9
    ),
    "red concrete": _Surface(
        "plaster", ((0.60, 0.34, 0.28), (0.68, 0.43, 0.36), (0.50, 0.28, 0.24)), 1.0
    ),
}
"""What each class is painted with; of two photographs the colors differ a little."""


class TexturePatches(NamedTuple):
    """``patches`` (n, 40, 52, 3) BGR, ``classes`` (n,) into ``class_names``; class by class."""

    patches: Image
    classes: IntArray
    class_names: tuple[str, ...]


def texture_patches(seed: int, n_a_class: int = N_A_CLASS) -> TexturePatches:
    """Return patches of six surfaces, equally many of each.

    Two photographs are made of each surface, of its own colors and light. A patch is a cut
    of one of them, at any place, turned by up to 10 degrees, 0.8 to 1.25 times as large,
    with a little other brightness, gamma, blur and noise.

    Parameters
    ----------
    seed : int
        Of everything left to chance.
    n_a_class : int
        Patches of each class.

    Examples
    --------
    >>> made = texture_patches(seed=0, n_a_class=4)
    >>> made.patches.shape, made.class_names[:2]
    ((24, 40, 52, 3), ('brick', 'asphalt'))
    """
    rng = np.random.default_rng((seed, 11))
    patches: list[Image] = []
    for number, surface in enumerate(SURFACES.values()):
        photographs = [
            _photograph(rng, surface, (seed, number, take)) for take in range(N_PHOTOGRAPHS)
        ]
        patches += [
            _patch(rng, photographs[i % N_PHOTOGRAPHS], surface.zoom) for i in range(n_a_class)
        ]
    classes = np.repeat(np.arange(len(SURFACES)), n_a_class)
    return TexturePatches(np.array(patches), classes, tuple(SURFACES))


def _photograph(
    rng: np.random.Generator, surface: _Surface, seed: tuple[int, int, int]
) -> Float64Array:
    """Return one photograph (n, n, 3), red first, in a light of its own."""
    light = rng.uniform(0.8, 1.15) * rng.uniform(0.95, 1.05, 3)
    colors = [np.clip(np.array(color) * light, 0, 1).tolist() for color in surface.colors]
    first, second, third = (tuple[float, float, float](color) for color in colors)
    return paint(surface.family, (first, second, third), seed, _SIDE)


def _patch(rng: np.random.Generator, photograph: Float64Array, zoom: float) -> Image:
    """Cut one patch; the photograph goes on at its edges, as tiles do."""
    height, width = PATCH_SIZE
    turn = np.deg2rad(rng.uniform(-10, 10))
    scale = 1 / (zoom * rng.uniform(0.8, 1.25))
    x, y = rng.uniform(0, _SIDE, 2)
    c, s = scale * np.cos(turn), scale * np.sin(turn)
    to_tile = np.array(((c, -s, x), (s, c, y)))
    cut = cv2.warpAffine(
        photograph,
        to_tile,
        (width, height),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_WRAP,
    )
    if rng.random() < 0.5:  # noqa: PLR2004  # every other one is a little out of focus
        cut = cv2.GaussianBlur(cut, (0, 0), rng.uniform(0.3, 1.0))
    bright = rng.uniform(0.88, 1.12) * np.clip(cut, 0, 1) ** rng.uniform(0.9, 1.1)
    noisy = bright + rng.normal(scale=_SIGMA, size=bright.shape)
    pixels = np.clip(np.rint(noisy[..., ::-1] * 255), 0, 255)
    return np.asarray(pixels, dtype=np.uint8)
