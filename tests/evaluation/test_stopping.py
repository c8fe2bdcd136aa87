"""Stops and announced contacts on decisions made by hand; one every quarter of a second."""

import numpy as np
import pytest

from mpap_cli.evaluation.leads import Lead
from mpap_cli.evaluation.stopping import (
    Stops,
    announced_contacts,
    stopping_distances,
    summarize_stops,
)
from mpap_cli.observations import NS_PER_S, BoolArray, Int8Array, IntArray, Press

NOT_JUDGED = Lead(None, None)


def decisions(text: str) -> tuple[IntArray, Int8Array]:
    """Draw decisions: . straight, < > rotate, x stop, space none; 0.25 s a sign."""
    place = np.array([i for i, sign in enumerate(text) if sign != " "], dtype=np.int64)
    actions = [".<>x".index(sign) for sign in text if sign != " "]
    return place * (NS_PER_S // 4), np.array(actions, dtype=np.int8)


def mask(text: str) -> BoolArray:
    """Draw where the robot drives: - yes, anything else no."""
    return np.array([sign == "-" for sign in text], dtype=np.bool_)


def press(start_s: float, end_s: float, *, held: bool = False) -> Press:
    """Make a press from seconds."""
    return Press(int(start_s * NS_PER_S), int(end_s * NS_PER_S), held_from_start=held)


@pytest.mark.parametrize(
    ("text", "index"),
    [
        ("....<", [4]),
        ("...<", []),
        ("....<<<....>", [4, 11]),
        ("....x...x....x", [4, 13]),
        ("....       x", [4]),
        ("....        x", []),
        ("<<<<", []),
        (".....", []),
        ("", []),
    ],
)
def test_stop_is_the_first_decision_against_a_second_of_straight(
    text: str, index: list[int]
) -> None:
    """An approach is straight for a second; a pause of more than two seconds ends it."""
    stamps_ns, actions = decisions(text)
    ranges = np.arange(actions.size) / 2

    found = stopping_distances(stamps_ns, actions, ranges)

    assert found.index.tolist() == index
    assert found.distance_m.tolist() == [i / 2 for i in index]


def test_robot_that_does_not_drive_does_not_stop() -> None:
    """A decision against going on is a stop only where the robot drives forward."""
    stamps_ns, actions = decisions("....<....<")

    found = stopping_distances(stamps_ns, actions, np.ones(10), mask("-----     "))

    assert found.index.tolist() == [4]


def test_summary_leaves_out_stops_without_return() -> None:
    """Mean and sample deviation over what the scanner saw, of all logs."""
    stops = [
        Stops(np.array([1, 5]), np.array([0.5, np.nan])),
        Stops(np.array([2]), np.array([1.5])),
        Stops(np.zeros(0, np.int64), np.zeros(0)),
    ]

    found = summarize_stops(stops)

    assert (found.stops, found.measured, found.mean_m) == (3, 2, 1.0)
    assert found.sd_m == pytest.approx(np.sqrt(0.5))


@pytest.mark.parametrize(("distances", "mean_m"), [([], None), ([np.nan], None), ([0.7], 0.7)])
def test_summary_of_hardly_anything(distances: list[float], mean_m: float | None) -> None:
    """One stop has no spread, none has no mean."""
    found = summarize_stops([Stops(np.arange(len(distances)), np.array(distances))])

    assert (found.mean_m, found.sd_m) == (mean_m, None)
    assert summarize_stops([]).stops == 0


@pytest.mark.parametrize(
    ("text", "start_s", "lead"),
    [
        ("......<.", 2.0, Lead(True, 0.5)),
        ("........", 2.0, Lead(False, 0.0)),
        ("........<", 2.0, Lead(False, 0.0)),
        ("<<<<<<<<", 2.0, Lead(True, 2.0)),
        ("<" + "." * 24, 6.0, Lead(False, 0.0)),
        (".." + " " * 30, 8.0, NOT_JUDGED),
    ],
)
def test_contact_is_announced_by_a_decision_in_its_approach(
    text: str, start_s: float, lead: Lead
) -> None:
    """Any decision against going on in the five seconds before the press, none after it."""
    stamps_ns, actions = decisions(text)

    found = announced_contacts(stamps_ns, actions, [press(start_s, start_s + 1)])

    assert found == [lead]


def test_approach_begins_after_the_press_before() -> None:
    """What is decided while the robot is in contact announces nothing."""
    stamps_ns, actions = decisions("....<<<.....")

    found = announced_contacts(stamps_ns, actions, [press(1.0, 1.75), press(2.8, 3.0)])

    assert found == [Lead(False, 0.0), Lead(False, 0.0)]


def test_approach_is_driven_forward() -> None:
    """What is decided while the robot backs off and turns announces nothing."""
    stamps_ns, actions = decisions("<<<<....")

    turning = announced_contacts(stamps_ns, actions, [press(2, 3)], mask("    ----"))
    driving = announced_contacts(stamps_ns, actions, [press(2, 3)], mask(" -------"))
    standing = announced_contacts(stamps_ns, actions, [press(2, 3)], mask("------- "))

    assert turning == [Lead(False, 0.0)]
    assert driving == [Lead(True, 1.75)]
    assert standing == [NOT_JUDGED]


def test_press_held_from_the_start_is_not_judged() -> None:
    """Nothing can announce a press that is on when the log begins."""
    stamps_ns, actions = decisions("<<<<")

    assert announced_contacts(stamps_ns, actions, [press(0.5, 1, held=True)]) == [NOT_JUDGED]
