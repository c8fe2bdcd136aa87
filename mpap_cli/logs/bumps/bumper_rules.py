"""What counts as pressed: one rule per message type, or what ``--bump-topic`` says.

The rules are data: ``definitions/bumpers.toml``.
"""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from types import MappingProxyType
from typing import Literal, NamedTuple

from mpap_cli.errors import SettingError
from mpap_cli.logs.bumps.expression import parse_expression

BumpKind = Literal["level", "edge", "pulse"]


@dataclass(frozen=True, slots=True)
class BumperRule:
    """What one message of a type says of the bumper.

    Parameters
    ----------
    msgtype : str
        Type in ROS2 form, or the name of a schema.
    kind : {"level", "edge", "pulse"}
        Every message carries the whole state; one message per change of one sensor; or
        messages come only while touching.
    expression : str
        Test on one message; empty: every message is a touch.
    sensor_field : str
        Edge: the field that names the sensor.
    hold_s : float, optional
        Pulse: seconds that a touch lasts; None: the setting bump-hold.
    opt_in : bool
        A protective stop or near miss: taken only when asked for.
    ignore_fields : tuple of str
        Names of the bodies in one contact; with an ignored name it does not count.
    needs_name : bool
        Taken unasked only if the topic's name speaks of bumps.
    all_topics : bool
        The robot spreads its bumpers over several topics of this type.
    """

    msgtype: str
    kind: BumpKind
    expression: str
    sensor_field: str = ""
    hold_s: float | None = None
    opt_in: bool = False
    ignore_fields: tuple[str, ...] = ()
    needs_name: bool = False
    all_topics: bool = False


class BumpChoice(NamedTuple):
    """What ``--bump-topic`` says; None and "" leave it to the message type."""

    topic: str
    expression: str | None = None
    kind: BumpKind | None = None
    sensor_field: str = ""
    hold_s: float | None = None


def _load_rules() -> dict[str, BumperRule]:
    """Read the rules that come with the package."""
    text = files("mpap_cli.logs").joinpath("definitions/bumpers.toml").read_text("utf-8")
    rules = {}
    for msgtype, entry in tomllib.loads(text).items():
        ignored = tuple(entry.pop("ignore_fields", ()))
        rules[msgtype] = BumperRule(msgtype=msgtype, ignore_fields=ignored, **entry)
    return rules


BUMPER_RULES: Mapping[str, BumperRule] = MappingProxyType(_load_rules())


def parse_bump_topic(text: str) -> BumpChoice:
    """Split ``TOPIC[:EXPR][:level|edge=FIELD|pulse=S]``.

    Parameters
    ----------
    text : str
        A word after ``--bump-topic``. ``pulse`` alone takes the setting bump-hold.

    Returns
    -------
    BumpChoice
        Its parts; the expression is checked.

    Raises
    ------
    SettingError
        If a part makes no sense.

    Examples
    --------
    >>> parse_bump_topic("/state:bumper & 7")
    BumpChoice(topic='/state', expression='bumper & 7', kind=None, sensor_field='', hold_s=None)
    >>> parse_bump_topic("/events:state==1:edge=bumper").sensor_field
    'bumper'
    """
    topic, *parts = text.split(":")
    choice = BumpChoice(topic.strip())
    if parts and (kind := _parse_kind(parts[-1].strip())):
        choice = choice._replace(kind=kind.kind, sensor_field=kind.sensor_field, hold_s=kind.hold_s)
        parts.pop()
    if not choice.topic or len(parts) > 1:
        msg = f"--bump-topic {text}: expected TOPIC[:EXPR][:level|edge=FIELD|pulse=S]"
        raise SettingError(msg)
    if parts:
        parse_expression(parts[0])
        choice = choice._replace(expression=parts[0].strip())
    return choice


def _parse_kind(text: str) -> BumpChoice | None:
    """Read ``level``, ``edge=FIELD``, ``pulse`` or ``pulse=S``; None: it is an expression."""
    word, given, value = (part.strip() for part in text.partition("="))
    if word == "level" and not given:
        return BumpChoice("", kind="level")
    if word == "pulse" and not given:
        return BumpChoice("", kind="pulse")
    if word == "pulse" and re.fullmatch(r"\d*\.?\d+|\d+\.", value) and float(value) > 0:
        return BumpChoice("", kind="pulse", hold_s=float(value))
    if word == "edge" and re.fullmatch(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", value):
        return BumpChoice("", kind="edge", sensor_field=value)
    if word in {"edge", "pulse"} and not value.startswith("="):
        msg = f"--bump-topic ...:{text}: expected edge=FIELD or pulse=SECONDS"
        raise SettingError(msg)
    return None


def apply_choice(rule: BumperRule | None, msgtype: str, choice: BumpChoice) -> BumperRule | None:
    """Put what was asked for over the rule of a type; None if nothing says what is pressed."""
    if choice.expression is not None:
        rule = BumperRule(msgtype, "level", choice.expression)
    if rule is None or choice.kind is None:
        return rule
    return replace(rule, kind=choice.kind, sensor_field=choice.sensor_field, hold_s=choice.hold_s)
