"""Which surface each material of a world has: palettes that share no texture family."""

from dataclasses import dataclass

from mpap_cli.simulation.textures import Color
from mpap_cli.simulation.world import MATERIALS


@dataclass(frozen=True, slots=True)
class Look:
    """A surface: a family of textures, its three colors, metres that one tile covers."""

    family: str
    colors: tuple[Color, Color, Color]
    tile_m: float


SLOTS = ("floor", "floor2", "wall", "box", "fitting")
"""The surfaces of a palette: two floors, walls, boxes, and what else stands around."""

PALETTES: dict[str, tuple[Look, ...]] = {
    "a": (
        Look("planks", ((0.52, 0.36, 0.22), (0.72, 0.55, 0.36), (0.20, 0.14, 0.10)), 0.9),
        Look("carpet", ((0.38, 0.42, 0.50), (0.56, 0.58, 0.62), (0.3, 0.3, 0.3)), 0.4),
        Look("plaster", ((0.78, 0.74, 0.64), (0.68, 0.64, 0.55), (0.60, 0.55, 0.46)), 0.8),
        Look("weave", ((0.52, 0.20, 0.16), (0.68, 0.36, 0.22), (0.16, 0.08, 0.06)), 0.3),
        Look("weave", ((0.42, 0.36, 0.30), (0.58, 0.50, 0.40), (0.18, 0.15, 0.12)), 0.16),
    ),
    "b": (
        Look("tiles", ((0.62, 0.60, 0.55), (0.50, 0.50, 0.48), (0.30, 0.29, 0.27)), 0.9),
        Look("terrazzo", ((0.60, 0.52, 0.46), (0.78, 0.74, 0.68), (0.32, 0.28, 0.28)), 0.45),
        Look("bricks", ((0.56, 0.28, 0.20), (0.66, 0.40, 0.30), (0.66, 0.62, 0.56)), 0.9),
        Look("corrugated", ((0.68, 0.54, 0.38), (0.46, 0.34, 0.22), (0.36, 0.26, 0.16)), 0.3),
        Look("corrugated", ((0.36, 0.46, 0.52), (0.20, 0.26, 0.32), (0.42, 0.30, 0.20)), 0.5),
    ),
    "c": (
        Look("gravel", ((0.52, 0.50, 0.46), (0.66, 0.60, 0.52), (0.22, 0.20, 0.18)), 0.6),
        Look("leaves", ((0.26, 0.40, 0.14), (0.46, 0.52, 0.22), (0.14, 0.16, 0.08)), 0.6),
        Look("stripes", ((0.56, 0.50, 0.40), (0.70, 0.64, 0.52), (0.34, 0.29, 0.22)), 0.9),
        Look("marble", ((0.66, 0.66, 0.64), (0.52, 0.52, 0.52), (0.26, 0.26, 0.30)), 0.6),
        Look("stripes", ((0.32, 0.40, 0.34), (0.22, 0.28, 0.24), (0.46, 0.50, 0.42)), 0.3),
    ),
}
"""Surfaces in the order of ``SLOTS``; no family is in two palettes."""

FLOORS = ("floor", "floor2")
NAMES = (*FLOORS, *MATERIALS, "foot")
"""What a pixel can show; its number in a picture of labels is its place here."""

WALLS = ("wall", "fence")

_TINTS: dict[str, tuple[str, Color]] = {
    # surface, and what its red, green and blue are multiplied with
    "wall": ("wall", (1.0, 1.0, 1.0)),
    "fence": ("wall", (0.85, 0.85, 0.8)),
    "shed": ("wall", (0.8, 0.95, 1.05)),
    "box": ("box", (1.0, 1.0, 1.0)),
    "rock": ("box", (0.8, 0.9, 1.0)),
    "bush": ("box", (0.7, 1.0, 0.6)),
    "grass": ("box", (0.8, 1.1, 0.6)),
    "kerb": ("box", (1.1, 1.3, 1.5)),
    "low step": ("box", (0.7, 0.9, 1.1)),
    "glass": ("fitting", (0.8, 1.2, 1.2)),
    "steel": ("fitting", (1.2, 1.3, 1.5)),
    "foot": ("fitting", (0.35, 0.35, 0.45)),
}


def surface_of(name: str) -> tuple[int, Color]:
    """Return the place of a material's surface in ``SLOTS``, and its tint.

    >>> surface_of("rock")
    (3, (0.8, 0.9, 1.0))
    """
    slot, tint = _TINTS.get(name, ("fitting", (1.0, 1.0, 1.0)))
    return SLOTS.index(slot), tint
