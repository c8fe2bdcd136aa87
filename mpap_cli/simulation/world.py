"""What the robot drives through: things made of materials, seen from above."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import Float64Array, IntArray
from mpap_cli.simulation.shapes import Shapes


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """How a surface answers a sensor.

    The laser gets a return up to ``reach_m`` (0: never, as from glass, chrome, or a thing
    lower than its plane), loses a share ``dropout`` of them, and measures with ``spread_m``
    more noise. Things that are not ``solid`` give way to the robot. A camera sees them up
    to ``height_m`` above the floor.
    """

    reach_m: float
    dropout: float = 0.003
    spread_m: float = 0.0
    solid: bool = True
    height_m: float = 2.4


MATERIALS: dict[str, Material] = {
    # indoors
    "wall": Material(reach_m=8.0),
    "box": Material(reach_m=7.0, height_m=0.5),
    "shelf": Material(reach_m=5.0, dropout=0.02, height_m=1.5),
    "table leg": Material(reach_m=4.0, dropout=0.05, height_m=0.72),
    "chair leg": Material(reach_m=2.0, dropout=0.4, height_m=0.41),
    "chair seat": Material(reach_m=0.0, height_m=0.45),
    "steel": Material(reach_m=0.0, height_m=0.8),
    "glass": Material(reach_m=0.0, height_m=0.9),
    "low step": Material(reach_m=0.0, height_m=0.12),
    # outdoors: sunlight and rough, dark surfaces shorten the reach
    "tree": Material(reach_m=5.5, dropout=0.02, spread_m=0.01, height_m=3.0),
    "bush": Material(reach_m=4.0, dropout=0.2, spread_m=0.05, height_m=0.7),
    "fence": Material(reach_m=4.0, dropout=0.5, height_m=1.2),
    "post": Material(reach_m=4.5, dropout=0.02, height_m=1.0),
    "shed": Material(reach_m=6.0, dropout=0.01, height_m=2.2),
    "rock": Material(reach_m=3.5, dropout=0.05, spread_m=0.01, height_m=0.35),
    "log": Material(reach_m=0.0, height_m=0.25),
    "kerb": Material(reach_m=0.0, height_m=0.12),
    "grass": Material(reach_m=2.5, dropout=0.6, spread_m=0.1, solid=False, height_m=0.35),
}


@dataclass(frozen=True, slots=True)
class Body:
    """A thing as a camera sees it: upright, on the floor or (a seat) above it.

    ``name`` is a key of ``MATERIALS``, or foot; ``points`` are the middle of a round thing, both
    ends of a wall or the corners of a box, counter-clockwise; metres. Without ``top_m`` it
    is as high as its material.
    """

    name: str
    points: tuple[tuple[float, float], ...]
    radius_m: float = 0.0
    bottom_m: float = 0.0
    top_m: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """Everything in a world, shape by shape, in the order of ``shapes``.

    ``names`` are keys of ``MATERIALS``; ``reach_m``, ``dropout`` and ``spread_m`` have
    shape (len(shapes),). ``start`` is x, y, heading of the robot at the beginning.
    ``bodies`` are the same things and what is only seen; ``rooms`` (x0, y0, x1, y1) those
    that have a floor of their own.
    """

    shapes: Shapes
    names: tuple[str, ...]
    reach_m: Float64Array
    dropout: Float64Array
    spread_m: Float64Array
    start: tuple[float, float, float]
    bodies: tuple[Body, ...]
    rooms: tuple[tuple[float, float, float, float], ...]

    def pick(self, *, solid: bool, visible: bool = False) -> tuple[Shapes, IntArray]:
        """Return the shapes that are solid, or solid and seen by the laser, and their numbers."""
        materials = [MATERIALS[name] for name in self.names]
        wanted = np.array(
            [m.solid >= solid and (m.reach_m > 0 or not visible) for m in materials], dtype=bool
        )
        n = len(self.shapes.segments)
        picked = Shapes(self.shapes.segments[wanted[:n]], self.shapes.circles[wanted[n:]])
        return picked, np.flatnonzero(wanted).astype(np.int64)


class WorldBuilder:
    """Collects things one by one and makes a world of them.

    ``rng`` decides everything left to chance; ``footprints`` remembers where things stand;
    ``bodies`` and ``rooms`` are for the camera only.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.footprints: list[tuple[float, float, float]] = []
        self.bodies: list[Body] = []
        self.rooms: list[tuple[float, float, float, float]] = []
        self._segments: list[tuple[float, float, float, float]] = []
        self._circles: list[tuple[float, float, float]] = []
        self._segment_names: list[str] = []
        self._circle_names: list[str] = []

    def add_line(self, name: str, points: Sequence[tuple[float, float]]) -> None:
        """Add an open line through points."""
        self._add_segments(name, points)
        self.bodies += [Body(name, ends) for ends in itertools.pairwise(points)]

    def add_box(
        self, name: str, center: tuple[float, float], size: tuple[float, float], turn: float = 0.0
    ) -> None:
        """Add a rectangle, turned by radians about its center."""
        corners = turned_corners(center, size, turn)
        self._add_segments(name, [*corners, corners[0]])
        self.bodies.append(Body(name, tuple(corners)))
        self.footprints.append((*center, math.hypot(*size) / 2))

    def add_circle(self, name: str, center: tuple[float, float], radius_m: float) -> None:
        """Add a round thing."""
        self._circles.append((*center, radius_m))
        self._circle_names.append(name)
        self.bodies.append(Body(name, (center,), radius_m))
        self.footprints.append((*center, radius_m))

    def find_place(
        self, area: tuple[float, float, float, float], radius_m: float, gap_m: float
    ) -> tuple[float, float] | None:
        """Return a place in an area (x0, y0, x1, y1) with a gap to all footprints, or None."""
        x0, y0, x1, y1 = area
        for _ in range(40):
            x, y = self.rng.uniform(x0, x1), self.rng.uniform(y0, y1)
            gaps = [math.hypot(x - fx, y - fy) - fr for fx, fy, fr in self.footprints]
            if min(gaps, default=math.inf) >= radius_m + gap_m:
                return x, y
        return None

    def build(self, area: tuple[float, float, float, float]) -> World:
        """Return the world; the robot starts at a free place in the area."""
        segments = np.array(self._segments, np.float64).reshape(-1, 4)
        circles = np.array(self._circles, np.float64).reshape(-1, 3)
        names = (*self._segment_names, *self._circle_names)
        materials = [MATERIALS[name] for name in names]
        x, y = self._free_start(Shapes(segments, circles), area)
        return World(
            shapes=Shapes(segments, circles),
            names=names,
            reach_m=np.array([m.reach_m for m in materials], np.float64),
            dropout=np.array([m.dropout for m in materials], np.float64),
            spread_m=np.array([m.spread_m for m in materials], np.float64),
            start=(x, y, float(self.rng.uniform(-math.pi, math.pi))),
            bodies=tuple(self.bodies),
            rooms=tuple(self.rooms),
        )

    def _add_segments(self, name: str, points: Sequence[tuple[float, float]]) -> None:
        for (x0, y0), (x1, y1) in itertools.pairwise(points):
            self._segments.append((x0, y0, x1, y1))
            self._segment_names.append(name)

    def _free_start(
        self, shapes: Shapes, area: tuple[float, float, float, float]
    ) -> tuple[float, float]:
        """Return the roomiest of some places outside everything."""
        x0, y0, x1, y1 = area
        places = self.rng.uniform((x0, y0), (x1, y1), (60, 2))
        inside = [self._covered(x, y) for x, y in places]
        gaps = [
            -math.inf if hidden else shapes.nearest(x, y).distance_m
            for (x, y), hidden in zip(places, inside, strict=True)
        ]
        x, y = places[int(np.argmax(gaps))]
        return float(x), float(y)

    def _covered(self, x: float, y: float) -> bool:
        return any(math.hypot(x - fx, y - fy) < fr for fx, fy, fr in self.footprints)


def turned_corners(
    center: tuple[float, float], size: tuple[float, float], turn: float
) -> list[tuple[float, float]]:
    """Return the four corners of a rectangle, counter-clockwise.

    >>> turned_corners((0.0, 0.0), (2.0, 4.0), 0.0)[0]
    (-1.0, -2.0)
    """
    c, s = math.cos(turn), math.sin(turn)
    half_x, half_y = size[0] / 2, size[1] / 2
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return [
        (
            center[0] + sx * half_x * c - sy * half_y * s,
            center[1] + sx * half_x * s + sy * half_y * c,
        )
        for sx, sy in signs
    ]
