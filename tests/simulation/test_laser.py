"""Scans are what rays would meet, made worse as real scanners do."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.observations import Float64Array
from mpap_cli.simulation.laser import NO_RETURN_CODES, Laser, Scanner, cast_rays
from mpap_cli.simulation.shapes import Shapes
from mpap_cli.simulation.world import World, WorldBuilder

NO_CIRCLES = np.empty((0, 3))


def ray(shapes: Shapes, pose: Float64Array, angle: float, longest: float) -> float:
    """Return the range of one beam, shape by shape."""
    origin = np.array(pose[:2])
    way = np.array((math.cos(angle), math.sin(angle)))
    found = math.inf
    for x0, y0, x1, y1 in shapes.segments:
        matrix = np.array(((way[0], x0 - x1), (way[1], y0 - y1)))
        if abs(np.linalg.det(matrix)) > 1e-9:
            along, share = np.linalg.solve(matrix, np.array((x0, y0)) - origin)
            found = min(found, along) if along >= 0 and 0 <= share <= 1 else found
    for x, y, radius in shapes.circles:
        to_center = np.array((x, y)) - origin
        ahead = float(to_center @ way)
        below = radius**2 - float(to_center @ to_center) + ahead**2
        if below >= 0 and ahead - math.sqrt(below) >= 0:
            found = min(found, ahead - math.sqrt(below))
    return found if found <= longest else math.inf


@given(st.integers(0, 2**32 - 1))
def test_rays_equal_one_beam_after_the_other(seed: int) -> None:
    """Casting by spans finds for every beam what the plain search finds."""
    rng = np.random.default_rng(seed)
    # no exact grid: a beam that just grazes a corner may fall on either side of it
    shapes = Shapes(rng.uniform(-6, 6, (5, 4)), rng.uniform((-6, -6, 0.01), (6, 6, 1.5), (4, 3)))
    poses = rng.uniform((-6, -6, -7), (6, 6, 7), (2, 3))
    outside = [shapes.nearest(*pose[:2]).distance_m > 0 for pose in poses]
    poses = poses[outside]
    scanner = Scanner(n_beams=24, increment_rad=math.pi / 24)

    ranges, hit = cast_rays(shapes, poses, scanner)

    angles = poses[:, 2:] + np.arange(24) * scanner.increment_rad
    wanted = [
        [ray(shapes, pose, angle, scanner.range_max_m) for angle in row]
        for pose, row in zip(poses, angles, strict=True)
    ]
    np.testing.assert_allclose(ranges, np.reshape(wanted, ranges.shape), atol=1e-6)
    assert ((hit >= 0) == np.isfinite(ranges)).all()


def test_beam_along_a_wall_sees_no_wall() -> None:
    """A scanner in line with a wall gets nothing from its edge, and no warning."""
    wall = Shapes(np.array([[1.0, 0.0, 3.0, 0.0]]), NO_CIRCLES)
    scanner = Scanner()

    ranges, hit = cast_rays(wall, np.array([[0.0, 0.0, -math.pi / 2]]), scanner)

    assert np.isinf(ranges).all()
    assert (hit == -1).all()


def wall_ahead(name: str, distance_m: float) -> World:
    """Return a wide wall of a material, ahead of a robot that stands in the origin."""
    builder = WorldBuilder(np.random.default_rng(0))
    builder.add_line(name, [(distance_m, -50.0), (distance_m, 50.0)])
    return builder.build((-1.0, -1.0, 0.0, 1.0))


def scan_once(world: World, **changes: object) -> list[float]:
    """Return one scan from the origin, looking along x."""
    scanner = Scanner(x_m=0.0, y_m=0.0, **changes)  # type: ignore[arg-type]  # by name
    return [float(value) for value in Laser(world, scanner, 1).scan(np.zeros((1, 3)))[0]]


def test_beams_go_from_right_to_left() -> None:
    """Beam 0 looks 90 degrees to the right, beam 90 ahead; a wall ahead is nearest there."""
    scan = scan_once(wall_ahead("wall", 1.0), noise_m=0.0)

    assert scan[90] == 1.0
    assert scan[45] == pytest.approx(math.sqrt(2), abs=0.006)
    assert scan[0] == pytest.approx(NO_RETURN_CODES["above-max"])


@pytest.mark.parametrize(("name", "code"), NO_RETURN_CODES.items())
def test_no_return_is_coded_as_asked(name: str, code: float) -> None:
    """What is out of reach reads as the code of the driver."""
    scan = scan_once(wall_ahead("wall", 20.0), no_return=name)

    assert set(scan) == {float(np.float32(code))}


def test_blind_zone_hides_what_touches_the_scanner() -> None:
    """A wall nearer than the blind zone gives returns only where it is farther away."""
    scan = np.array(scan_once(wall_ahead("wall", 0.2)))

    valid = scan[scan <= 8.0]
    assert scan[90] > 8.0
    assert 0.3 < valid.min() < 0.45


@pytest.mark.parametrize("name", ["glass", "steel", "low step", "log", "kerb"])
def test_some_things_are_never_seen(name: str) -> None:
    """Glass, chrome and what is lower than the laser's plane give no return."""
    scan = scan_once(wall_ahead(name, 1.0))

    assert min(scan) > 8.0


def test_dark_surfaces_are_seen_from_near_only() -> None:
    """A fence is seen at 2 m, with gaps, but not at 5 m."""
    near, far = (np.array(scan_once(wall_ahead("fence", at))) for at in (2.0, 5.0))

    assert 0.2 < (near <= 8.0).mean() < 0.5
    assert (far > 8.0).all()


def test_scans_do_not_depend_on_the_size_of_a_block() -> None:
    """Ten scans at once equal three, then seven."""
    world = wall_ahead("bush", 2.0)
    poses = np.random.default_rng(3).uniform(-1, 1, (10, 3))

    whole = Laser(world, Scanner(), 5).scan(poses)

    laser = Laser(world, Scanner(), 5)
    parts = np.concatenate((laser.scan(poses[:3]), laser.scan(poses[3:])))
    assert whole.tobytes() == parts.tobytes()
    assert whole.dtype == np.float32
    np.testing.assert_array_equal(np.round(whole, 2), whole)
