"""Which topic plays which role, and why."""

import re
from collections.abc import Callable
from typing import Any

import pytest

from mpap_cli.errors import UsageError
from mpap_cli.logs.listing import list_topics
from mpap_cli.logs.raw import LogReader, Topic
from mpap_cli.logs.topics import TopicChoice, choose_roles, require_scan

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

LASER_SCAN = "sensor_msgs/msg/LaserScan"
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
BOOL = "std_msgs/msg/Bool"


def one_of_each(**types: str) -> list[Event]:
    """Return one empty message a topic: the name's underscores are slashes."""
    return [("/" + name.replace("__", "/"), msgtype, 1, {}) for name, msgtype in types.items()]


def listed(name: str, msgtype: str, encoding: str = "cdr", n_messages: int = 3) -> Topic:
    """Return a topic that is listed but has no message to read."""
    return Topic(name, msgtype, encoding, n_messages, "", "")


def name_of(topic: Topic | None) -> str | None:
    """Return the name of a topic that may be missing."""
    return topic.name if topic is not None else None


def test_only_scan_topic_is_taken(make_log: MakeLog) -> None:
    """One LaserScan topic needs no choice."""
    roles = choose_roles(make_log(one_of_each(robot__laser=LASER_SCAN, imu="std_msgs/msg/String")))

    assert name_of(roles.scan) == "/robot/laser"
    assert roles.scan_reason == "the only LaserScan topic"
    assert require_scan(roles, "day1.bag") is roles.scan


def test_topic_named_scan_is_taken_of_several(make_log: MakeLog) -> None:
    """/stable_scan beside /scan does not make the choice ambiguous."""
    roles = choose_roles(make_log(one_of_each(stable_scan=LASER_SCAN, scan=LASER_SCAN)))

    assert name_of(roles.scan) == "/scan"
    assert roles.scan_reason == "named /scan, of 2 LaserScan topics"
    assert roles.scan_candidates == ("/scan", "/stable_scan")


def test_two_scan_topics_are_the_users_choice(make_log: MakeLog) -> None:
    """Neither is taken; the option stands ready to paste when a scan is needed."""
    roles = choose_roles(make_log(one_of_each(front_scan=LASER_SCAN, rear_scan=LASER_SCAN)))

    assert roles.scan is None
    assert roles.scan_candidates == ("/front_scan", "/rear_scan")
    text = (
        "day1.mcap: 2 topics carry LaserScan: /front_scan, /rear_scan; "
        "choose one with --scan-topic /front_scan"
    )
    with pytest.raises(UsageError, match=f"^{re.escape(text)}$"):
        require_scan(roles, "day1.mcap")


def test_log_with_nothing_to_use_lists_its_topics(make_log: MakeLog) -> None:
    """The error names every topic with its type."""
    roles = choose_roles(make_log(one_of_each(cmd_vel="geometry_msgs/msg/Twist")))

    with pytest.raises(
        UsageError,
        match=r"^a\.bag: no scan, image or bump topic; .* /cmd_vel \(geometry_msgs/msg/Twist\)$",
    ):
        require_scan(roles, "a.bag")


def test_log_with_bumps_only_lacks_a_scan(make_log: MakeLog) -> None:
    """Where there is a bumper the error speaks of the scan alone."""
    roles = choose_roles(make_log(one_of_each(bump="neato_node/msg/Bump")))

    with pytest.raises(UsageError, match=r"a\.bag: no scan topic \(LaserScan\); the log holds"):
        require_scan(roles, "a.bag")


def test_empty_or_undecodable_scan_topics_are_no_candidates(make_log: MakeLog) -> None:
    """A topic without message, or in an encoding that is not read, is not taken."""
    empty = [
        listed("/scan", LASER_SCAN, n_messages=0),
        listed("/lidar", "foxglove.LaserScan", "flatbuffer"),
    ]

    roles = choose_roles(make_log(one_of_each(cmd_vel="geometry_msgs/msg/Twist"), empty=empty))

    assert (roles.scan, roles.scan_candidates) == (None, ())
    assert roles.scan_reason == "no topic carries LaserScan"
    assert roles.notes == (
        "/lidar (foxglove.LaserScan) is not used: encoding flatbuffer cannot be read",
    )


def test_other_topics_that_cannot_be_read_are_counted(make_log: MakeLog) -> None:
    """By encoding; those without a message or with a note of their own are not."""
    empty = [
        *(listed(f"/{name}", "pkg.Type", "flatbuffer") for name in "ab"),
        listed("/c", "pkg.Type", "cbor", n_messages=0),
        listed("/bump", "pkg.Type", "cbor"),
        listed("/d", "pkg.Type", ""),
    ]

    roles = choose_roles(make_log(one_of_each(cmd_vel="geometry_msgs/msg/Twist"), empty=empty))

    assert roles.notes == (
        "/bump (pkg.Type) is not used: encoding cbor cannot be read",
        "2 other topics are not used: encoding flatbuffer cannot be read",
        "1 other topic is not used: encoding unknown cannot be read",
    )


def test_asked_for_topics_are_taken(make_log: MakeLog) -> None:
    """What was asked for goes before what would be found."""
    reader = make_log(
        one_of_each(scan=LASER_SCAN, rear=LASER_SCAN, camera__image_raw=IMAGE, depth=IMAGE)
    )

    roles = choose_roles(reader, TopicChoice(scan="/rear", image="/depth"))

    assert (name_of(roles.scan), name_of(roles.image)) == ("/rear", "/depth")
    assert (roles.scan_reason, roles.image_reason) == ("asked for", "asked for")


@pytest.mark.parametrize(
    ("choice", "text"),
    [
        (TopicChoice(scan="/laser"), r"log\.mcap: --scan-topic /laser: no such topic; .*/scan \("),
        (TopicChoice(scan="/odom"), r"--scan-topic /odom: 1 messages of nav_msgs.*there is /scan"),
        (TopicChoice(image="/scan"), r"--image-topic /scan: .*there is no topic that would do"),
        (
            TopicChoice(bumps=("/no_bump",)),
            r"log\.mcap: --bump-topic /no_bump: no such topic; .*/odom",
        ),
        (TopicChoice(bumps=("/odom",)), r"no bumper type that is known; .*--bump-topic /odom:EXPR"),
        (TopicChoice(bumps=("/odom:state",)), r"/odom \(nav_msgs/msg/Odometry\): .*no field state"),
        (TopicChoice(bumps=("/odom:pose.",)), "--bump-topic expression"),
    ],
)
def test_asked_for_topic_that_cannot_be_used(
    make_log: MakeLog, choice: TopicChoice, text: str
) -> None:
    """The error names the option, what was found and what there is."""
    reader = make_log(one_of_each(scan=LASER_SCAN, odom="nav_msgs/msg/Odometry"))

    with pytest.raises(UsageError, match=text):
        choose_roles(reader, choice)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["camera/image_raw", "camera/image_raw/compressed"], "/camera/image_raw/compressed"),
        (["camera/image_raw", "camera/image_raw/theora"], "/camera/image_raw"),
        (["camera/color/image_raw", "camera/depth/image_rect_raw"], "/camera/color/image_raw"),
        (["rgb", "camera/infra1/image_rect_raw", "aligned_depth_to_color/image_raw"], "/rgb"),
        (["rgb", "segmentation/mask", "rgb/compressedDepth"], "/rgb"),
        (["left/image_raw", "right/image_raw"], None),
        (["camera/image_raw/theora", "camera/parameter_updates"], None),
        ([], None),
    ],
)
def test_image_of_the_only_camera_is_taken(
    make_log: MakeLog, names: list[str], expected: str | None
) -> None:
    """Compressed goes before raw; what is no picture of the surroundings is left out."""
    types = {name: COMPRESSED if "compressed" in name else IMAGE for name in names}

    roles = choose_roles(make_log([(f"/{name}", kind, 1, {}) for name, kind in types.items()]))

    assert name_of(roles.image) == expected


def test_two_cameras_are_the_users_choice(make_log: MakeLog) -> None:
    """The option stands ready to paste."""
    roles = choose_roles(make_log(one_of_each(left=IMAGE, right=IMAGE)))

    assert roles.image_candidates == ("/left", "/right")
    assert roles.image_reason.endswith("/left, /right; choose one with --image-topic /left")


def test_long_lists_of_topics_are_cut() -> None:
    """Thirty topics are listed, the rest is counted."""
    topics = tuple(listed(f"/t{number}", BOOL) for number in range(33))

    assert list_topics(topics).endswith("/t29 (std_msgs/msg/Bool), and 3 more")
    assert list_topics(()) == "no topic"
