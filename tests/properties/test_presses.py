"""Bumper states become presses."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.observations import NS_PER_S, Batch, Bump, Press, ScanBlock, ScanGeometry
from mpap_cli.params import BumperParams
from mpap_cli.properties.presses import PressTracker, bumps_from_scans, with_virtual_bumps

STATES = st.lists(st.tuples(st.integers(0, 3), st.sampled_from("ab"), st.booleans()), max_size=30)


def seconds(value: float) -> int:
    """Return nanoseconds."""
    return round(value * NS_PER_S)


def track(
    kind: str, events: Sequence[tuple[float, str, bool]], end_s: float, params: BumperParams
) -> tuple[Press, ...]:
    """Return the presses of a log with these bumps."""
    tracker = PressTracker(kind, params)
    tracker.add([Bump(seconds(at), sensor, pressed) for at, sensor, pressed in events])
    tracker.end(seconds(end_s))
    return tracker.presses


def test_a_level_press_lasts_until_the_first_free_message() -> None:
    """Repeated states change nothing; the end is the stamp of the first free message."""
    events = [(0, "", False), (1, "", True), (1.5, "", True), (2, "", False), (3, "", False)]

    presses = track("level", events, 9, BumperParams())

    assert presses == (Press(seconds(1), seconds(2)),)


def test_a_level_that_is_pressed_in_its_first_message_is_held_from_the_start() -> None:
    """Nobody knows when such a press began."""
    presses = track("level", [(1, "", True), (2, "", False)], 9, BumperParams())

    assert presses == (Press(seconds(1), seconds(2), held_from_start=True),)


def test_a_second_level_sensor_is_not_held_if_a_press_was_seen_before() -> None:
    """Only the first press of a log can reach back to its start."""
    events = [(0, "a", False), (1, "a", True), (2, "a", False), (3, "b", True), (4, "b", False)]

    presses = track("level", events, 9, BumperParams())

    assert [press.held_from_start for press in presses] == [False, False]


def test_a_level_sensor_that_speaks_late_is_held_whatever_others_said() -> None:
    """That one sensor was free says nothing of another before its first message."""
    events = [(0, "a", False), (0.2, "b", True), (1, "a", False), (2, "b", False)]

    presses = track("level", events, 9, BumperParams())

    assert presses == (Press(seconds(0.2), seconds(2), held_from_start=True),)


def test_a_level_sensor_that_speaks_late_joins_a_press_that_was_seen_to_begin() -> None:
    """The press keeps its onset, and lasts until both are free."""
    events = [(0, "a", False), (1, "a", True), (1.5, "b", True), (2, "a", False), (3, "b", False)]

    presses = track("level", events, 9, BumperParams())

    assert presses == (Press(seconds(1), seconds(3)),)


def test_an_edge_is_the_beginning_itself() -> None:
    """The first message of an edge topic tells of a change, not of a hold."""
    presses = track("edge", [(1, "left", True), (2, "left", False)], 9, BumperParams())

    assert presses == (Press(seconds(1), seconds(2)),)


def test_edges_are_joined_over_the_sensors() -> None:
    """Left, right pressed, left released: still in collision."""
    events = [(1, "left", True), (2, "right", True), (3, "left", False), (4, "right", False)]

    presses = track("edge", events, 9, BumperParams())

    assert presses == (Press(seconds(1), seconds(4)),)


def test_a_press_that_is_on_at_the_end_is_not_released() -> None:
    """It ends one nanosecond after the last message, so that this is still in it."""
    presses = track("edge", [(1, "left", True)], 9, BumperParams())

    assert presses == (Press(seconds(1), seconds(9) + 1, released=False),)


def test_touches_are_one_press_while_each_comes_within_the_hold_of_the_last() -> None:
    """A press of touches ends the hold after its last touch."""
    events = [(1, "", True), (1.2, "", True), (1.45, "", True), (2, "", True), (2.1, "", False)]

    presses = track("pulse", events, 9, BumperParams())

    assert presses == (Press(seconds(1), seconds(1.7)), Press(seconds(2), seconds(2.25)))


def test_a_touch_near_the_end_is_not_released() -> None:
    """The log ends before the hold does."""
    presses = track("pulse", [(1, "", True)], 1.1, BumperParams())

    assert presses == (Press(seconds(1), seconds(1.1) + 1, released=False),)


def test_the_hold_of_a_topic_outranks_the_setting() -> None:
    """A topic can say how long its touches last."""
    tracker = PressTracker("pulse", BumperParams(), hold_s=1.0)

    tracker.add([Bump(0, "", True)])
    tracker.end(seconds(5))

    assert tracker.presses == (Press(0, seconds(1)),)


def test_bump_merge_joins_presses_closer_than_that() -> None:
    """A gap of exactly bump-merge parts two presses."""
    events = [(1, "", False), (2, "", True), (3, "", False), (3.4, "", True), (4, "", False)]
    events += [(4.5, "", True), (5, "", False)]

    presses = track("level", events, 9, BumperParams(bump_merge=0.5))

    assert presses == (Press(seconds(2), seconds(4)), Press(seconds(4.5), seconds(5)))


def test_bump_max_press_ends_a_press_whose_release_got_lost() -> None:
    """The next press of the same edge sensor is a new one."""
    events = [(1, "left", True), (20, "left", True), (21, "left", False)]

    presses = track("edge", events, 30, BumperParams(bump_max_press=5.0))

    assert presses == (Press(seconds(1), seconds(6)), Press(seconds(20), seconds(21)))


def test_a_level_that_stays_on_beyond_bump_max_press_is_no_new_press() -> None:
    """It is cut, and starts anew only after a free message."""
    events = [(0, "", False), (1, "", True), (8, "", True), (9, "", False), (10, "", True)]

    presses = track("level", events, 12, BumperParams(bump_max_press=5.0))

    assert presses == (
        Press(seconds(1), seconds(6)),
        Press(seconds(10), seconds(12) + 1, released=False),
    )


def test_what_lasts_no_time_is_no_press() -> None:
    """A release at the stamp of its press leaves nothing."""
    events = [(0, "", False), (1, "", True), (1, "", False)]

    presses = track("level", events, 2, BumperParams())

    assert presses == ()


def test_a_kind_that_does_not_exist_is_refused() -> None:
    """There are three kinds of bumper signals."""
    with pytest.raises(ValueError, match="kind of bumper: found levels, expected one of level"):
        PressTracker("levels", BumperParams())


def test_presses_so_far_hold_the_open_one_up_to_the_settled_stamp() -> None:
    """An open press lasts one nanosecond beyond what is known."""
    tracker = PressTracker("level", BumperParams())
    tracker.add([Bump(0, "", False), Bump(10, "", True)])

    tracker.settle(50)

    assert tracker.presses == (Press(10, 51, released=False),)


def test_recent_presses_are_those_that_last_beyond_a_stamp() -> None:
    """A press that ends at the stamp is over."""
    tracker = PressTracker("level", BumperParams())
    states = [(0, False), (10, True), (20, False), (30, True), (40, False)]

    tracker.add([Bump(at, "", pressed) for at, pressed in states])

    assert tracker.recent(20) == (Press(30, 40),)
    assert tracker.recent(19) == (Press(10, 20), Press(30, 40))


@given(STATES, st.sampled_from(["level", "edge"]))
def test_presses_are_where_any_sensor_is_on(steps: list[tuple[int, str, bool]], kind: str) -> None:
    """The state after the last message of each stamp decides, nanosecond by nanosecond."""
    stamps = np.cumsum([step for step, _, _ in steps]).tolist()
    bumps = [Bump(at, sensor, on) for at, (_, sensor, on) in zip(stamps, steps, strict=True)]
    end_ns = (stamps[-1] if stamps else 0) + 2
    tracker = PressTracker(kind, BumperParams())

    tracker.add(bumps)
    tracker.end(end_ns)

    covered = {t for press in tracker.presses for t in range(press.start_ns, press.end_ns)}
    last = {
        t: {bump.sensor: bump.pressed for bump in bumps if bump.stamp_ns <= t}
        for t in range(end_ns + 1)
    }
    assert covered == {t for t, sensors in last.items() if any(sensors.values())}
    starts = [press.start_ns for press in tracker.presses]
    assert all(press.end_ns not in starts for press in tracker.presses)


def test_near_scans_make_bumps() -> None:
    """Only valid ranges count: no 0, no NaN, nothing below range_min."""
    geometry = ScanGeometry(2, 0.0, 0.1, range_min=0.05, range_max=5.0)
    rows = [[0.0, 3.0], [np.nan, 0.2], [0.04, 0.3], [np.inf, 0.1]]
    block = ScanBlock(np.arange(4), np.array(rows, dtype=np.float32), geometry)
    batch = Batch(9, (block,), (Bump(1, "", True),))

    bumps = with_virtual_bumps(batch, 0.25).bumps

    assert [(bump.stamp_ns, bump.pressed) for bump in bumps] == [
        (0, False),
        (1, True),
        (2, False),
        (3, True),
    ]


def test_virtual_bumps_can_have_another_largest_range() -> None:
    """Messages that state no usable range_max still have valid ranges."""
    geometry = ScanGeometry(1, 0.0, 0.1, range_min=0.05, range_max=0.0)
    block = ScanBlock(np.arange(1), np.full((1, 1), 0.1, dtype=np.float32), geometry)

    pressed = [bumps_from_scans(block, 0.25, most)[0].pressed for most in (None, 5.0)]

    assert pressed == [False, True]
