"""An open place of 40 m: trees, bushes, rocks, high grass, a shed, a fence around it."""

import math

import numpy as np

from mpap_cli.simulation.world import World, WorldBuilder

_SIDE_M = 40.0
_ROUND_THINGS = (
    # name, how many, smallest and largest radius in metres
    ("tree", 40, 0.12, 0.35),
    ("bush", 35, 0.3, 0.8),
    ("rock", 14, 0.2, 0.5),
    ("post", 10, 0.04, 0.06),
    ("log", 3, 0.12, 0.25),
)


def build_outdoor(rng: np.random.Generator) -> World:
    """Return a fenced place where most beams meet nothing.

    Parameters
    ----------
    rng : Generator
        The same state gives the same world.
    """
    builder = WorldBuilder(rng)
    corners = [(0.0, 0.0), (_SIDE_M, 0.0), (_SIDE_M, _SIDE_M), (0.0, _SIDE_M), (0.0, 0.0)]
    builder.add_line("fence", corners)
    area = (1.5, 1.5, _SIDE_M - 1.5, _SIDE_M - 1.5)
    for _ in range(3):
        _add_walled_thing(builder, area)
    for name, count, smallest, largest in _ROUND_THINGS:
        for _ in range(count):
            radius = float(rng.uniform(smallest, largest))
            place = builder.find_place(area, radius, 0.7)
            if place:
                builder.add_circle(name, place, radius)
    _add_grass(builder, area)
    return builder.build(area)


def _add_walled_thing(builder: WorldBuilder, area: tuple[float, float, float, float]) -> None:
    """Add a shed, a piece of fence and a kerb."""
    rng = builder.rng
    size = (float(rng.uniform(1.5, 3.0)), float(rng.uniform(1.5, 3.0)))
    place = builder.find_place(area, math.hypot(*size) / 2, 1.0)
    if place:
        builder.add_box("shed", place, size, float(rng.uniform(0, math.pi)))
    for name, thickness in (("fence", 0.05), ("kerb", 0.15)):
        length = float(rng.uniform(0.6, 1.2) if name == "kerb" else rng.uniform(2.0, 5.0))
        place = builder.find_place(area, length / 2, 0.5)
        if place:
            builder.add_box(name, place, (length, thickness), float(rng.uniform(0, math.pi)))


def _add_grass(builder: WorldBuilder, area: tuple[float, float, float, float]) -> None:
    """Add patches of high grass: seen, now and then, but no obstacle."""
    rng = builder.rng
    for _ in range(30):
        x, y = rng.uniform(area[:2], area[2:])
        for _ in range(4):
            center = (float(x + rng.normal(0, 0.5)), float(y + rng.normal(0, 0.5)))
            builder.add_circle("grass", center, float(rng.uniform(0.03, 0.1)))
