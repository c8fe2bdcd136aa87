"""Each bumper type says the same presses in its own way."""

from collections.abc import Callable, Sequence
from typing import Any

import pytest

from mpap_cli.logs.writing.encoding import JsonEncoder, RosEncoder
from mpap_cli.simulation.bumper import SwitchChange
from mpap_cli.simulation.bumper_messages import BUMPER_TYPES, BumperTopic
from mpap_cli.simulation.messages import json_header, ros_header

MS = 1_000_000
PRESSED: dict[str, Callable[[Any], bool]] = {
    "kobuki": lambda m: m["state"] == 1,
    "create3": lambda m: any(hazard["type"] == 1 for hazard in m["detections"]),
    "bool": lambda m: m["data"],
    "int8": lambda m: any(m["data"]),
    "neato": lambda m: any(m.values()),
    "neato-ros1": lambda m: any(m.values()),
    "gazebo": lambda m: any("ground" not in s["collision2_name"] for s in m["states"]),
    "gz": lambda m: len(m["contacts"]) > 0,
    "pressed": lambda m: m["pressed"],
}
CHANGES = [
    SwitchChange(130 * MS, "left", True),
    SwitchChange(180 * MS, "center", True),
    SwitchChange(310 * MS, "left", False),
    SwitchChange(450 * MS, "center", False),
]


def messages_of(name: str, changes: Sequence[SwitchChange]) -> list[tuple[int, Any]]:
    """Return the messages of 700 ms, taken up in two parts."""
    topic = BumperTopic(BUMPER_TYPES[name], 0)
    header = json_header if name == "pressed" else ros_header
    early = [change for change in changes if change.stamp_ns < 300 * MS]
    late = [change for change in changes if change.stamp_ns >= 300 * MS]
    found = list(topic.messages(early, 300 * MS, header))
    return found + list(topic.messages(late, 700 * MS, header))


@pytest.mark.parametrize("name", [n for n, t in BUMPER_TYPES.items() if t.kind == "level"])
def test_level_topic_tells_its_state_all_the_time(name: str) -> None:
    """Ten messages a second; pressed while any switch is closed."""
    found = messages_of(name, CHANGES)

    assert [stamp // MS for stamp, _ in found] == [0, 100, 200, 300, 400, 500, 600]
    assert [bool(PRESSED[name](m)) for _, m in found] == [False] * 2 + [True] * 3 + [False] * 2


def test_edge_topic_tells_each_change_of_each_switch() -> None:
    """A Kobuki sends one message per change, with the number of the switch."""
    found = messages_of("kobuki", CHANGES)

    assert [stamp for stamp, _ in found] == [change.stamp_ns for change in CHANGES]
    assert [(m["bumper"], m["state"]) for _, m in found] == [(0, 1), (1, 1), (0, 0), (1, 0)]


def test_pulse_topic_is_silent_without_touch() -> None:
    """New Gazebo sends messages only while something touches, twenty a second."""
    found = messages_of("gz", CHANGES)

    assert [stamp // MS for stamp, _ in found] == [150, 200, 250, 300, 350, 400, 450]
    assert all(PRESSED["gz"](m) for _, m in found[:-1])


@pytest.mark.parametrize("name", BUMPER_TYPES)
def test_every_type_can_be_written(name: str) -> None:
    """Each message fits the definition of its type, in ROS1 and ROS2, or is JSON."""
    kind = BUMPER_TYPES[name]
    fields = messages_of(name, CHANGES)[2][1]

    if name == "pressed":
        payloads = [JsonEncoder().encode(kind.ros2, fields)]
    else:
        payloads = [
            RosEncoder(1).encode(kind.ros1, fields),
            RosEncoder(2).encode(kind.ros2, fields),
        ]

    assert all(payloads)
