"""Texts that define message types, and where types come from without one."""

import re
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpap_cli.logs.raw import ros2_name

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc, Typesdict

_IDL_SEPARATOR = "=" * 80 + "\n"
_CONSTANT_LINE = re.compile(r"^[ \t]*[\w/]+[ \t]+\w+[ \t]*=.*$", re.MULTILINE)
BAD_DEFINITION = (SyntaxError, ValueError, LookupError, AssertionError, RecursionError)


@cache
def standard_types(encoding: str, ros_distro: str) -> "Typesdict":
    """Return the types of a distribution."""
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415

    store = Stores.ROS1_NOETIC
    if encoding != "ros1":
        store = Stores.__members__.get(f"ROS2_{ros_distro.upper()}", Stores.ROS2_HUMBLE)
    return get_typestore(store).fielddefs


def type_of(path: Path) -> str:
    """Return the type that a .msg file defines, by its name and folders.

    >>> type_of(Path("kobuki_msgs__msg__BumperEvent.msg"))
    'kobuki_msgs/msg/BumperEvent'
    >>> type_of(Path("ws/kobuki_msgs/msg/BumperEvent.msg"))
    'kobuki_msgs/msg/BumperEvent'
    """
    if "__" in path.stem:
        return ros2_name(path.stem.replace("__", "/"))
    package = path.parent.parent if path.parent.name == "msg" else path.parent
    return f"{package.name}/msg/{path.stem}"


def built_in(msgtype: str) -> "Typesdict":
    """Return the type as mpap's own definitions have it; empty if they do not."""
    place = files("mpap_cli.logs") / "definitions" / f"{msgtype.replace('/', '__')}.msg"
    if not place.is_file():
        return {}
    return parse(place.read_text(encoding="utf-8"), "ros2msg", msgtype) or {}


def parse(text: str, form: str, msgtype: str) -> "Typesdict | None":
    """Return the types that a text defines; None if it cannot be understood or is empty."""
    from rosbags.typesys import (  # noqa: PLC0415
        TypesysError,
        get_types_from_idl,
        get_types_from_msg,
    )

    try:
        if form == "ros2idl":
            parts = text.split(_IDL_SEPARATOR) if _IDL_SEPARATOR in text else [text]
            texts = [re.sub(r"\AIDL: [^\n]*\n", "", part) for part in parts if part.strip()]
            return {name: made for part in texts for name, made in get_types_from_idl(part).items()}
        if form and text.strip():
            return get_types_from_msg(text, msgtype)
    except (TypesysError, *BAD_DEFINITION):
        plain = _CONSTANT_LINE.sub("", text)
        # Some drivers name constants in ways the format forbids; payloads hold no constants.
        again = form != "ros2idl" and plain != text and plain.strip()
        return parse(plain, form, msgtype) if again else None
    return None


def type_names(desc: "FieldDesc") -> Iterator[str]:
    """Yield the names of the messages that a field is made of."""
    from rosbags.interfaces import Nodetype  # noqa: PLC0415

    if desc[0] == Nodetype.NAME:
        yield str(desc[1])
    elif desc[0] in {Nodetype.ARRAY, Nodetype.SEQUENCE}:
        inner: Any = desc[1][0]
        yield from type_names(inner)
