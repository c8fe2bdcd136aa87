"""What bumper messages of every known type say."""

from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mpap_cli.logs.bumps.bumpers import (
    BUMPER_RULES,
)
from mpap_cli.observations import Bump

DecodeBumps = Callable[..., list[Bump]]
Fields = Mapping[str, Any]

FREE_CONTACT = {"collision1_name": "ground_plane::link", "collision2_name": "robot::bumper"}
TOUCH_CONTACT = {"collision1_name": "robot::bumper", "collision2_name": "wall_3::link"}
FREE_GZ = {"collision1": {"name": "robot"}, "collision2": {"name": "Terrain_1"}}
TOUCH_GZ = {"collision1": {"name": "robot"}, "collision2": {"name": "box"}}
NEATO1 = ("leftFront", "leftSide", "rightFront", "rightSide")
NEATO2 = ("left_front", "left_side", "right_front", "right_side")
FEET = ("l_foot_bumper_left", "l_foot_bumper_right", "r_foot_bumper_left", "r_foot_bumper_right")

KOBUKI = ([{"bumper": 2, "state": 1}], [{"bumper": 2, "state": 0}])
KOBUKI_STATE = (
    [{"bumper": 1}, {"bumper": 2}, {"bumper": 4}, {"bumper": 7}],
    [{"bumper": 0, "wheel_drop": 3, "cliff": 7}, {"bumper": 8}],
)
CREATE = (
    [{"is_left_pressed": True}, {"is_right_pressed": True}],
    [{"is_light_left": True, "is_light_center_right": True, "light_signal_left": 4000}],
)
ROOMBA_1 = (
    [{"bumps_wheeldrops": 1}, {"bumps_wheeldrops": 2}, {"bumps_wheeldrops": 31}],
    [{"bumps_wheeldrops": 0}, {"bumps_wheeldrops": 4}, {"bumps_wheeldrops": 28, "wall": True}],
)
GZ = (
    [{"contacts": [TOUCH_GZ]}, {"contacts": [FREE_GZ, TOUCH_GZ]}],
    [{"contacts": []}, {"contacts": [FREE_GZ]}],
)
STOP = ([{"scanner_stop": True}], [{"emergency_button_stop": True, "emergency_state": 1}])

# message type: (messages that are pressed, messages that are free)
CASES: dict[str, tuple[list[Any], list[Any]]] = {
    "kobuki_msgs/msg/BumperEvent": KOBUKI,
    "kobuki_ros_interfaces/msg/BumperEvent": KOBUKI,
    "kobuki_msgs/msg/SensorState": KOBUKI_STATE,
    "kobuki_ros_interfaces/msg/SensorState": KOBUKI_STATE,
    "create_msgs/msg/Bumper": CREATE,
    "ca_msgs/msg/Bumper": CREATE,
    "irobot_create_msgs/msg/HazardDetectionVector": (
        [{"detections": [{"type": 1}]}, {"detections": [{"type": 2}, {"type": 1}]}],
        [{"detections": []}, *({"detections": [{"type": kind}]} for kind in (0, 2, 3, 4, 5))],
    ),
    "irobot_create_msgs/msg/HazardDetection": ([{"type": 1}], [{"type": 0}, {"type": 3}]),
    "create_node/msg/TurtlebotSensorState": ROOMBA_1,
    "turtlebot_node/msg/TurtlebotSensorState": ROOMBA_1,
    "turtlebot3_msgs/msg/SensorState": (
        [{"bumper": 1}, {"bumper": 2}, {"bumper": 3}],
        [{"bumper": 0, "cliff": 5.0, "button": 1}, {"bumper": 4}],
    ),
    "rosaria/msg/BumperState": (
        [{"front_bumpers": [0, 1], "rear_bumpers": [0]}, {"rear_bumpers": [1]}],
        [{}, {"front_bumpers": [0, 0], "rear_bumpers": [0]}],
    ),
    "pioneer_msgs/msg/BumperState": ([{"bumpers": [0, 1]}], [{"bumpers": [0, 0]}, {}]),
    "scitos_msgs/msg/MotorStatus": (
        [{"bumper_pressed": True}],
        [{"motor_stopped": True, "emergency_button_pressed": True}],
    ),
    "scitos2_msgs/msg/BumperStatus": ([{"bumper_status": True}], [{"bumper_activated": True}]),
    "std_msgs/msg/Bool": ([{"data": True}], [{"data": False}]),
    "naoqi_bridge_msgs/msg/Bumper": ([{"bumper": 1, "state": 1}], [{"bumper": 1, "state": 0}]),
    "nao_sensor_msgs/msg/Buttons": ([{foot: True} for foot in FEET], [{"chest": True}]),
    "pal_device_msgs/msg/Bumper": ([{"is_pressed": True}], [{"is_pressed": False}]),
    "mobile_base_driver/msg/Bumper": ([{"state": 1}], [{"bumper": 1, "state": 0}]),
    "am_driver/msg/SensorStatus": (
        [{"sensorStatus": 4}, {"sensorStatus": 0x8006}],
        [{"sensorStatus": 3, "operationalMode": 4}],
    ),
    "gazebo_msgs/msg/ContactsState": (
        [{"states": [TOUCH_CONTACT]}, {"states": [FREE_CONTACT, TOUCH_CONTACT]}],
        [{"states": []}, {"states": [FREE_CONTACT]}],
    ),
    "ros_gz_interfaces/msg/Contacts": GZ,
    "ros_ign_interfaces/msg/Contacts": GZ,
    "flatland_msgs/msg/Collisions": ([{"collisions": [{"entity_A": "robot"}]}], [{}]),
    "webots_ros/msg/BoolStamped": ([{"data": True}], [{"data": False}]),
    "carla_msgs/msg/CarlaCollisionEvent": ([{}, {"other_actor_id": 7}], []),
    "sensor_msgs/msg/Range": (
        [{"range": -np.inf}],
        [{"range": np.inf}, {"range": 0.01}, {"range": 0.0}, {"range": np.nan}],
    ),
    "roomba_500_series/msg/Bumper": (
        [{"left": {"state": True}}, {"right": {"state": True}}],
        [{}],
    ),
    "neato_node/msg/Bump": ([{switch: 1} for switch in NEATO1], [{}]),
    "neato2_interfaces/msg/Bump": ([{switch: 255} for switch in NEATO2], [{}]),
    "std_msgs/msg/Int8MultiArray": (
        [{"data": [0, 0, 1, 0]}, {"data": [-1]}],
        [{"data": [0, 0]}, {"data": []}],
    ),
    "nav2_msgs/msg/CollisionMonitorState": (
        [{"action_type": 1}],
        [{"action_type": 0}, {"action_type": 2, "polygon_name": "Slow"}, {"action_type": 3}],
    ),
    "nav2_msgs/msg/CollisionDetectorState": (
        [{"polygons": ["a", "b"], "detections": [False, True]}],
        [{"polygons": ["a"], "detections": [False]}, {}],
    ),
    "cob_msgs/msg/EmergencyStopState": STOP,
    "neo_msgs/msg/EmergencyStopState": STOP,
}
# types whose definition must come with the log: JSON objects stand for the decoded message
BARE_CASES: dict[str, tuple[Fields, Fields]] = {
    "naoqi_bridge_msgs/msg/BoolStamped": ({"data": True}, {"data": False}),
    "roomba_500driver_meiji/msg/Roomba500State": (
        {"bump": {"left": 0, "right": 1}},
        {"bump": {"left": 0, "right": 0}},
    ),
    "mir_msgs/msg/SafetyStatus": ({"in_protective_stop": True}, {"in_protective_stop": False}),
    "robotnik_msgs/msg/SafetyModuleStatus": ({"safety_stop": True}, {"safety_stop": False}),
    "mower_msgs/msg/Emergency": ({"active_emergency": True}, {"active_emergency": False}),
}
# types that only stand inside others
INNER_TYPES = {
    "flatland_msgs/msg/Collision",
    "flatland_msgs/msg/Vector2",
    "gazebo_msgs/msg/ContactState",
    "roomba_500_series/msg/RoombaSwitch",
    *(f"ros_{gz}_interfaces/msg/{name}" for gz in ("gz", "ign") for name in ("Contact", "Entity")),
    *(f"ros_{gz}_interfaces/msg/JointWrench" for gz in ("gz", "ign")),
}
EDGE_TYPES = [msgtype for msgtype, rule in BUMPER_RULES.items() if rule.kind == "edge"]


def built_in_definitions() -> dict[str, str]:
    """Return the text of every built-in definition by type."""
    return {
        path.name.removesuffix(".msg").replace("__", "/"): path.read_text("utf-8")
        for path in (files("mpap_cli.logs") / "definitions").iterdir()
        if path.name.endswith(".msg")
    }


def test_every_rule_has_its_case() -> None:
    """No type is without a test of what is pressed and what is free."""
    assert set(BUMPER_RULES) == set(CASES) | set(BARE_CASES)


def test_every_type_that_the_stores_lack_is_built_in() -> None:
    """The definitions that the rules need are there, with those inside them."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    needed = {msgtype for msgtype in CASES if msgtype not in store.types}

    assert needed | INNER_TYPES <= set(built_in_definitions())


@pytest.mark.parametrize("name", ["ROS1_NOETIC", "ROS2_HUMBLE", "LATEST"])
def test_definitions_register_in_every_store(name: str) -> None:
    """The texts parse with ROS 1 and ROS 2 headers."""
    store = get_typestore(Stores[name] if name != "LATEST" else Stores.LATEST)
    types: dict[str, Any] = {}
    for msgtype, text in built_in_definitions().items():
        types |= get_types_from_msg(text, msgtype)

    store.register(types)

    assert set(types) <= set(store.types)


@pytest.mark.parametrize("ros_version", [1, 2])
@pytest.mark.parametrize("msgtype", CASES)
def test_pressed_and_free_are_told_apart(
    decode_bumps: DecodeBumps, msgtype: str, ros_version: int
) -> None:
    """A message of every type says what its documentation says."""
    pressed, free = CASES[msgtype]

    bumps = decode_bumps(msgtype, [*pressed, *free, *pressed], ros_version=ros_version)

    states = [bump.pressed for bump in bumps]
    assert states == [True] * len(pressed) + [False] * len(free) + [True] * len(pressed)
    assert [bump.stamp_ns for bump in bumps] == list(range(len(bumps)))


@pytest.mark.parametrize("msgtype", BARE_CASES)
def test_rules_without_definition_read_the_documented_field(
    decode_bumps: DecodeBumps, msgtype: str
) -> None:
    """A type whose definition comes with the log is read by its field names."""
    bumps = decode_bumps(msgtype, list(BARE_CASES[msgtype]), ros_version=0)

    assert [bump.pressed for bump in bumps] == [True, False]


def test_kinds_are_as_documented() -> None:
    """Edges, pulses and protective stops are marked as such, all else is a level."""
    kinds: dict[str, set[str]] = {"level": set(), "edge": set(), "pulse": set()}
    for msgtype, rule in BUMPER_RULES.items():
        kinds[rule.kind].add(msgtype)
    opt_in = {msgtype.split("/")[0] for msgtype, rule in BUMPER_RULES.items() if rule.opt_in}

    assert kinds["edge"] == {
        "kobuki_msgs/msg/BumperEvent",
        "kobuki_ros_interfaces/msg/BumperEvent",
        "naoqi_bridge_msgs/msg/Bumper",
        "mobile_base_driver/msg/Bumper",
    }
    assert kinds["pulse"] == {
        "irobot_create_msgs/msg/HazardDetection",
        "ros_gz_interfaces/msg/Contacts",
        "ros_ign_interfaces/msg/Contacts",
        "carla_msgs/msg/CarlaCollisionEvent",
    }
    robots = {"nav2_msgs", "cob_msgs", "neo_msgs", "mir_msgs", "robotnik_msgs", "mower_msgs"}
    assert opt_in == robots


@pytest.mark.parametrize("msgtype", EDGE_TYPES)
def test_an_edge_names_its_sensor(decode_bumps: DecodeBumps, msgtype: str) -> None:
    """Left and right pressed, left released: right is still pressed, and the bumps say so."""
    left, right = {"bumper": 0, "state": 1}, {"bumper": 2, "state": 1}
    released = {"bumper": 0, "state": 0}

    bumps = decode_bumps(msgtype, [left, right, released])

    assert bumps == [Bump(0, "0", True), Bump(1, "2", True), Bump(2, "0", False)]
