"""The robot walks at random, bumps, holds, backs off and never enters a thing."""

import itertools
import math

import numpy as np
import pytest

from mpap_cli.simulation.robot import STEP_NS, Contact, Habits, Track, Walker
from mpap_cli.simulation.settings import PLACES
from mpap_cli.simulation.world import World, WorldBuilder

STEPS_PER_MINUTE = 60_000_000_000 // STEP_NS


def walk(place: str, seed: int, minutes: float) -> tuple[World, Walker, Track]:
    """Let a robot walk through a world of its seed."""
    world = PLACES[place].build(np.random.default_rng((seed, 0)))
    walker = Walker(world, PLACES[place].habits, seed)
    return world, walker, walker.advance(int(minutes * STEPS_PER_MINUTE))


def rooms_of(name: str) -> World:
    """Return a room of 3 m whose walls are of one material."""
    builder = WorldBuilder(np.random.default_rng(1))
    builder.add_line(name, [(0, 0), (3, 0), (3, 3), (0, 3), (0, 0)])
    return builder.build((1.0, 1.0, 2.0, 2.0))


@pytest.mark.parametrize("place", PLACES)
def test_robot_never_enters_a_thing(place: str) -> None:
    """At every step the robot's disc is outside all solid things."""
    world, walker, track = walk(place, 3, 4)

    solid, _ = world.pick(solid=True)

    gaps = [solid.nearest(x, y).distance_m for x, y in track.poses[::3, :2]]
    assert min(gaps) > walker.habits.radius_m - 0.03


@pytest.mark.parametrize("place", PLACES)
def test_contacts_are_short_and_ahead(place: str) -> None:
    """Each contact lasts 0.2 to 3 s, in front, with the robot at rest, one after the other."""
    _, walker, track = walk(place, 2, 10)

    contacts = walker.contacts

    assert 10 <= len(contacts) <= 30
    for contact in contacts:
        assert 4 <= contact.end_step - contact.start_step <= 60
        assert abs(contact.bearing_rad) <= walker.habits.ring_rad
        held = track.motion[contact.start_step + 1 : contact.end_step + 1, 0]
        assert (held == 0).all()
    for before, after in itertools.pairwise(contacts):
        assert before.end_step < after.start_step


def test_robot_backs_off_after_a_contact() -> None:
    """Right after a contact the robot drives backwards, then turns."""
    _, walker, track = walk("indoor", 2, 6)
    ends = [contact.end_step for contact in walker.contacts if contact.end_step + 10 < 7000]

    speeds = np.array([track.motion[end + 4, 0] for end in ends])

    assert (speeds < 0).mean() > 0.8
    assert (track.commands[:, 1] != 0).any()


def test_contact_touches_its_cause() -> None:
    """At the start of a contact the thing named is at the robot's rim, where it says."""
    world, walker, track = walk("indoor", 4, 6)
    contacts = [contact for contact in walker.contacts if contact.cause != "foot"]

    for contact in contacts:
        x, y, heading = track.poses[contact.start_step]
        nearest = world.shapes.nearest(x, y)
        bearing = math.atan2(nearest.y - y, nearest.x - x) - heading

        assert world.names[nearest.index] == contact.cause
        assert nearest.distance_m == pytest.approx(0.2, abs=1e-3)
        assert math.remainder(bearing - contact.bearing_rad, math.tau) == pytest.approx(0, abs=1e-3)


def test_walk_does_not_depend_on_the_size_of_a_block() -> None:
    """A walk of 3,000 steps equals one of 1,000 and 2,000."""
    _, walker, track = walk("indoor", 5, 2.5)
    world = PLACES["indoor"].build(np.random.default_rng((5, 0)))
    again = Walker(world, PLACES["indoor"].habits, 5)

    parts = [again.advance(1000), again.advance(2000)]

    assert track.poses.tobytes() == b"".join(part.poses.tobytes() for part in parts)
    assert walker.contacts == again.contacts
    assert parts[1].first_step == 1000


def test_cautious_robot_bumps_only_into_what_it_cannot_see() -> None:
    """Without bold legs and feet, walls are never touched; of glass they are."""
    habits = Habits(bold_share=0.0, unseen_share=0.0, look_m=(0.3, 0.5))

    found = {name: Walker(rooms_of(name), habits, 1) for name in ("wall", "glass")}
    for walker in found.values():
        walker.advance(4000)

    assert found["wall"].contacts == []
    assert {contact.cause for contact in found["glass"].contacts} == {"glass"}
    assert not any(contact.visible for contact in found["glass"].contacts)


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES)
def test_contacts_come_as_often_as_meant(place: str) -> None:
    """One to three contacts a minute; 10 to 20 % of them are with unseen things."""
    contacts: list[Contact] = []

    for seed in range(6):
        contacts += walk(place, seed, 10)[1].contacts

    assert 1 <= len(contacts) / 60 <= 3
    assert 0.1 <= np.mean([not contact.visible for contact in contacts]) <= 0.2
