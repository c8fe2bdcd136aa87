"""Worlds come from seeds, and the robot starts where it can stand."""

import numpy as np
import pytest

from mpap_cli.simulation.settings import PLACES
from mpap_cli.simulation.world import MATERIALS, WorldBuilder

SEEDS = range(8)


@pytest.mark.parametrize("place", PLACES)
def test_same_seed_same_world(place: str) -> None:
    """A world is its seed; another seed is another world."""
    build = PLACES[place].build

    worlds = [build(np.random.default_rng(seed)) for seed in (7, 7, 8)]

    assert worlds[0].shapes.segments.tobytes() == worlds[1].shapes.segments.tobytes()
    assert worlds[0].shapes.circles.tobytes() == worlds[1].shapes.circles.tobytes()
    assert worlds[0].start == worlds[1].start
    assert worlds[0].start != worlds[2].start


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("seed", SEEDS)
def test_robot_starts_in_free_space(place: str, seed: int) -> None:
    """Nothing is within the robot at its start, seen or not."""
    world = PLACES[place].build(np.random.default_rng(seed))

    solid, _ = world.pick(solid=True)

    assert solid.nearest(*world.start[:2]).distance_m > PLACES[place].habits.radius_m


@pytest.mark.parametrize("place", PLACES)
def test_worlds_hold_things_that_the_laser_misses(place: str) -> None:
    """Among a few worlds there are seen, unseen and (outdoors) yielding things."""
    worlds = [PLACES[place].build(np.random.default_rng(seed)) for seed in SEEDS]

    names = {name for world in worlds for name in world.names}

    assert any(MATERIALS[name].reach_m == 0 for name in names)
    assert sum(MATERIALS[name].reach_m > 0 for name in names) >= 4
    assert any(not MATERIALS[name].solid for name in names) == (place == "outdoor")


def test_visible_things_are_some_of_the_solid_things() -> None:
    """Glass stops the robot, grass does not; the laser sees grass and no glass."""
    builder = WorldBuilder(np.random.default_rng(0))
    builder.add_circle("grass", (1.0, 0.0), 0.1)
    builder.add_circle("glass", (2.0, 0.0), 0.1)
    builder.add_circle("tree", (3.0, 0.0), 0.1)
    world = builder.build((5.0, 5.0, 6.0, 6.0))

    solid, numbers = world.pick(solid=True)
    visible, seen = world.pick(solid=True, visible=True)

    assert (len(solid), numbers.tolist()) == (2, [1, 2])
    assert (len(visible), seen.tolist()) == (1, [2])


def test_full_area_has_no_place() -> None:
    """Where nothing fits any more, nothing is put."""
    builder = WorldBuilder(np.random.default_rng(0))
    builder.add_circle("tree", (0.0, 0.0), 3.0)

    place = builder.find_place((-1.0, -1.0, 1.0, 1.0), 0.5, 0.5)

    assert place is None
