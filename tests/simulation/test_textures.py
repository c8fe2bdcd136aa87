"""Surfaces are seamless, come from seeds, and no two palettes share a family."""

import itertools

import numpy as np
import pytest

from mpap_cli.simulation.palettes import FLOORS, NAMES, PALETTES, SLOTS, WALLS, surface_of
from mpap_cli.simulation.textures import FAMILIES, Color, paint

COLORS: tuple[Color, Color, Color] = ((0.6, 0.4, 0.3), (0.8, 0.7, 0.5), (0.2, 0.2, 0.3))


@pytest.mark.parametrize("family", FAMILIES)
def test_tiles_are_colors_without_a_seam(family: str) -> None:
    """A tile is within 0 and 1; its edges differ no more than other neighboring lines."""
    tile = paint(family, COLORS, (1,), 128)

    assert tile.shape == (128, 128, 3)
    assert 0 <= tile.min() < tile.max() <= 1
    for axis in (0, 1):
        steps = np.abs(np.diff(tile, axis=axis)).mean(axis=(1 - axis, 2))
        lines = np.moveaxis(tile, axis, 0)
        seam = np.abs(lines[0] - lines[-1]).mean()
        assert seam <= 1.5 * steps.max()


@pytest.mark.parametrize("family", FAMILIES)
def test_same_seed_same_tile(family: str) -> None:
    """A tile is its seed; another seed is another tile, where anything is left to chance."""
    tiles = [paint(family, COLORS, seed, 64) for seed in ((1, 2), (1, 2), (1, 3))]

    assert tiles[0].tobytes() == tiles[1].tobytes()
    assert tiles[0].tobytes() != tiles[2].tobytes()


def test_no_two_palettes_share_a_family() -> None:
    """Every palette has a look for each surface, of families of its own; there are 12."""
    families = {name: {look.family for look in looks} for name, looks in PALETTES.items()}

    assert all(len(looks) == len(SLOTS) for looks in PALETTES.values())
    assert all(a.isdisjoint(b) for a, b in itertools.combinations(families.values(), 2))
    assert set.union(*families.values()) == set(FAMILIES)
    assert len(FAMILIES) == 12


def test_every_material_has_a_surface() -> None:
    """Materials have a place among the surfaces, floors among the first two."""
    for name in NAMES:
        slot, tint = surface_of(name)
        if name not in FLOORS:
            assert slot >= len(FLOORS)
        assert all(0 < part <= 1.5 for part in tint)
    assert set(WALLS) <= set(NAMES)
