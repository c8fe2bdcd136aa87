"""Recorded logs: topics, counts and directions as an independent count found them."""

import logging
import math
from pathlib import Path

import numpy as np
import pytest

from mpap_cli.errors import UsageError
from mpap_cli.logs.fields import TimeSource
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.survey import survey_log
from mpap_cli.logs.topics import TopicChoice, choose_roles, require_scan
from mpap_cli.observations import Bump, ScanBlock
from mpap_cli.params import BumperParams

pytestmark = pytest.mark.shared

NEATO1, NEATO2, INT8S = (
    "neato_node/msg/Bump",
    "neato2_interfaces/msg/Bump",
    "std_msgs/msg/Int8MultiArray",
)

# log: scans, bump messages, pressed ones, scans while pressed, type of the bump topic
NEATO_LOGS = {
    "real/neato-2018-a1.bag": (157, 45, NEATO1),
    "real/neato-2018-a2.bag": (139, 11, NEATO1),
    "real/neato-2018-a3.bag": (145, 2, NEATO1),
    "real/neato-2018-a4.bag": (26, 26, NEATO1),
    "real/neato-2018-b1.bag": (158, 41, NEATO1),
    "real/neato-2018-c1.bag": (147, 39, NEATO1),
    "real/neato-2023-d1": (220, 11, NEATO2),
    "real/neato-2023-d2": (300, 1, NEATO2),
    "real/neato-2024-e1": (280, 3, NEATO2),
    "real/neato-2024-e2": (243, 7, NEATO2),
    "real/neato-2024-e3": (185, 0, NEATO2),
    "real/neato-2024-e4": (153, 0, NEATO2),
    "real/neato-2024-e5": (181, 0, NEATO2),
    "gazebo/gazebo-f1": (187, 12, NEATO2),
    "gazebo/gazebo-f2": (162, 0, NEATO2),
    "gazebo/gazebo-f3": (163, 0, NEATO2),
    "gazebo/gazebo-g1.bag": (146, 23, INT8S),
    "gazebo/gazebo-g2.bag": (368, 2, INT8S),
    "gazebo/gazebo-h1": (128, 20, NEATO2),
    "camera/neato-2017-i1.bag": (161, 0, NEATO1),
    "camera/neato-2017-i2.bag": (117, 0, NEATO1),
    "converted/neato-2024-e1-mcap": (280, 3, NEATO2),
    "converted/neato-2024-e1.mcap": (280, 3, NEATO2),
    "converted/neato-2017-i1-camera.mcap": (161, 0, NEATO1),
    "converted/neato-2018-a1-ros1profile.mcap": (157, 45, NEATO1),
    "traps/folder-named.bag": (113, 0, NEATO2),
    "traps/made-stale-metadata": (153, 0, NEATO2),
    "traps/made-no-metadata": (153, 0, NEATO2),
    "traps/broken-scans-37-beams": (83, 0, NEATO2),
    "damaged/cut70.bag": (102, 0, NEATO1),
    "damaged/unindexed.bag": (145, 2, NEATO1),
    "damaged/killed.bag.active": (144, 1, NEATO1),
    "damaged/flipped-byte-crc.mcap": (271, 3, NEATO2),
    "damaged/flipped-byte-zstd.mcap": (271, 3, NEATO2),
    "damaged/cut70-db3": (126, 0, NEATO2),
    "damaged/cut70.mcap": (206, 0, NEATO2),
    "damaged/cut70.db3": (126, 0, NEATO2),
}
NOTHING_TO_USE = ("cmd-vel-only.bag", "example.bag", "mcap-no-scan", "split-5-files-mcap")


def count_pressed(blocks: list[ScanBlock], bumps: list[Bump]) -> int:
    """Count the scans whose last bump at or before them is pressed."""
    stamps_ns = np.concatenate([block.stamps_ns for block in blocks])
    last = np.searchsorted([bump.stamp_ns for bump in bumps], stamps_ns, side="right")
    states = np.array([False, *(bump.pressed for bump in bumps)])
    return int(np.count_nonzero(states[last]))


@pytest.mark.parametrize("name", NEATO_LOGS)
def test_neato_log_gives_its_scans_bumps_and_direction(shared_logs: Path, name: str) -> None:
    """Scans of 361 beams, all bump messages, straight ahead at half a turn, by tf."""
    n_scans, n_pressed, msgtype = NEATO_LOGS[name]

    with open_log(shared_logs / name) as reader:
        roles = choose_roles(reader)
        survey = survey_log(reader, roles)
        replay = Replay(reader, roles, BumperParams())
        batches = list(replay)

    blocks = [block for batch in batches for block in batch.scans]
    bumps = [bump for batch in batches for bump in batch.bumps]
    assert roles.scan is not None
    (bump,) = (role.topic for role in roles.bumps)
    assert (roles.scan.name, bump.name, bump.msgtype) == ("/scan", "/bump", msgtype)
    assert survey.forward_source == "tf"
    assert abs(math.remainder(survey.forward_rad - math.pi, math.tau)) < 0.01
    assert {block.ranges.shape[1] for block in blocks} == {361}
    assert sum(len(block.stamps_ns) for block in blocks) == n_scans
    assert count_pressed(blocks, bumps) == n_pressed


@pytest.mark.parametrize("name", ["gazebo/gazebo-g1.bag", "gazebo/gazebo-g2.bag"])
def test_switches_are_taken_before_contacts(shared_logs: Path, name: str) -> None:
    """Of /bump and /bumper, which tell the same, /bump is taken, and the reason says so."""
    with open_log(shared_logs / name) as reader:
        roles = choose_roles(reader)

    assert roles.bump_candidates == ("/bump", "/bumper")
    assert "switches go before a simulator's contacts, of /bump, /bumper" in roles.bump_reason


@pytest.mark.parametrize("time_source", ["log", "header"])
@pytest.mark.parametrize(
    ("name", "n_images", "n_poses"),
    [
        ("camera/neato-2017-i1.bag", 123, 466),
        ("camera/neato-2017-i2.bag", 97, 374),
        ("converted/neato-2017-i1-camera.mcap", 123, 466),
    ],
)
def test_camera_log_gives_its_images_and_poses(
    shared_logs: Path, name: str, n_images: int, n_poses: int, time_source: TimeSource
) -> None:
    """JPEG images of the compressed topic, not theora; odometry beside them."""
    options = ReplayOptions(sensors=frozenset({"image", "odometry"}), time_source=time_source)

    with open_log(shared_logs / name) as reader:
        roles = choose_roles(reader, TopicChoice(bump_from="none"))
        replay = Replay(reader, roles, BumperParams(), options)
        (batch,) = replay

    assert roles.image is not None
    assert roles.image.name == "/camera/image_raw/compressed"
    assert all(frame.payload.startswith(b"\xff\xd8\xff") for frame in batch.frames)
    assert batch.poses is not None
    assert (len(batch.frames), len(batch.poses.poses)) == (n_images, n_poses)
    assert (batch.scans, replay.skipped) == ((), {})


def test_json_log_is_read(shared_logs: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Scans by schema, bumps by the field ``pressed``; direction and range_max are not there."""
    caplog.set_level(logging.INFO)

    with open_log(shared_logs / "converted/neato-2018-a2-json.mcap") as reader:
        roles = choose_roles(reader)
        survey = survey_log(reader, roles)
        replay = Replay(reader, roles, BumperParams())
        batches = list(replay)

    (role,) = roles.bumps
    assert (role.rule.kind, role.rule.expression) == ("level", "pressed")
    assert (survey.forward_rad, survey.forward_source) == (0.0, "assumed")
    assert survey.range_max == pytest.approx(4.8, abs=0.3)
    n_scans = sum(len(block.stamps_ns) for batch in batches for block in batch.scans)
    assert (n_scans, sum(len(batch.bumps) for batch in batches)) == (139, 5)
    assert [record.levelname for record in caplog.records] == ["INFO", "WARNING"]


def test_log_without_bumper_and_transforms(
    shared_logs: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """A TurtleBot3 with its scanner alone: scans come, the direction is assumed, once said."""
    caplog.set_level(logging.INFO)

    with open_log(shared_logs / "gazebo/turtlebot3-scan-only.bag") as reader:
        roles = choose_roles(reader)
        survey = survey_log(reader, roles)
        replay = Replay(reader, roles, BumperParams())
        blocks = [block for batch in replay for block in batch.scans]

    assert (roles.bumps, replay.bump_kind) == ((), None)
    assert "--bump-topic" in roles.bump_reason
    assert (survey.forward_rad, survey.forward_source) == (0.0, "assumed")
    assert [record.levelname for record in caplog.records] == ["INFO"]
    assert sum(len(block.stamps_ns) for block in blocks) == 538
    assert blocks[0].geometry.n_beams == 128


def test_broken_scan_is_counted(shared_logs: Path) -> None:
    """One scan of 37 beams among 83 of 361 is left out."""
    with open_log(shared_logs / "traps/broken-scans-37-beams") as reader:
        replay = Replay(reader, choose_roles(reader), BumperParams())
        list(replay)

    assert replay.skipped == {"a scan with fewer than half the usual beams": 1}


def test_beam_counts_that_vary_are_kept(shared_logs: Path) -> None:
    """926 to 937 beams: no scan is left out."""
    with open_log(shared_logs / "traps/beam-count-varies") as reader:
        replay = Replay(reader, choose_roles(reader), BumperParams())
        blocks = [block for batch in replay for block in batch.scans]

    counts = {block.geometry.n_beams for block in blocks}
    assert (min(counts), max(counts), len(counts)) == (926, 937, 12)
    assert (sum(len(block.stamps_ns) for block in blocks), replay.skipped) == (238, {})


def test_two_scan_topics_are_the_users_choice(shared_logs: Path) -> None:
    """Neither is taken, both are named."""
    with open_log(shared_logs / "traps/two-scan-topics.bag") as reader:
        roles = choose_roles(reader)

    assert roles.scan is None
    assert roles.scan_candidates == ("/front_scan", "/rear_scan")
    with pytest.raises(UsageError, match="choose one with --scan-topic /front_scan"):
        require_scan(roles, "two-scan-topics.bag")


@pytest.mark.parametrize("name", NOTHING_TO_USE)
def test_log_with_nothing_to_use(shared_logs: Path, name: str) -> None:
    """Colours of a turtle, texts and commands are no scan, image or bump."""
    with open_log(shared_logs / "traps" / name) as reader:
        roles = choose_roles(reader)

    assert (roles.scan, roles.image, roles.bumps) == (None, None, ())
    with pytest.raises(UsageError, match=r"no scan, image or bump topic; the log holds \S+ \("):
        require_scan(roles, name)
