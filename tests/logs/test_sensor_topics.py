"""Topics of images and odometry, and those that look useful but are not read."""

import re
from collections.abc import Callable
from typing import Any

import pytest

from mpap_cli.errors import UsageError
from mpap_cli.logs.raw import LogReader, Topic
from mpap_cli.logs.sensor_topics import choose_image, choose_odometry, find_unreadable
from mpap_cli.logs.topics import choose_roles, require_image

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
ODOMETRY = "nav_msgs/msg/Odometry"


def topic(name: str, msgtype: str = ODOMETRY, n_messages: int = 3, encoding: str = "cdr") -> Topic:
    """Return a topic."""
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
        ("foxglove.CompressedVideo", "protobuf", "video; not read"),
        ("foxglove.CompressedVideo", "json", "video; not read"),
        ("ffmpeg_image_transport_msgs/msg/FFMPEGPacket", "cdr", "video; not read"),
        ("foxglove.RawImage", "protobuf", "encoding protobuf cannot be read"),
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
