"""Expressions after ``--bump-topic TOPIC:``."""

import contextlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import SettingError, UsageError
from mpap_cli.logs.bumps.expression import field_values, parse_expression
from mpap_cli.logs.writing.encoding import RosEncoder


@pytest.mark.parametrize(
    ("text", "message", "expected"),
    [
        ("in_protective_stop", {"in_protective_stop": True}, True),
        ("in_protective_stop", {"in_protective_stop": False}, False),
        ("bumper&7", {"bumper": 8}, False),
        ("bumper & 7", {"bumper": 12}, True),
        ("bumper & 0x04", {"bumper": np.uint8(12)}, True),
        ("bumper & 3 == 3", {"bumper": 7}, True),
        ("bumper & 3 == 3", {"bumper": 5}, False),
        ("data==0", {"data": False}, True),
        ("data == false", {"data": np.bool_(0)}, True),
        ("data != true", {"data": True}, False),
        ("range==-inf", {"range": -np.inf}, True),
        ("range == inf", {"range": np.float32("inf")}, True),
        ("range == -inf", {"range": 0.5}, False),
        ("range<0.1", {"range": 0.05}, True),
        ("range<=-1e-1", {"range": -0.1}, True),
        ("range>=2.", {"range": 1.9}, False),
        ("range>.5", {"range": float("nan")}, False),
        ("left | right", {"left": 0, "right": 1}, True),
        ("left & right", {"left": 0, "right": 1}, False),
        ("a==1 & b==1 | c", {"a": 1, "b": 0, "c": 1}, True),
        ("c | a==1 & b==1", {"a": 1, "b": 1, "c": 0}, True),
        ("detections[].type==1", {"detections": [{"type": 2}, {"type": 1}]}, True),
        ("detections.type==1", {"detections": [{"type": 2}]}, False),
        ("detections[].type==1", {"detections": []}, False),
        ("bumpers[]", {"bumpers": np.array([False, True])}, True),
        ("bumpers", {"bumpers": np.zeros(3, dtype=bool)}, False),
        ("states[]", {"states": [{}, {"a": 1}]}, True),
        ("collisions", {"collisions": []}, False),
        ("name", {"name": "wall"}, True),
        ("grid", {"grid": [[0, 0], [0, 3]]}, True),
    ],
)
def test_expression_decides(text: str, message: dict[str, Any], expected: bool) -> None:
    """An expression holds if any value at its path passes the test."""
    assert parse_expression(text)(message) is expected


@pytest.mark.parametrize(
    "text",
    [
        *("", " ", "&", "bumper &", "bumper & 1.5", "== 1", "1 == 1", "a ==", "a == b", "a[0]"),
        *("a..b", "a.", "a b", "a == 1 2", "a & & b", "a == 1 & 3", "__import__('os')", "a == 'x'"),
        *("a | 3", "f(x)", "a; b", "a ! b", "a == nan"),
    ],
)
def test_bad_syntax_is_a_setting_error(text: str) -> None:
    """What is no expression is named together with what was expected."""
    with pytest.raises(SettingError, match="--bump-topic expression"):
        parse_expression(text)


def test_missing_field_is_named_with_those_there_are() -> None:
    """A field that the message does not have leads to the list of its fields."""
    holds = parse_expression("left.stat")
    message = RosEncoder(2).store.types["std_msgs/msg/Int32"](3)

    with pytest.raises(UsageError, match=r"no field left \(asked for left\.stat\).*are data"):
        holds(message)


def test_field_of_a_number_does_not_exist() -> None:
    """A path that goes on behind a number says that there are no fields."""
    with pytest.raises(UsageError, match=r"no field state .*no fields there"):
        parse_expression("left.state")({"left": 1})


def test_attributes_that_are_no_fields_are_out_of_reach() -> None:
    """Only fields of messages can be read, not attributes of Python objects."""
    with pytest.raises(UsageError, match="no field x"):
        parse_expression("x")(SimpleNamespace(x=1))


def test_bits_of_a_fraction_have_no_meaning() -> None:
    """``&`` with a number asks for whole numbers."""
    with pytest.raises(UsageError, match="no whole number"):
        parse_expression("range & 1")({"range": 0.5})


@pytest.mark.parametrize("value", ["wall", {"sec": 1}])
def test_texts_and_messages_cannot_be_compared(value: object) -> None:
    """A comparison asks for numbers."""
    with pytest.raises(UsageError, match="is no number"):
        parse_expression("info == 1")({"info": value})


def test_field_values_walks_through_lists() -> None:
    """Every element on the way is visited, in order."""
    message = {"states": [{"names": ["a", "b"]}, {"names": []}, {"names": ["c"]}]}

    values = list(field_values(message, "states[].names[]"))

    assert values == ["a", "b", "c"]


@given(value=st.integers(0, 255), mask=st.integers(0, 255), literal=st.integers(0, 255))
def test_mask_and_comparison_agree_with_python(value: int, mask: int, literal: int) -> None:
    """Bits are taken before values are compared."""
    message = {"bumper": np.uint8(value)}

    assert parse_expression(f"bumper & {mask}")(message) is bool(value & mask)
    assert parse_expression(f"bumper&{mask}=={literal}")(message) is (value & mask == literal)
    assert parse_expression(f"bumper<{literal}")(message) is (value < literal)


@given(st.text(max_size=40))
def test_any_text_is_an_expression_or_a_setting_error(text: str) -> None:
    """No text leads to another error."""
    with contextlib.suppress(SettingError):
        parse_expression(text)
