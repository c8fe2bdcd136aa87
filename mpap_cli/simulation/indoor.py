"""A flat of several rooms: walls with doorways, tables, chairs, boxes, shelves, glass."""

import itertools
import math

import numpy as np

from mpap_cli.simulation.world import Body, World, WorldBuilder, turned_corners

_Area = tuple[float, float, float, float]


def build_indoor(rng: np.random.Generator) -> World:
    """Return rooms of 3 to 5 m, each furnished by chance.

    Parameters
    ----------
    rng : Generator
        The same state gives the same world.
    """
    builder = WorldBuilder(rng)
    xs = np.concatenate(([0.0], np.cumsum(rng.uniform(3.0, 5.0, int(rng.integers(2, 4))))))
    ys = np.concatenate(([0.0], np.cumsum(rng.uniform(3.0, 4.5, 2))))
    width, height = float(xs[-1]), float(ys[-1])
    outline = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0)]
    builder.add_line("wall", outline)
    for x in xs[1:-1]:
        for y0, y1 in itertools.pairwise(ys):
            _add_wall_with_door(builder, (float(x), float(y0)), (float(x), float(y1)))
    for y in ys[1:-1]:
        for x0, x1 in itertools.pairwise(xs):
            _add_wall_with_door(builder, (float(x0), float(y)), (float(x1), float(y)))
    for i, (x0, x1) in enumerate(itertools.pairwise(xs)):
        for j, (y0, y1) in enumerate(itertools.pairwise(ys)):
            room = (float(x0), float(y0), float(x1), float(y1))
            _furnish(builder, room)
            if (i + j) % 2:
                builder.rooms.append(room)
    return builder.build((0.4, 0.4, width - 0.4, height - 0.4))


def _add_wall_with_door(
    builder: WorldBuilder, start: tuple[float, float], end: tuple[float, float]
) -> None:
    """Add a wall with a gap of 0.9 to 1.3 m that nothing is put into."""
    length = math.dist(start, end)
    door = float(builder.rng.uniform(0.9, 1.3))
    first = float(builder.rng.uniform(0.4, length - door - 0.4))
    ux, uy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    near = (start[0] + ux * first, start[1] + uy * first)
    far = (near[0] + ux * door, near[1] + uy * door)
    builder.add_line("wall", [start, near])
    builder.add_line("wall", [far, end])
    builder.footprints.append(((near[0] + far[0]) / 2, (near[1] + far[1]) / 2, door / 2))


def _furnish(builder: WorldBuilder, room: _Area) -> None:
    """Put a shelf, a table with chairs, boxes and things that the laser misses into a room."""
    rng = builder.rng
    _add_shelf(builder, room)
    inner = (room[0] + 0.7, room[1] + 0.7, room[2] - 0.7, room[3] - 0.7)
    if rng.random() < 0.7:  # noqa: PLR2004  # share of rooms with a table
        _add_table(builder, inner)
    for _ in range(int(rng.integers(1, 4))):
        size = (float(rng.uniform(0.25, 0.6)), float(rng.uniform(0.25, 0.6)))
        place = builder.find_place(inner, math.hypot(*size) / 2, 0.5)
        if place:
            builder.add_box("box", place, size, float(rng.uniform(0, math.pi)))
    unseen = str(rng.choice(["low step", "glass", "steel"]))
    if rng.random() < 0.35:  # noqa: PLR2004  # share of rooms with something the laser misses
        size = (float(rng.uniform(0.2, 0.4)), 0.06 if unseen == "glass" else 0.2)
        place = builder.find_place(inner, math.hypot(*size) / 2, 0.5)
        if place:
            builder.add_box(unseen, place, size, float(rng.uniform(0, math.pi)))


def _add_shelf(builder: WorldBuilder, room: _Area) -> None:
    """Put a shelf against the lower or upper wall of a room."""
    rng = builder.rng
    length, depth = float(rng.uniform(0.8, 1.5)), 0.35
    y = room[1] + depth / 2 if rng.random() < 0.5 else room[3] - depth / 2  # noqa: PLR2004  # either
    place = builder.find_place((room[0] + 0.8, y, room[2] - 0.8, y), length / 2, 0.3)
    if place:
        builder.add_box("shelf", place, (length, depth))


def _add_table(builder: WorldBuilder, inner: _Area) -> None:
    """Add a table on four thin legs and up to three chairs around it."""
    rng = builder.rng
    size = (float(rng.uniform(1.0, 1.4)), float(rng.uniform(0.8, 1.0)))
    place = builder.find_place(inner, math.hypot(*size) / 2, 0.3)
    if not place:
        return
    turn = float(rng.uniform(0, math.pi))
    for corner in turned_corners(place, size, turn):
        builder.add_circle("table leg", corner, 0.03)
    for _ in range(int(rng.integers(0, 4))):
        angle = float(rng.uniform(-math.pi, math.pi))
        away = float(rng.uniform(0.9, 1.2))
        seat = (place[0] + away * math.cos(angle), place[1] + away * math.sin(angle))
        if _inside(seat, inner):
            for corner in turned_corners(seat, (0.4, 0.4), angle):
                builder.add_circle("chair leg", corner, 0.012)
            plate = tuple(turned_corners(seat, (0.43, 0.43), angle))
            builder.bodies.append(Body("chair seat", plate, bottom_m=0.41))
    builder.footprints.append((*place, max(size) / 2))


def _inside(point: tuple[float, float], area: _Area) -> bool:
    return area[0] <= point[0] <= area[2] and area[1] <= point[1] <= area[3]
