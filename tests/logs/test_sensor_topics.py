"""Topics of images and odometry, and those that look useful but are not read."""

import re
from collections.abc import Callable
from typing import Any

import pytest

from mpap_cli.errors import UsageError
from mpap_cli.logs.protobuf import schema_text
from mpap_cli.logs.raw import LogReader, Topic
from mpap_cli.logs.sensor_topics import (
    Choice,
    choose_image,
    choose_odometry,
    choose_scan,
    find_unreadable,
)
from mpap_cli.logs.topics import choose_roles, require_image
from tests import protobufs

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
VIDEO, PACKET = "foxglove.CompressedVideo", "ffmpeg_image_transport_msgs/msg/FFMPEGPacket"
ODOMETRY = "nav_msgs/msg/Odometry"


def topic(name: str, msgtype: str = ODOMETRY, n_messages: int = 3, encoding: str = "cdr") -> Topic:
    """Return a topic."""
    if encoding == "protobuf":
        return protobufs.topic(name, msgtype, n_messages)
    return Topic(name, msgtype, encoding, n_messages, "", "")


def one_of_each(**types: str) -> list[Event]:
    """Return one empty message a topic: the name's underscores are slashes."""
    return [("/" + name.replace("__", "/"), msgtype, 1, {}) for name, msgtype in types.items()]


@pytest.mark.parametrize(
    ("topics", "expected", "reason"),
    [
        ([topic("/wheels")], "/wheels", "the only Odometry topic"),
        (
            [topic("/a", n_messages=9), topic("/odom")],
            "/odom",
            "named /odom, of 2 Odometry topics",
        ),
        (
            [topic("/a"), topic("/b", n_messages=9), topic("/c", n_messages=9)],
            "/b",
            "the one with most messages, of 3 Odometry topics",
        ),
        ([topic("/odom", n_messages=0), topic("/b")], "/b", "the only Odometry topic"),
        ([topic("/odom", encoding="json")], None, "no topic carries Odometry"),
        ([topic("/odom", msgtype="geometry_msgs/msg/Pose")], None, "no topic carries Odometry"),
    ],
)
def test_odometry_is_never_an_error(topics: list[Topic], expected: str | None, reason: str) -> None:
    """The only one, the one named /odom, the one with most messages, or none."""
    found, why = choose_odometry(tuple(topics))

    assert (found.name if found is not None else None, why) == (expected, reason)


def test_odometry_is_a_role(make_log: MakeLog) -> None:
    """It comes with its reason."""
    roles = choose_roles(make_log(one_of_each(odom=ODOMETRY)))

    assert roles.odometry is not None
    assert (roles.odometry.name, roles.odometry_reason) == ("/odom", "the only Odometry topic")


def test_image_that_is_needed_and_there(make_log: MakeLog) -> None:
    """The only camera."""
    roles = choose_roles(make_log(one_of_each(camera=IMAGE)))

    assert require_image(roles, "day1.bag") is roles.image


@pytest.mark.parametrize(
    ("topics", "text"),
    [
        (
            {"left": IMAGE, "right": COMPRESSED},
            "a.bag: 2 topics carry images: /left, /right; choose one with --image-topic /left",
        ),
        (
            {"bump": "std_msgs/msg/Bool"},
            (
                "a.bag: no image topic (CompressedImage, Image); "
                "the log holds /bump (std_msgs/msg/Bool)"
            ),
        ),
        (
            {"depth": IMAGE},
            "a.bag: no scan, image or bump topic; the log holds /depth (sensor_msgs/msg/Image)",
        ),
    ],
)
def test_image_that_is_needed_and_missing(
    make_log: MakeLog, topics: dict[str, str], text: str
) -> None:
    """The error lists the cameras ready to paste, or what there is."""
    roles = choose_roles(make_log(one_of_each(**topics)))

    with pytest.raises(UsageError, match=f"^{re.escape(text)}$"):
        require_image(roles, "a.bag")


@pytest.mark.parametrize(
    ("msgtype", "encoding", "reason"),
    [
        (VIDEO, "flatbuffer", "encoding flatbuffer cannot be read"),
        (PACKET, "ros1", "encoding ros1 cannot be read"),
        ("other_msgs/msg/FFMPEGPacket", "cdr", "video of a kind that is not read"),
        (VIDEO, "protobuf", ""),
        (PACKET, "cdr", ""),
        ("foxglove.RawImage", "protobuf", ""),
        ("foxglove.RawImage", "cbor", "encoding cbor cannot be read"),
        ("foxglove.LaserScan", "protobuf", ""),
        (COMPRESSED, "", "encoding unknown cannot be read"),
        (IMAGE, "json", "encoding json cannot be read"),
        ("foxglove.LaserScan", "flatbuffer", "encoding flatbuffer cannot be read"),
        (IMAGE, "cdr", ""),
        ("foxglove.LaserScan", "json", ""),
        ("std_msgs/msg/String", "", ""),
    ],
)
def test_what_is_not_read_is_named(msgtype: str, encoding: str, reason: str) -> None:
    """Scans, images and video in a form that is not read, with the reason."""
    there = (topic("/a", msgtype, encoding=encoding),)

    notes = find_unreadable(there)

    assert notes == ((f"/a ({msgtype}) is not used: {reason}",) if reason else ())
    if reason:
        assert choose_image(there, None, "a.bag")[0] is None


STILL = topic("/left/image_raw/compressed", COMPRESSED)
FFMPEG = topic("/left/image_raw/ffmpeg", PACKET)
RIGHT = topic("/right", VIDEO, encoding="protobuf")
DEPTH = topic("/depth/image/ffmpeg", PACKET)


@pytest.fixture
def without_video(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let PyAV be missing."""
    monkeypatch.setattr("mpap_cli.logs.sensor_topics.find_spec", lambda _: None)


@pytest.mark.parametrize(
    ("topics", "expected", "reason"),
    [
        ((FFMPEG,), FFMPEG, "the only camera"),
        ((FFMPEG, DEPTH), FFMPEG, "the only camera"),
        ((FFMPEG, STILL), STILL, "the only camera"),
        ((RIGHT, STILL), STILL, "the only camera without video"),
        (
            (RIGHT, FFMPEG),
            None,
            (
                "2 topics carry images: /right, /left/image_raw/ffmpeg; "
                "choose one with --image-topic /right"
            ),
        ),
        ((DEPTH,), None, "no topic carries images of a camera"),
    ],
)
def test_video_is_taken_where_there_is_nothing_else(
    topics: tuple[Topic, ...], expected: Topic | None, reason: str
) -> None:
    """So that the choice is the same with the extra and without it."""
    assert choose_image(topics, None, "a.mcap")[:2] == (expected, reason)


@pytest.mark.usefixtures("without_video")
def test_stills_are_taken_without_the_extra() -> None:
    """What there is beside them does not matter."""
    found = choose_image((RIGHT, STILL), None, "a.mcap")

    assert found == (STILL, "the only camera without video", (STILL.name,))


@pytest.mark.usefixtures("without_video")
def test_video_without_the_extra_says_what_to_install() -> None:
    """If it is needed it is an error, and one if it is asked for."""
    needed, why, names = choose_image((RIGHT, FFMPEG), None, "a.mcap")

    assert needed is None
    assert why == '/right carries video; pip install "mpap[video]" to read it'
    assert names == ("/right", FFMPEG.name)
    text = 'a.mcap: --image-topic /right: this is video; pip install "mpap[video]" to read it'
    with pytest.raises(UsageError, match=f"^{re.escape(text)}$"):
        choose_image((RIGHT, STILL), "/right", "a.mcap")


def test_video_that_is_asked_for_is_taken() -> None:
    """Before stills, and of whichever camera."""
    assert choose_image((RIGHT, STILL), "/right", "a.mcap")[:2] == (RIGHT, "asked for")


@pytest.fixture
def without_protobuf(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the extra be missing."""
    monkeypatch.setattr("mpap_cli.logs.protobuf.find_spec", lambda _: None)


@pytest.mark.usefixtures("without_protobuf")
@pytest.mark.parametrize(
    ("msgtype", "choose"),
    [
        ("foxglove.LaserScan", choose_scan),
        ("foxglove.RawImage", choose_image),
        (VIDEO, choose_image),
    ],
)
def test_protobuf_without_its_extra_is_named(
    msgtype: str, choose: Callable[[tuple[Topic, ...], str | None, str], Choice]
) -> None:
    """The note and the error have the line to paste."""
    there = (topic("/a", msgtype, encoding="protobuf"),)
    reason = 'it is protobuf; pip install "mpap[protobuf]" to read it'

    assert find_unreadable(there) == (f"/a ({msgtype}) is not used: {reason}",)
    assert choose(there, None, "a.mcap")[0] is None
    with pytest.raises(UsageError, match=re.escape(f"/a: {msgtype} is not read: {reason}")):
        choose(there, "/a", "a.mcap")


@pytest.mark.parametrize("definition", ["", schema_text(b"\xff"), schema_text(b"")])
def test_protobuf_without_a_schema_is_named(definition: str) -> None:
    """Numbers of fields alone say nothing."""
    bare = Topic("/a", VIDEO, "protobuf", 3, definition, "protobuf")

    (note,) = find_unreadable((bare,))

    assert note.endswith("is not used: its protobuf schema is missing or cannot be used")
    assert choose_image((bare,), None, "a.mcap")[0] is None
