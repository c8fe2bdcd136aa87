"""The page of all message types that are read, from the tables in the code."""

from collections.abc import Iterator

from mpap_cli.logs.bumps.bump_topics import BUMPER_NAME
from mpap_cli.logs.bumps.bumper_rules import BUMPER_RULES, BumperRule
from mpap_cli.logs.fields import LOCATED
from mpap_cli.logs.foxglove import FOXGLOVE_ENCODINGS
from mpap_cli.logs.frames import FRAME_READERS
from mpap_cli.logs.odometry import ODOMETRY_TYPE
from mpap_cli.logs.sensor_topics import SCAN_TYPES
from mpap_cli.logs.tf import TF_TYPES
from mpap_cli.logs.video.packets import VIDEO_TYPES

HEAD = """# Message types

This page is written from the tables in the code by `make docs`. Types stand in ROS 2 form:
`kobuki_msgs/BumperEvent` of a ROS 1 bag is `kobuki_msgs/msg/BumperEvent` here. Definitions that a
log lacks and mpap does not know are read with `--msgs DIR`.

"""
BUMPERS = """
## Bumpers

`level`: every message carries the whole state. `edge`: one message for each change of one sensor,
which the field behind it names. `pulse`: messages come only while touching. The rule is the test on
one message; [bumpers.md](bumpers.md) has the language. Names that speak of bumps hold {names}. On
topics with such a name a type that is not listed is taken if it has a boolean field `pressed` or
`data`, in protobuf also if it has one boolean in all.

| type | kind | rule | taken unasked |
| --- | --- | --- | --- |
"""


def message_lines() -> Iterator[str]:
    """Yield the page."""
    yield HEAD
    yield "## Scans, images, odometry, transforms\n\n"
    yield "| role | type | encodings |\n| --- | --- | --- |\n"
    for name in SCAN_TYPES:
        forms = FOXGLOVE_ENCODINGS if name.startswith("foxglove.") else LOCATED
        yield f"| scan | `{name}` | {', '.join(sorted(forms))} |\n"
    for name in dict.fromkeys(name for name, _ in FRAME_READERS):
        read = ", ".join(sorted(form for known, form in FRAME_READERS if known == name))
        yield f"| {'image (video)' if name in VIDEO_TYPES else 'image'} | `{name}` | {read} |\n"
    yield f"| odometry | `{ODOMETRY_TYPE}` | cdr, ros1 |\n"
    for name in TF_TYPES:
        yield f"| tf | `{name}` | cdr, ros1 |\n"
    yield "\nVideo needs the extra `mpap[video]`, protobuf the extra `mpap[protobuf]`.\n"
    words = ", ".join(f"*{word}*" for word in BUMPER_NAME.pattern.split("|"))
    yield BUMPERS.format(names=words)
    for name, rule in sorted(BUMPER_RULES.items()):
        yield f"| `{name}` | {_kind(rule)} | {_rule(rule)} | {_unasked(rule)} |\n"


def _kind(rule: BumperRule) -> str:
    """Return the kind, with the field that names the sensor."""
    return f"edge, `{rule.sensor_field}`" if rule.kind == "edge" else rule.kind


def _rule(rule: BumperRule) -> str:
    """Return the test on a message."""
    expression = rule.expression.replace("|", "\\|")
    text = f"`{expression}`" if expression else "every message"
    if rule.ignore_fields:
        names = " or ".join(f"`{name}`" for name in rule.ignore_fields)
        text += f", unless {names} names the ground"
    return text


def _unasked(rule: BumperRule) -> str:
    """Say whether a topic of the type is taken by itself."""
    if rule.opt_in:
        return "no: a protective stop, no touch"
    if rule.needs_name:
        return "if its name speaks of bumps"
    return "yes, every topic" if rule.all_topics else "yes"
