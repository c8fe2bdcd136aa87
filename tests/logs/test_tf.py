"""Straight ahead in the frame of the scanner."""

import logging
import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.tf import _apart, _forward, _Transform, find_forward

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

TF_MESSAGE = "tf2_msgs/msg/TFMessage"
IDENTITY = {"w": 1.0}
HALF_TURN = {"z": 1.0}
QUARTER_LEFT = {"z": math.sqrt(0.5), "w": math.sqrt(0.5)}
UPSIDE_DOWN = {"x": 1.0}
NOSE_DOWN = {"y": math.sqrt(0.5), "w": math.sqrt(0.5)}


def transform(parent: str, child: str, rotation: dict[str, float]) -> dict[str, Any]:
    """Return a geometry_msgs/TransformStamped."""
    return {
        "header": {"frame_id": parent},
        "child_frame_id": child,
        "transform": {"rotation": rotation},
    }


def tf_event(*transforms: dict[str, Any], topic: str = "/tf_static", stamp: int = 0) -> Event:
    """Return one message of transforms."""
    return topic, TF_MESSAGE, stamp, {"transforms": list(transforms)}


@pytest.mark.parametrize(
    ("rotation", "degrees"),
    [
        (IDENTITY, 0.0),
        (HALF_TURN, 180.0),
        ({"z": -1.0}, 180.0),
        ({"z": 5.0}, 180.0),
        (QUARTER_LEFT, -90.0),
        (UPSIDE_DOWN, 0.0),
        ({"x": math.sqrt(0.5), "y": math.sqrt(0.5)}, 90.0),
    ],
)
def test_forward_is_against_the_turn_of_the_scanner(
    make_log: MakeLog, rotation: dict[str, float], degrees: float
) -> None:
    """A scanner turned to the left sees ahead on its right; upside down, it is mirrored."""
    reader = make_log([tf_event(transform("base_link", "laser", rotation))])

    forward = find_forward(reader, "laser")

    assert forward is not None
    assert _apart(forward, math.radians(degrees)) < 1e-6
    assert -math.pi < forward <= math.pi


def test_turns_along_a_chain_add_up(make_log: MakeLog) -> None:
    """The chain goes over all frames between scanner and base, in any order of messages."""
    reader = make_log(
        [
            tf_event(transform("mast", "/laser", QUARTER_LEFT), topic="/tf", stamp=2),
            tf_event(transform("/base_link", "mast", QUARTER_LEFT), stamp=1),
            tf_event(transform("odom", "base_link", QUARTER_LEFT), topic="/tf", stamp=0),
        ]
    )

    assert find_forward(reader, "laser") == pytest.approx(math.pi)


@pytest.mark.parametrize("base", ["base_link", "/base_footprint", "robot_1/base_link", "chassis"])
def test_base_is_known_by_name_or_as_the_root(make_log: MakeLog, base: str) -> None:
    """Without a base_link the last frame below odom is the robot."""
    reader = make_log(
        [
            tf_event(transform("robot_1/odom", base, QUARTER_LEFT), topic="/tf"),
            tf_event(transform(base, "laser", HALF_TURN)),
        ]
    )

    assert find_forward(reader, "laser") == pytest.approx(math.pi)


def test_scanner_in_the_frame_of_the_base_looks_ahead(make_log: MakeLog) -> None:
    """A scan in base_link needs no transform."""
    assert find_forward(make_log([]), "/robot/base_link") == 0.0


@pytest.mark.parametrize(
    "transforms",
    [
        [],
        [transform("base_link", "camera", HALF_TURN)],
        [transform("odom", "laser", HALF_TURN)],
        [transform("base_link", "laser", NOSE_DOWN)],
        [transform("base_link", "laser", {})],
        [transform("base_link", "laser", {"w": math.nan})],
    ],
)
def test_no_chain_no_direction(make_log: MakeLog, transforms: list[dict[str, Any]]) -> None:
    """Without a usable chain, or with a scanner that looks at the floor, nothing is known."""
    assert find_forward(make_log([tf_event(*transforms)]), "laser") is None
    assert find_forward(make_log([]), "laser") is None


def test_frames_that_go_in_a_circle_end(make_log: MakeLog) -> None:
    """Broken transforms do not hang."""
    circle = [transform("a", "laser", HALF_TURN), transform("laser", "a", IDENTITY)]

    assert find_forward(make_log([tf_event(*circle)]), "laser") == pytest.approx(math.pi)


def test_several_transforms_of_one_direction_are_fine(
    make_log: MakeLog, caplog: pytest.LogCaptureFixture
) -> None:
    """Two static transforms that differ in place only lead to no warning."""
    turned = transform("base_link", "laser", HALF_TURN)
    moved = {**turned, "transform": {"translation": {"x": -0.1}, "rotation": {"z": -1.0}}}

    forward = find_forward(make_log([tf_event(turned), tf_event(moved, stamp=1)]), "laser")

    assert forward == pytest.approx(math.pi)
    assert not caplog.records


def test_directions_that_differ_are_told(
    make_log: MakeLog, caplog: pytest.LogCaptureFixture
) -> None:
    """The first holds, and one warning says so."""
    first = tf_event(transform("base_link", "laser", HALF_TURN))
    second = tf_event(transform("base_link", "laser", IDENTITY), stamp=1)

    forward = find_forward(make_log([first, second]), "laser")

    assert forward == pytest.approx(math.pi)
    assert caplog.record_tuples == [
        (
            "mpap_cli.logs.tf",
            logging.WARNING,
            "log.mcap: the transforms turn laser in several ways; the first is taken, 180 degrees",
        )
    ]


def test_reading_stops_when_the_chain_is_there(make_log: MakeLog) -> None:
    """A log of many transforms is not read to its end."""
    moving = [
        tf_event(transform("odom", "base_link", IDENTITY), topic="/tf", stamp=stamp)
        for stamp in range(3000)
    ]
    turned = tf_event(transform("base_link", "laser", HALF_TURN), stamp=5)
    reader: Any = make_log([*moving, turned])
    lost: Any = make_log(moving)

    assert find_forward(reader, "laser") == pytest.approx(math.pi)
    assert find_forward(lost, "laser") is None
    assert reader.n_read <= 101
    assert lost.n_read == 2000


def test_broken_transforms_are_passed_over(make_log: MakeLog) -> None:
    """A message cut short does not hide the next one."""
    broken: Event = ("/tf", TF_MESSAGE, 0, {"payload": b"\x00\x01"})
    turned = tf_event(transform("base_link", "laser", HALF_TURN), stamp=1)

    assert find_forward(make_log([broken, turned]), "laser") == pytest.approx(math.pi)


@given(yaws=st.lists(st.floats(-4, 4), min_size=1, max_size=5))
def test_yaws_along_a_chain_are_subtracted(yaws: list[float]) -> None:
    """For turns about the vertical the direction is minus their sum."""
    chain = [_Transform("p", (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))) for yaw in yaws]

    forward = _forward(chain)

    assert forward is not None
    assert _apart(forward, -sum(yaws)) < 1e-9
