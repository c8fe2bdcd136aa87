"""Bumps that were recorded as protobuf."""

import re
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.errors import LogError, UsageError
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.topics import Roles, TopicChoice, choose_roles
from mpap_cli.params import BumperParams
from tests.protobufs import payload, schema, write_protobuf, write_raw

TOUCHES = [False, True, True, False]


def bumps_of(path: Path, *words: str) -> tuple[Roles, list[tuple[int, bool]]]:
    """Return the topics taken, and moment and state of each change."""
    with open_log(path) as reader:
        roles = choose_roles(reader, TopicChoice(bumps=words))
        batches = list(Replay(reader, roles, BumperParams()))
    return roles, [(bump.stamp_ns, bump.pressed) for batch in batches for bump in batch.bumps]


@pytest.mark.parametrize(
    ("topic", "msgtype", "field"),
    [
        ("/bump", "robot.Bumper", "pressed"),
        ("/hand/contact", "robot.Touch", "touched"),
    ],
)
def test_bumper_is_found_by_its_boolean_field(
    tmp_path: Path, topic: str, msgtype: str, field: str
) -> None:
    """``pressed`` before others, else the only one; the topic's name must speak of bumps."""
    rows = [(topic, msgtype, 10 * n, {field: on}) for n, on in enumerate(TOUCHES)]
    path = write_protobuf(tmp_path / "log.mcap", rows)

    roles, bumps = bumps_of(path)

    assert [(role.rule.kind, role.rule.expression) for role in roles.bumps] == [("level", field)]
    assert bumps == [(0, False), (10, True), (30, False)]


@pytest.mark.parametrize(
    ("topic", "msgtype", "note"),
    [
        ("/lamp", "robot.Bumper", ""),
        ("/bump", "robot.Sides", "--bump-topic /bump:EXPR takes it"),
    ],
)
def test_other_booleans_are_not_taken_unasked(
    tmp_path: Path, topic: str, msgtype: str, note: str
) -> None:
    """Not under another name, and not one of several."""
    roles, bumps = bumps_of(write_protobuf(tmp_path / "log.mcap", [(topic, msgtype, 1, {})]))

    assert (roles.bumps, bumps) == ((), [])
    assert [one.rpartition("; ")[2] for one in roles.notes] == ([note] if note else [])


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("left | right", [(0, False), (1, True), (3, False)]),
        ("left", [(0, False), (2, True), (3, False)]),
        ("forces[] > 8", [(0, False), (2, True), (3, False)]),
        ("forces & 1", [(0, False), (1, True), (2, False)]),
    ],
)
def test_expression_reads_fields_and_lists(
    tmp_path: Path, expression: str, expected: list[tuple[int, bool]]
) -> None:
    """As of any message."""
    states = [{}, {"right": True, "forces": [2, 5]}, {"left": True, "forces": [0, 12]}, {}]
    rows = [("/x", "robot.Sides", n, state) for n, state in enumerate(states)]
    path = write_protobuf(tmp_path / "log.mcap", rows)

    assert bumps_of(path, f"/x:{expression}")[1] == expected


def test_expression_goes_through_messages(tmp_path: Path) -> None:
    """One that was not sent is there with its defaults."""
    parts, hit = [{"hit": False}, {"hit": True}], {"hit": True}
    states: list[dict[str, Any]] = [{}, {"parts": parts}, {"main": hit}]
    rows = [("/x", "robot.Parts", n, state) for n, state in enumerate(states)]
    path = write_protobuf(tmp_path / "log.mcap", rows)

    assert bumps_of(path, "/x:parts[].hit")[1] == [(0, False), (1, True), (2, False)]
    assert bumps_of(path, "/x:main.hit")[1] == [(0, False), (2, True)]


def test_field_that_is_not_there_is_named(tmp_path: Path) -> None:
    """With those that are."""
    path = write_protobuf(tmp_path / "log.mcap", [("/x", "robot.Bumper", 1, {})])
    text = "the message has no field hit (asked for hit); the fields are count, pressed"

    with pytest.raises(UsageError, match=re.escape(text)):
        bumps_of(path, "/x:hit")


def test_broken_message_is_left_out_and_counted(tmp_path: Path) -> None:
    """The others are used."""
    payloads = [payload("robot.Bumper"), b"\xff", payload("robot.Bumper", pressed=True)]
    path = write_raw(tmp_path / "log.mcap", "robot.Bumper", schema("robot.Bumper"), payloads)

    with open_log(path) as reader:
        replay = Replay(reader, choose_roles(reader), BumperParams())
        (batch,) = replay

    assert [(bump.stamp_ns, bump.pressed) for bump in batch.bumps] == [(0, False), (2, True)]
    assert dict(replay.skipped) == {"a bump message that does not fit its definition": 1}


@pytest.mark.parametrize("described", [b"", b"\xff\xfe", schema("robot.Touch")])
def test_schema_that_cannot_be_used_is_named_when_it_is_needed(
    tmp_path: Path, described: bytes
) -> None:
    """It does not hinder who does not ask for the topic."""
    path = write_raw(tmp_path / "log.mcap", "robot.Bumper", described, [b""])
    reason = "its protobuf schema is missing or cannot be used"

    assert bumps_of(path)[0].notes == (f"/bump (robot.Bumper) is not used: {reason}",)
    with pytest.raises(UsageError, match=f"--bump-topic /bump:pressed: {reason}$"):
        bumps_of(path, "/bump:pressed")
    text = f"log.mcap: topic /bump (robot.Bumper): {reason}"
    with open_log(path) as reader, pytest.raises(LogError, match=f"^{re.escape(text)}$"):
        reader.decode(next(reader.messages({"/bump"})))


def test_without_the_extra_the_line_to_paste_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the note, and in the error of who asks for the topic or decodes a message."""
    path = write_protobuf(tmp_path / "log.mcap", [("/bump", "robot.Bumper", 1, {})])
    monkeypatch.setattr("mpap_cli.logs.protobuf.find_spec", lambda _: None)
    reason = 'it is protobuf; pip install "mpap[protobuf]" to read it'

    assert bumps_of(path)[0].notes == (f"/bump (robot.Bumper) is not used: {reason}",)
    with pytest.raises(UsageError, match=re.escape(f"--bump-topic /bump:pressed: {reason}")):
        bumps_of(path, "/bump:pressed")
    with open_log(path) as reader, pytest.raises(LogError, match=re.escape("mpap[protobuf]")):
        reader.decode(next(reader.messages({"/bump"})))
