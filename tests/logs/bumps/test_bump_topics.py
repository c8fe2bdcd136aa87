"""Which topics are taken as bumpers, and why."""

from collections.abc import Callable
from typing import Any

import pytest

from mpap_cli.errors import UsageError
from mpap_cli.logs.raw import LogReader, Topic
from mpap_cli.logs.topics import Roles, TopicChoice, choose_roles

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

LASER_SCAN = "sensor_msgs/msg/LaserScan"
BOOL, INT8S = "std_msgs/msg/Bool", "std_msgs/msg/Int8MultiArray"
CONTACTS = "gazebo_msgs/msg/ContactsState"
TOUCH = {"states": [{"collision1_name": "robot", "collision2_name": "wall"}]}
KOBUKI_STATE, KOBUKI_EVENT = "kobuki_msgs/msg/SensorState", "kobuki_msgs/msg/BumperEvent"
HAZARD = "irobot_create_msgs/msg/HazardDetection"


def one_of_each(**types: str) -> list[Event]:
    """Return one empty message a topic: the name's underscores are slashes."""
    return [("/" + name.replace("__", "/"), msgtype, 1, {}) for name, msgtype in types.items()]


def listed(name: str, msgtype: str, encoding: str = "cdr", n_messages: int = 3) -> Topic:
    """Return a topic that is listed but has no message to read."""
    return Topic(name, msgtype, encoding, n_messages, "", "")


def bump_name(roles: Roles) -> str | None:
    """Return the name of the only bump topic, if there is one."""
    names = [role.topic.name for role in roles.bumps]
    assert len(names) <= 1
    return names[0] if names else None


def bump_roles(make_log: MakeLog, events: list[Event], **words: Any) -> Roles:
    """Choose the roles of a log that may have a bumper."""
    return choose_roles(make_log(events, **words))


@pytest.mark.parametrize(
    ("types", "expected"),
    [
        ({"sensors__core": KOBUKI_STATE}, "/sensors/core"),
        ({"bumper": BOOL, "x": "create_msgs/msg/Bumper"}, "/bumper"),
        ({"x": BOOL, "enabled": BOOL}, None),
        ({"wrist__wrist_bumper": BOOL, "lamp": BOOL}, "/wrist/wrist_bumper"),
        ({"Collision_detected": BOOL}, "/Collision_detected"),
        ({"array": INT8S}, None),
        ({"sonar": "sensor_msgs/msg/Range"}, None),
        ({"x_states": CONTACTS}, None),
        ({"contact": CONTACTS}, "/contact"),
        ({"bumper_contact": "ros_gz_interfaces/msg/Contacts"}, "/bumper_contact"),
        ({"collision_monitor_state": "nav2_msgs/msg/CollisionMonitorState"}, None),
        ({"hazard": "nav2_msgs/msg/CollisionDetectorState", "bump": BOOL}, "/bump"),
        ({"hazard_detection": HAZARD + "Vector", "bumper__event": HAZARD}, "/hazard_detection"),
        ({"bumper": "std_msgs/msg/String"}, None),
        ({"cmd_vel": "geometry_msgs/msg/Twist"}, None),
    ],
)
def test_bump_topic_is_found_by_type_and_name(
    make_log: MakeLog, types: dict[str, str], expected: str | None
) -> None:
    """Plain types need a telling name; protective stops are never taken unasked."""
    roles = bump_roles(make_log, one_of_each(**types))

    assert bump_name(roles) == expected


def test_bumper_in_an_encoding_that_is_not_read_is_not_taken(make_log: MakeLog) -> None:
    """A topic whose messages cannot be decoded says nothing of bumps, but is named."""
    flatbuffer = Topic("/bump", BOOL, "flatbuffer", 4, "", "")
    reason = "encoding flatbuffer cannot be read"

    roles = bump_roles(make_log, [], empty=[flatbuffer])

    assert (roles.bumps, roles.notes) == ((), (f"/bump ({BOOL}) is not used: {reason}",))
    with pytest.raises(UsageError, match=f"--bump-topic /bump: {reason}"):
        choose_roles(make_log([], empty=[flatbuffer]), TopicChoice(bumps=("/bump",)))


def test_missing_bump_topic_says_how_to_name_one(make_log: MakeLog) -> None:
    """No bump topic is no error; what looks like one is named."""
    events = one_of_each(
        scan=LASER_SCAN,
        bumper="std_msgs/msg/String",
        stop="nav2_msgs/msg/CollisionMonitorState",
    )

    roles = bump_roles(make_log, events)

    assert roles.bumps == ()
    assert roles.bump_reason == "no bump topic; name one with --bump-topic TOPIC:EXPR"
    assert [note.split(" is not taken as a bumper unasked; ") for note in roles.notes] == [
        ["/bumper (std_msgs/msg/String, 1 messages)", "--bump-topic /bumper:EXPR takes it"],
        ["/stop (nav2_msgs/msg/CollisionMonitorState, 1 messages)", "--bump-topic /stop takes it"],
    ]


def test_clear_choice_reads_no_message(make_log: MakeLog) -> None:
    """Messages are read only to break a tie."""
    reader = make_log(one_of_each(bump="neato_node/msg/Bump", bumper=BOOL, other=KOBUKI_STATE))

    roles = choose_roles(reader)

    assert bump_name(roles) == "/bump"
    assert roles.bump_candidates == ("/bump", "/bumper", "/other")


def test_switches_go_before_contacts_of_a_simulator(make_log: MakeLog) -> None:
    """/bump of switches and /bumper of contacts tell the same; one is taken, with the reason."""
    events: list[Event] = [("/bump", INT8S, 1, {"data": [1]}), ("/bumper", CONTACTS, 1, TOUCH)]

    roles = bump_roles(make_log, events)

    assert bump_name(roles) == "/bump"
    assert roles.bump_reason == (
        "switches go before a simulator's contacts, of /bump, /bumper; --bump-topic takes another"
    )


def test_topic_that_fires_goes_before_one_that_never_does(make_log: MakeLog) -> None:
    """Between equals the one with a touch is taken."""
    events: list[Event] = [("/bump", INT8S, 1, {"data": [0]}), ("/bumper", CONTACTS, 1, TOUCH)]

    roles = bump_roles(make_log, events)

    assert bump_name(roles) == "/bumper"
    assert roles.bump_reason.startswith("pressed at times, of /bump, /bumper;")


@pytest.mark.parametrize(
    ("bits", "expected"), [(2, "/mobile_base/sensors/core"), (0, "/mobile_base/events/bumper")]
)
def test_level_goes_before_event_of_the_same_robot(
    make_log: MakeLog, bits: int, expected: str
) -> None:
    """The state that is always sent is taken, unless only the events ever tell of a touch."""
    events: list[Event] = [
        ("/mobile_base/events/bumper", KOBUKI_EVENT, 1, {"state": 1}),
        ("/mobile_base/sensors/core", KOBUKI_STATE, 1, {"bumper": bits}),
    ]

    assert bump_name(bump_roles(make_log, events)) == expected


def test_equals_are_taken_by_name(make_log: MakeLog) -> None:
    """Two topics that differ in nothing: the first by name, and the other is named."""
    events: list[Event] = [
        (name, BOOL, 1, {"data": True}) for name in ("/bump_right", "/bump_left")
    ]

    roles = bump_roles(make_log, events)

    assert bump_name(roles) == "/bump_left"
    assert roles.bump_reason.startswith("the first by name of equals, of /bump_left, /bump_right")


def test_rule_that_does_not_fit_its_log_loses_the_tie(make_log: MakeLog) -> None:
    """A JSON topic of a known name with other fields is not the better of two."""
    events: list[Event] = [("/bump_a", BOOL, 1, {"on": 1}), ("/bump_b", BOOL, 1, {"data": True})]

    assert bump_name(bump_roles(make_log, events, ros_version=0)) == "/bump_b"


def test_message_cut_short_is_passed_over_in_a_tie(make_log: MakeLog) -> None:
    """One broken message does not decide."""
    events: list[Event] = [
        ("/bump_a", BOOL, 1, {"payload": b"\x00"}),
        ("/bump_a", BOOL, 2, {"data": True}),
        ("/bump_b", BOOL, 1, {"data": False}),
    ]

    assert bump_name(bump_roles(make_log, events)) == "/bump_a"


def test_bumpers_spread_over_topics_are_joined(make_log: MakeLog) -> None:
    """A Pioneer has a topic for its front and one for its rear: both are taken."""
    pioneer = "pioneer_msgs/msg/BumperState"

    roles = bump_roles(make_log, one_of_each(front_bumper=pioneer, rear_bumper=pioneer))

    assert [role.topic.name for role in roles.bumps] == ["/front_bumper", "/rear_bumper"]


@pytest.mark.parametrize(
    ("msgtype", "expected"),
    [("neato_node/msg/Bump", None), (KOBUKI_EVENT, "/bumper"), (HAZARD, "/bumper")],
)
def test_topic_without_message(make_log: MakeLog, msgtype: str, expected: str | None) -> None:
    """No event means no touch, which is knowledge; no level means nothing."""
    roles = bump_roles(make_log, [], empty=[listed("/bumper", msgtype, n_messages=0)])

    assert bump_name(roles) == expected


@pytest.mark.parametrize(
    ("name", "fields", "expression"),
    [
        ("/bump", {"pressed": True}, "pressed"),
        ("/bump", {"data": False, "count": 3}, "data"),
        ("/bump", {"data": 1}, None),
        ("/bump", {"pressed": 1, "data": True}, "data"),
        ("/lamp", {"data": True}, None),
    ],
)
def test_json_bumper_is_found_by_its_field(
    make_log: MakeLog, name: str, fields: dict[str, Any], expression: str | None
) -> None:
    """A boolean ``pressed`` or ``data`` on a topic with a telling name is a level."""
    roles = bump_roles(make_log, [(name, "Bumper", 1, fields)], ros_version=0)

    wanted = [] if expression is None else [("level", expression)]
    assert [(role.rule.kind, role.rule.expression) for role in roles.bumps] == wanted


@pytest.mark.parametrize(
    ("schema", "expression"),
    [
        ('{"properties": {"data": {"type": "number"}, "pressed": {"type": "boolean"}}}', "pressed"),
        ('{"properties": {"data": {"type": "number"}}}', None),
        ('{"properties": {"pressed": true}}', None),
        ("[]", None),
        ("{", None),
    ],
)
def test_json_schema_tells_the_field(
    make_log: MakeLog, schema: str, expression: str | None
) -> None:
    """Where there is a schema, no message is read."""
    topic = Topic("/bump", "Bumper", "json", 4, schema, "jsonschema")

    roles = bump_roles(make_log, [], empty=[topic])

    wanted = [] if expression is None else [expression]
    assert [role.rule.expression for role in roles.bumps] == wanted


@pytest.mark.parametrize("payload", [b"[1]", b"{"])
def test_broken_json_is_no_bumper(make_log: MakeLog, payload: bytes) -> None:
    """A first message that is no JSON object says nothing."""
    events: list[Event] = [("/bump", "Bumper", 1, {"payload": payload})]

    assert bump_roles(make_log, events, ros_version=0).bumps == ()
