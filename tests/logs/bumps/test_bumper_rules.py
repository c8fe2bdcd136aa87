"""Rules of bumper types, and what ``--bump-topic`` puts over them."""

import re

import pytest

from mpap_cli.errors import SettingError
from mpap_cli.logs.bumps.bumper_rules import (
    BUMPER_RULES,
    BumpChoice,
    BumperRule,
    apply_choice,
    parse_bump_topic,
)


@pytest.mark.parametrize(
    ("text", "choice"),
    [
        ("/bump", BumpChoice("/bump")),
        ("/x:data==0", BumpChoice("/x", "data==0")),
        ("/x:a == 1 | b:level", BumpChoice("/x", "a == 1 | b", "level")),
        ("/x:level", BumpChoice("/x", None, "level")),
        ("/x:level:level", BumpChoice("/x", "level", "level")),
        ("/x:edge=bumper", BumpChoice("/x", None, "edge", "bumper")),
        ("/x:state==1:edge=switch.id", BumpChoice("/x", "state==1", "edge", "switch.id")),
        ("/x:pulse=0.5", BumpChoice("/x", None, "pulse", "", 0.5)),
        ("/x:pulse", BumpChoice("/x", None, "pulse")),
        ("/x:type==1:pulse=2", BumpChoice("/x", "type==1", "pulse", "", 2.0)),
        ("/x:edge==1", BumpChoice("/x", "edge==1")),
    ],
)
def test_bump_topic_is_split(text: str, choice: BumpChoice) -> None:
    """Topic, expression and kind are told apart; only the topic must be there."""
    assert parse_bump_topic(text) == choice


@pytest.mark.parametrize(
    "text",
    [
        *("", ":", ":data", "/x:a:b", "/x:edge", "/x:edge=", "/x:edge=1", "/x:pulse="),
        *("/x:pulse=-1", "/x:pulse=0", "/x:pulse=fast", "/x:", "/x:a==", "/x:level:edge"),
        "/x:a:b:level",
    ],
)
def test_bump_topic_that_makes_no_sense(text: str) -> None:
    """What cannot be split is an error that begins with the option."""
    with pytest.raises(SettingError, match=r"^--bump-topic"):
        parse_bump_topic(text)


def test_choice_goes_over_the_rule_of_the_type() -> None:
    """An expression replaces the rule, a kind alone changes it, a topic alone keeps it."""
    rule = BUMPER_RULES["gazebo_msgs/msg/ContactsState"]
    pulse = apply_choice(rule, rule.msgtype, parse_bump_topic("/x:pulse=1"))
    own = apply_choice(rule, rule.msgtype, parse_bump_topic("/x:states"))

    assert apply_choice(rule, rule.msgtype, parse_bump_topic("/x")) == rule
    assert pulse is not None
    assert (pulse.kind, pulse.hold_s, pulse.ignore_fields) == ("pulse", 1.0, rule.ignore_fields)
    assert own == BumperRule(rule.msgtype, "level", "states")
    assert apply_choice(None, "my_msgs/msg/X", parse_bump_topic("/x:level")) is None


def test_rule_texts_are_expressions() -> None:
    """Every rule parses as what could be typed after --bump-topic."""
    for rule in BUMPER_RULES.values():
        if rule.expression:
            assert parse_bump_topic(f"/x:{rule.expression}:level").expression == rule.expression
        assert re.fullmatch(r"\w+/msg/\w+", rule.msgtype)
