"""The bumper tells contacts, and is late, stuck or silent as often as it should."""

from collections.abc import Sequence

import pytest

from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation.bumper import Bumper, Faults, SwitchChange
from mpap_cli.simulation.robot import STEP_NS, Contact

NEVER = Faults(late=0.0, held=0.0, missed=0.0)
START_NS = 5 * NS_PER_S


def touch(start_step: int, end_step: int, bearing_rad: float = 0.0) -> Contact:
    """Return a contact with a wall."""
    return Contact(start_step, end_step, "wall", True, bearing_rad)


def changes_of(faults: Faults, contacts: Sequence[Contact], seed: int = 0) -> list[SwitchChange]:
    """Return all that a bumper says of contacts."""
    bumper = Bumper(START_NS, seed, faults)
    for contact in contacts:
        bumper.touch(contact)
    return bumper.changes(10**15)


def delays_s(changes: Sequence[SwitchChange], contact: Contact) -> tuple[float, float]:
    """Return how late the press and the release are, in seconds."""
    start, end = (START_NS + step * STEP_NS for step in (contact.start_step, contact.end_step))
    return (changes[0].stamp_ns - start) / NS_PER_S, (changes[-1].stamp_ns - end) / NS_PER_S


def test_sound_bumper_follows_the_contact() -> None:
    """One press and one release, within 0.1 s of the contact."""
    contact = touch(20, 40)

    changes = changes_of(NEVER, [contact])

    assert [(change.sensor, change.pressed) for change in changes] == [
        ("center", True),
        ("center", False),
    ]
    late, held = delays_s(changes, contact)
    assert 0 <= late <= 0.1
    assert 0 <= held <= 0.1


@pytest.mark.parametrize("seed", range(10))
def test_late_bumper_is_a_tenth_to_six_tenths_late(seed: int) -> None:
    """A late press comes 0.1 to 0.6 s after the touch, even after the contact's end."""
    contact = touch(20, 24)

    changes = changes_of(Faults(late=1.0, held=0.0, missed=0.0), [contact], seed)

    late, _ = delays_s(changes, contact)
    assert 0.1 <= late <= 0.6
    assert changes[1].stamp_ns - changes[0].stamp_ns >= 0.15 * NS_PER_S


@pytest.mark.parametrize("seed", range(10))
def test_stuck_bumper_is_held_for_seconds(seed: int) -> None:
    """A stuck switch opens 1.5 to 6.1 s after the contact's end."""
    contact = touch(20, 40)

    changes = changes_of(Faults(late=0.0, held=1.0, missed=0.0), [contact], seed)

    _, held = delays_s(changes, contact)
    assert 1.5 <= held <= 6.1


def test_silent_bumper_says_nothing() -> None:
    """A missed contact leaves no change."""
    assert changes_of(Faults(late=0.0, held=0.0, missed=1.0), [touch(20, 40)]) == []


@pytest.mark.parametrize(
    ("bearing_rad", "sensors"),
    [
        (0.0, {"center"}),
        (0.8, {"left"}),
        (-0.8, {"right"}),
        (0.3, {"center", "left"}),
        (-0.4, {"center", "right"}),
    ],
)
def test_place_of_the_touch_decides_the_switch(bearing_rad: float, sensors: set[str]) -> None:
    """Left is left of ahead; near the edge of two switches both close, one after the other."""
    changes = changes_of(NEVER, [touch(20, 40, bearing_rad)])

    assert {change.sensor for change in changes} == sensors
    assert len(changes) == 2 * len(sensors)
    assert changes == sorted(changes, key=lambda change: change.stamp_ns)


def test_switch_closes_once_while_contacts_overlap() -> None:
    """A second touch of a switch that is stuck makes no second press."""
    faults = Faults(late=0.0, held=1.0, missed=0.0)

    changes = changes_of(faults, [touch(20, 40), touch(50, 60)])

    assert [change.pressed for change in changes] == [True, False]


def test_changes_come_out_in_parts() -> None:
    """What lies before a moment is told once; the rest waits."""
    bumper = Bumper(START_NS, 0, NEVER)
    bumper.touch(touch(20, 40))

    parts = [bumper.changes(START_NS + seconds * NS_PER_S) for seconds in (1, 2, 3, 4)]

    assert [len(part) for part in parts] == [0, 1, 1, 0]
