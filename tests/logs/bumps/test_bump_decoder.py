"""The decoder of bumper messages: memory, stamps, errors."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mpap_cli.errors import SettingError, UsageError
from mpap_cli.logs.bumps.bumpers import BUMPER_RULES, BumpDecoder, BumperRule
from mpap_cli.logs.files.runs import group_messages
from mpap_cli.logs.raw import LogReader, RawMessage
from mpap_cli.observations import Bump
from mpap_cli.params import BumperParams

MakeLog = Callable[..., LogReader]
DecodeBumps = Callable[..., list[Bump]]
Fields = dict[str, Any]

FREE_CONTACT = {"collision1_name": "ground_plane::link", "collision2_name": "robot::bumper"}
TOUCH_CONTACT = {"collision1_name": "robot::bumper", "collision2_name": "wall_3::link"}
HEADER = {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "base_link"}


def test_ignored_names_are_a_setting(decode_bumps: DecodeBumps) -> None:
    """bump-ignore says which bodies do not count; empty, all count."""
    messages = [{"states": [FREE_CONTACT]}, {"states": [TOUCH_CONTACT]}]
    msgtype = "gazebo_msgs/msg/ContactsState"

    walls = decode_bumps(msgtype, messages, params=BumperParams(bump_ignore="WALL"))
    nothing = decode_bumps(msgtype, messages, params=BumperParams(bump_ignore=""))

    assert [bump.pressed for bump in walls] == [True, False]
    assert [bump.pressed for bump in nothing] == [True, True]


def test_ignored_names_must_be_a_pattern(decode_bumps: DecodeBumps) -> None:
    """A pattern that does not parse is an error of the setting."""
    with pytest.raises(SettingError, match="setting bump-ignore"):
        decode_bumps("gazebo_msgs/msg/ContactsState", [{}], params=BumperParams(bump_ignore="["))


def test_a_level_stream_is_decoded_once_per_state(
    make_log: MakeLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A payload seen before, with another stamp, is remembered and says the same."""
    states = [stamp % 7 == 0 for stamp in range(100)]
    msgtype = "webots_ros/msg/BoolStamped"
    events = [
        ("/bump", msgtype, stamp, {"header": {"stamp": {"nanosec": stamp}}, "data": state})
        for stamp, state in enumerate(states)
    ]
    reader = make_log(events)
    decoded: list[RawMessage] = []
    decode_one = reader.decode

    def counted(message: RawMessage) -> object:
        decoded.append(message)
        return decode_one(message)

    monkeypatch.setattr(reader, "decode", counted)
    decoder = BumpDecoder(reader, BUMPER_RULES[msgtype], BumperParams())

    pieces = [decoder(run)[0] for group in reader.runs({"/bump"}) for run in group.runs]

    assert np.concatenate([piece.codes for piece in pieces]).tolist() == states
    assert len(decoded) == 2


def test_memory_of_payloads_is_bounded(make_log: MakeLog) -> None:
    """Payloads that never repeat, or are large, do not pile up."""
    small: list[Fields] = [{"bumper": 1, "left_encoder": count} for count in range(1500)]
    large: list[Fields] = [{"states": [{"info": "x" * 300}]}]

    for msgtype, messages in (
        ("kobuki_msgs/msg/SensorState", small),
        ("gazebo_msgs/msg/ContactsState", large),
    ):
        reader = make_log([("/b", msgtype, stamp, m) for stamp, m in enumerate(messages)])
        decoder = BumpDecoder(reader, BUMPER_RULES[msgtype], BumperParams())
        pieces = [decoder(run)[0] for group in reader.runs({"/b"}) for run in group.runs]
        assert np.concatenate([piece.codes for piece in pieces]).tolist() == [1] * len(messages)
        assert len(decoder._remembered) <= 1024
    assert not decoder._remembered


def test_expression_on_the_header_sees_every_stamp(decode_bumps: DecodeBumps) -> None:
    """A rule that asks for the header is not answered from memory."""
    rule = BumperRule("webots_ros/msg/BoolStamped", "level", "header.stamp.nanosec >= 2")
    messages: list[Fields] = [{"header": {"stamp": {"nanosec": stamp}}} for stamp in range(4)]

    bumps = decode_bumps(rule.msgtype, messages, rule=rule)

    assert [bump.pressed for bump in bumps] == [False, False, True, True]


@pytest.mark.parametrize("ros_version", [1, 2])
def test_header_stamps_on_demand(decode_bumps: DecodeBumps, ros_version: int) -> None:
    """With time source header the bump bears the stamp inside the message."""
    bumps = decode_bumps(
        "webots_ros/msg/BoolStamped",
        [{"header": HEADER, "data": True}],
        ros_version=ros_version,
        time_source="header",
    )

    assert bumps == [Bump(1_000_000_002, "", True)]


@pytest.mark.parametrize("ros_version", [0, 1, 2])
def test_header_stamp_of_a_type_without_header(decode_bumps: DecodeBumps, ros_version: int) -> None:
    """A type without header has log time only, and the error says so."""
    with pytest.raises(UsageError, match=r"log\.mcap: /bump \(std_msgs/msg/Bool\): no header"):
        decode_bumps(
            "std_msgs/msg/Bool",
            [{"data": True}],
            ros_version=ros_version,
            time_source="header",
        )


def test_field_that_the_log_does_not_have(decode_bumps: DecodeBumps) -> None:
    """A rule that does not fit names log, topic, type, field and the way out."""
    text = r"log\.mcap: /bump \(std_msgs/msg/Bool\): .*no field state .*--bump-topic /bump:EXPR"
    rule = BumperRule("std_msgs/msg/Bool", "level", "state == 1")

    with pytest.raises(UsageError, match=text):
        decode_bumps("std_msgs/msg/Bool", [{"data": True}], rule=rule)


def test_broken_messages_are_counted(make_log: MakeLog) -> None:
    """What does not fit its definition is left out, each by itself; the rest is read."""
    payloads = [b"\x00\x01", b"\x00\x01", b"\x00\x01\0\0\x01", b"\x00\x01\0\0\x01", b"\x00"]
    events = [("/bump", "std_msgs/msg/Bool", t, {"payload": p}) for t, p in enumerate(payloads)]
    reader = make_log(events)
    decoder = BumpDecoder(reader, BUMPER_RULES["std_msgs/msg/Bool"], BumperParams())
    ((run,),) = [group.runs for group in reader.runs({"/bump"})]

    piece, n_broken = decoder(run)

    assert n_broken == 3
    assert (piece.stamps_ns.tolist(), piece.codes.tolist()) == ([2, 3], [1, 1])


def test_prefix_parts_the_sensors_of_several_topics(decode_bumps: DecodeBumps) -> None:
    """The prefix stands before the sensor."""
    messages: list[Fields] = [{"bumper": 1, "state": 1}]

    bumps = decode_bumps("kobuki_msgs/msg/BumperEvent", messages, prefix="/front:")

    assert bumps == [Bump(0, "/front:1", True)]


def test_a_broken_start_is_an_error_of_that_message(make_log: MakeLog) -> None:
    """What follows in the payload may be known from before; where it begins wrong is no state."""
    msgtype = "webots_ros/msg/BoolStamped"
    reader = make_log([("/bump", msgtype, 0, {"header": HEADER, "data": True})])
    (whole,) = reader.messages({"/bump"})
    starts = [b"\0\1", b"\xff\xff", b"\0\1", b"\xff\xff"]
    messages = [
        whole._replace(stamp_ns=t, payload=start + whole.payload[2:])
        for t, start in enumerate(starts)
    ]
    ((run,),) = [group.runs for group in group_messages(iter(messages))]
    decoder = BumpDecoder(reader, BUMPER_RULES[msgtype], BumperParams(), time_source="header")

    piece, n_broken = decoder(run)
    backwards, n_broken_backwards = decoder(run.rows(np.arange(3, -1, -1)))

    assert n_broken == n_broken_backwards == 2
    assert piece.recorded_ns.tolist() == [0, 2]
    assert backwards.recorded_ns.tolist() == [2, 0]
    assert piece.stamps_ns.tolist() == [1_000_000_002] * 2
