"""Bump topics that are asked for, and bumps from elsewhere."""

from collections.abc import Callable
from typing import Any

import pytest

from mpap_cli.errors import SettingError, UsageError
from mpap_cli.logs.raw import LogReader, Topic
from mpap_cli.logs.topics import TopicChoice, choose_roles

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

BOOL = "std_msgs/msg/Bool"


def one_of_each(**types: str) -> list[Event]:
    """Return one empty message a topic: the name's underscores are slashes."""
    return [("/" + name.replace("__", "/"), msgtype, 1, {}) for name, msgtype in types.items()]


@pytest.mark.parametrize("bump_from", ["scan", "none", "file"])
def test_bumps_from_elsewhere_need_no_topic(make_log: MakeLog, bump_from: str) -> None:
    """No bump topic is looked for, even if there is one."""
    roles = choose_roles(
        make_log(one_of_each(bump="neato_node/msg/Bump")), TopicChoice(bump_from=bump_from)
    )

    assert roles.bumps == ()
    assert roles.bump_reason == f"not looked for (--bump-from {bump_from})"


def test_bump_topic_and_bumps_from_elsewhere_exclude_each_other(make_log: MakeLog) -> None:
    """No option is ignored."""
    choice = TopicChoice(bumps=("/bump",), bump_from="scan")

    with pytest.raises(UsageError, match="--bump-from scan exclude each other"):
        choose_roles(make_log(one_of_each(bump="neato_node/msg/Bump")), choice)


def test_asked_for_bump_of_unknown_type(make_log: MakeLog) -> None:
    """An expression makes any type a bumper; a boolean field ``data`` will do without."""
    text = "std_msgs/Header header\nbool data\n====\nMSG: std_msgs/Header\nbool pressed"
    unknown = Topic("/touch", "my_msgs/msg/Touch", "cdr", 0, text, "ros2msg")
    reader = make_log([("/odom", "nav_msgs/msg/Odometry", 1, {})], empty=[unknown])
    expression = "/odom:twist.twist.linear.x > 0.5"

    by_field = choose_roles(reader, TopicChoice(bumps=("/touch",)))
    by_expression = choose_roles(reader, TopicChoice(bumps=(expression,)))

    assert [role.rule.expression for role in by_field.bumps] == ["data"]
    (role,) = by_expression.bumps
    assert role.rule.expression == "twist.twist.linear.x > 0.5"
    assert by_expression.bump_reason == "asked for"


def test_protective_stop_is_taken_when_asked_for(make_log: MakeLog) -> None:
    """--bump-topic opts in, and may change the kind."""
    events = one_of_each(stop="nav2_msgs/msg/CollisionMonitorState")

    roles = choose_roles(make_log(events), TopicChoice(bumps=("/stop:pulse=0.5",)))

    (role,) = roles.bumps
    assert (role.rule.kind, role.rule.hold_s) == ("pulse", 0.5)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("/left", "/left:data==0"), "named twice"),
        (("/left", "/right:pulse"), "pulse topics cannot be joined"),
    ],
)
def test_bump_topics_that_cannot_be_joined(
    make_log: MakeLog, words: tuple[str, ...], text: str
) -> None:
    """A topic counts once, and touches without release do not mix with states."""
    reader = make_log(one_of_each(left=BOOL, right=BOOL))

    with pytest.raises(UsageError, match=text):
        choose_roles(reader, TopicChoice(bumps=words))


def test_first_message_may_be_broken(make_log: MakeLog) -> None:
    """An expression is tried on the first message that can be decoded."""
    events: list[Event] = [("/x", BOOL, 1, {"payload": b""}), ("/x", BOOL, 2, {"data": True})]

    with pytest.raises(UsageError, match="no field state"):
        choose_roles(make_log(events), TopicChoice(bumps=("/x:state",)))


def test_bad_kind_is_a_setting_error(make_log: MakeLog) -> None:
    """A word after the topic that is no kind and no expression is refused."""
    with pytest.raises(SettingError, match="expected edge=FIELD"):
        choose_roles(make_log(one_of_each(x=BOOL)), TopicChoice(bumps=("/x:edge",)))
