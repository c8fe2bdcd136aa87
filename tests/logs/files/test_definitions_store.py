"""Types are looked up in the log, the user's folders, mpap's own and the distribution's."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mpap_cli.errors import LogError
from mpap_cli.logs.files.definitions_store import DefinitionsStore
from mpap_cli.logs.raw import PayloadError, RawMessage, Topic

PAIR = "pkg/msg/Pair"
SWITCHES = "bool leftFront\nfloat32 x\n"


def message(
    payload: bytes,
    msgtype: str = PAIR,
    definition: str = "",
    encoding: str = "cdr",
    form: str = "ros2msg",
) -> RawMessage:
    """Return a message of a topic with that definition."""
    topic = Topic("/bump", msgtype, encoding, 1, definition, form if definition else "")
    return RawMessage(topic, 5, payload)


def fields_of(decoded: object) -> dict[str, Any]:
    """Return the fields of a decoded message."""
    return {name: value for name, value in vars(decoded).items() if name != "__msgtype__"}


def cdr(definition: str, fields: Mapping[str, Any]) -> bytes:
    """Return fields as CDR, by a definition of pkg/msg/Pair."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(definition, PAIR))
    return bytes(store.serialize_cdr(store.types[PAIR](**fields), PAIR))


def test_definition_in_the_log_goes_first(tmp_path: Path) -> None:
    """Also before a folder of the user."""
    (tmp_path / "pkg__msg__Pair.msg").write_text("float64 other\n")
    payload = cdr(SWITCHES, {"leftFront": True, "x": 2.5})

    decoded = DefinitionsStore("a.mcap", [tmp_path]).decode(message(payload, PAIR, SWITCHES))

    assert fields_of(decoded) == {"leftFront": True, "x": 2.5}


@pytest.mark.parametrize("place", ["pkg__msg__Pair.msg", "ws/pkg/msg/Pair.msg", "ws/pkg/Pair.msg"])
def test_definition_in_a_folder(tmp_path: Path, place: str) -> None:
    """Folders of ROS packages and flat folders are both understood."""
    path = tmp_path / place
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(SWITCHES)
    (tmp_path / "Unused.msg").write_text("!!")
    payload = cdr(SWITCHES, {"leftFront": True, "x": 2.5})

    decoded = DefinitionsStore("a.mcap", [tmp_path]).decode(message(payload))

    assert fields_of(decoded)["leftFront"] is True


def test_definition_in_an_idl_file(tmp_path: Path) -> None:
    """ROS 2 makes these of .msg files."""
    (tmp_path / "Pair.idl").write_text(
        "module pkg { module msg { struct Pair { boolean leftFront; float x; }; }; };"
    )
    payload = cdr(SWITCHES, {"leftFront": True, "x": 2.5})

    decoded = DefinitionsStore("a.mcap", [tmp_path]).decode(message(payload))

    assert fields_of(decoded)["x"] == 2.5


def test_definition_of_a_log_as_idl() -> None:
    """Sections of several files, as rosbag2 stores them."""
    line = "=" * 80
    text = (
        f"{line}\nIDL: pkg/msg/Pair\n"
        "module pkg { module msg { struct Pair { pkg::msg::Inner inner; }; }; };\n"
        f"{line}\nIDL: pkg/msg/Inner\n"
        "module pkg { module msg { struct Inner { uint8 x; }; }; };\n"
    )

    decoded = DefinitionsStore("a.mcap").decode(
        message(b"\x00\x01\x00\x00\x07", PAIR, text, form="ros2idl")
    )

    assert fields_of(fields_of(decoded)["inner"])["x"] == 7


def test_definition_that_comes_with_mpap() -> None:
    """The Neato's switches, which its logs do not define."""
    payload = b"\x00\x01\x00\x00\x00\x01\x00\x00"

    decoded = DefinitionsStore("a.db3").decode(message(payload, "neato2_interfaces/msg/Bump"))

    assert [field for field, value in fields_of(decoded).items() if value] == ["left_side"]


def test_folder_goes_before_what_comes_with_mpap(tmp_path: Path) -> None:
    """A user who names a definition means it."""
    path = tmp_path / "neato2_interfaces" / "msg" / "Bump.msg"
    path.parent.mkdir(parents=True)
    path.write_text("uint8 a\nuint8 b\nuint8 c\nuint8 d\n")
    payload = b"\x00\x01\x00\x00\x00\x01\x00\x00"

    decoded = DefinitionsStore("a.db3", [tmp_path]).decode(
        message(payload, "neato2_interfaces/msg/Bump")
    )

    assert fields_of(decoded) == {"a": 0, "b": 1, "c": 0, "d": 0}


@pytest.mark.parametrize("distro", ["", "humble", "jazzy", "rolling", "rosbags"])
def test_standard_types_need_no_definition(distro: str) -> None:
    """Those of the distribution, or of humble where it is unknown."""
    decoded = DefinitionsStore("a.db3", (), distro).decode(
        message(b"\x00\x01\x00\x00\x01", "std_msgs/msg/Bool")
    )

    assert fields_of(decoded)["data"] is True


def test_ros1_headers_have_a_sequence_number() -> None:
    """ROS 1 and ROS 2 differ in std_msgs/Header."""
    store = DefinitionsStore("a.bag")
    payload = b"\x07\0\0\0" + b"\x01\0\0\0" + b"\x02\0\0\0" + b"\0\0\0\0"

    decoded = store.decode(message(payload, "std_msgs/msg/Header", encoding="ros1"))

    assert fields_of(decoded)["seq"] == 7


def test_nested_types_come_from_different_places(tmp_path: Path) -> None:
    """One from the log, its field from a folder, the field's field from the distribution."""
    (tmp_path / "pkg__msg__Inner.msg").write_text("std_msgs/Bool[] flags\n")

    decoded = DefinitionsStore("a.db3", [tmp_path]).decode(
        message(b"\x00\x01\x00\x00\x01\0\0\0\x01", PAIR, "Inner inner\n")
    )

    assert fields_of(fields_of(fields_of(decoded)["inner"])["flags"][0])["data"] is True


def test_json_becomes_a_dict() -> None:
    """Its schema is not needed."""
    decoded = DefinitionsStore("a.mcap").decode(
        message(b'{"pressed": true}', "Bumper", encoding="json")
    )

    assert decoded == {"pressed": True}


def test_type_without_definition() -> None:
    """The error names log, type, topic and what to do."""
    text = "a.db3: type pkg/msg/Pair of topic /bump has no definition.*--msgs DIR"

    with pytest.raises(LogError, match=text):
        DefinitionsStore("a.db3").decode(message(b""))


def test_field_without_definition() -> None:
    """The type that is missing is named."""
    with pytest.raises(LogError, match="needs pkg/msg/Inner, which has no definition"):
        DefinitionsStore("a.db3").decode(message(b"", PAIR, "Inner inner\n"))


@pytest.mark.parametrize(
    "definition",
    [
        "Definition of pkg/Pair",
        "bool 3x",
        "struct {",
    ],
)
def test_definition_that_cannot_be_understood(tmp_path: Path, definition: str) -> None:
    """The next place is asked, here a folder."""
    (tmp_path / "pkg__msg__Pair.msg").write_text(SWITCHES)
    payload = cdr(SWITCHES, {"leftFront": True, "x": 2.5})

    decoded = DefinitionsStore("a.bag", [tmp_path]).decode(message(payload, PAIR, definition))

    assert fields_of(decoded)["leftFront"] is True


def test_constants_that_break_the_rules_are_passed_over() -> None:
    """Some drivers write them in lower case; payloads hold none."""
    definition = "uint8 right=0\nuint8 left=1\nuint8 bumper\n"

    decoded = DefinitionsStore("a.bag").decode(
        message(b"\x01", PAIR, definition, "ros1", "ros1msg")
    )

    assert fields_of(decoded) == {"bumper": 1}


def test_file_of_the_user_that_cannot_be_understood(tmp_path: Path) -> None:
    """It was given for this type, so it is an error."""
    path = tmp_path / "pkg__msg__Pair.msg"
    path.write_text("!!")

    with pytest.raises(LogError, match=r"pkg__msg__Pair\.msg: cannot be understood"):
        DefinitionsStore("a.db3", [tmp_path]).decode(message(b""))


def test_definition_that_names_a_field_twice() -> None:
    """It can be parsed and yet not be used."""
    with pytest.raises(LogError, match="the definition of pkg/msg/Pair cannot be used"):
        DefinitionsStore("a.bag").decode(message(b"", PAIR, "bool x\nbool x\n"))


@pytest.mark.parametrize(
    ("payload", "encoding"),
    [
        (b"", "cdr"),
        (b"\x00\x01\x00\x00", "cdr"),
        (b"\x00\x01\x00\x00" + bytes(50), "cdr"),
        (b"\xff\x01\x00\x00\x01\x00", "cdr"),
        (b"\x01", "ros1"),
        (b"{", "json"),
        (b"\xff", "json"),
    ],
)
def test_payload_that_does_not_fit(payload: bytes, encoding: str) -> None:
    """An error of this message alone; it names topic, size and type."""
    store = DefinitionsStore("a.mcap")

    with pytest.raises(PayloadError, match=r"a message of /bump \(\d+ bytes\) does not fit"):
        store.decode(message(payload, PAIR, SWITCHES, encoding))


def test_types_that_are_nowhere_defined_are_named(tmp_path: Path) -> None:
    """Those of messages; a file of the user, mpap or the distribution is a definition."""
    for path in ("a_msgs/msg/Given.msg", "a_msgs/msg/Told.idl"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("", encoding="utf-8")
    topics = [
        Topic("/a", "a_msgs/msg/Given", "cdr", 1, "", ""),
        Topic("/b", "a_msgs/msg/Told", "cdr", 1, "", ""),
        Topic("/c", "a_msgs/msg/Lost", "cdr", 1, "", ""),
        Topic("/d", "a_msgs/msg/Lost", "ros1", 1, "", ""),
        Topic("/e", "a_msgs/msg/Empty", "cdr", 0, "", ""),
        Topic("/f", "a_msgs/msg/Own", "cdr", 1, "bool on", "ros2msg"),
        Topic("/g", "a_msgs.Other", "json", 1, "", ""),
        Topic("/h", "std_msgs/msg/Bool", "cdr", 1, "", ""),
        Topic("/i", "neato2_interfaces/msg/Bump", "cdr", 1, "", ""),
        Topic("/j", "another_msgs/msg/Lost", "cdr", 1, "", ""),
    ]

    found = DefinitionsStore("a.db3", [tmp_path]).undefined_types(topics)

    assert found == ("a_msgs/msg/Lost", "another_msgs/msg/Lost")
