"""Images and odometry played back, with scans and without."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mpap_cli.errors import SettingError
from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.topics import choose_roles
from mpap_cli.logs.waiting import MAX_FRAME_BYTES
from mpap_cli.observations import NS_PER_S, Batch, Bump, Frame
from mpap_cli.params import BumperParams

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

LASER_SCAN, BOOL = "sensor_msgs/msg/LaserScan", "std_msgs/msg/Bool"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
ODOMETRY = "nav_msgs/msg/Odometry"
START_S = 1000
EVERYTHING = ("scan", "image", "odometry")


def ns(seconds: float) -> int:
    """Return the stamp of a moment of the log."""
    return round((START_S + seconds) * NS_PER_S)


def header(seconds: float) -> dict[str, Any]:
    """Return a header of another clock."""
    return {"stamp": {"sec": int(seconds), "nanosec": round(seconds % 1 * NS_PER_S)}}


def scan(seconds: float, header_s: float = 0) -> Event:
    """Return a scan of four beams."""
    fields = {"header": header(header_s), "angle_increment": 0.1, "ranges": [1.0] * 4}
    return "/scan", LASER_SCAN, ns(seconds), fields


def image(seconds: float, header_s: float = 0, n_bytes: int = 3) -> Event:
    """Return an image as a driver compresses it."""
    content = np.arange(n_bytes, dtype=np.uint8)
    fields = {"header": header(header_s), "format": "jpeg", "data": content}
    return "/camera/compressed", COMPRESSED, ns(seconds), fields


def pose(seconds: float, header_s: float = 0, x: float = 0.0) -> Event:
    """Return odometry at a place, turned to the left."""
    turned = {"z": 0.5**0.5, "w": 0.5**0.5}
    where = {"position": {"x": x, "y": -x}, "orientation": turned}
    return "/odom", ODOMETRY, ns(seconds), {"header": header(header_s), "pose": {"pose": where}}


def bump(seconds: float) -> Event:
    """Return a touch."""
    return "/bump", BOOL, ns(seconds), {"data": True}


def replay_of(reader: LogReader, *sensors: str, **options: Any) -> Replay:
    """Make the replay of some sensors of a log."""
    asked = ReplayOptions(sensors=frozenset(sensors), **options)
    return Replay(reader, choose_roles(reader), BumperParams(), asked)


def stamps_of(batches: list[Batch]) -> tuple[list[int], list[int], list[int]]:
    """Return the stamps of scans, images and poses."""
    return (
        [int(t) for batch in batches for block in batch.scans for t in block.stamps_ns],
        [frame.stamp_ns for batch in batches for frame in batch.frames],
        [int(t) for batch in batches if batch.poses is not None for t in batch.poses.stamps_ns],
    )


@pytest.mark.parametrize("ros_version", [1, 2])
def test_each_sensor_comes_in_time_order(make_log: MakeLog, ros_version: int) -> None:
    """Poses are x, y and heading; nothing of a later batch lies before an earlier one."""
    events = [one for i in range(9) for one in (pose(i, x=i), image(i + 0.5), scan(i))]
    reader = make_log([*events, bump(3)], ros_version=ros_version)

    batches = list(replay_of(reader, *EVERYTHING, block_scans=4))

    whole, half = [ns(i) for i in range(9)], [ns(i + 0.5) for i in range(9)]
    assert stamps_of(batches) == (whole, half, whole)
    assert len(batches) == 3
    expected = [[i, -i, np.pi / 2] for i in range(9)]
    found = [batch.poses.poses for batch in batches if batch.poses is not None]
    np.testing.assert_allclose(np.concatenate(found), expected)
    assert batches[0].frames[0] == Frame(ns(0.5), "compressed", 0, 0, 0, b"\0\1\2")


@pytest.mark.parametrize(
    ("sensors", "n_read"),
    [(("scan",), 7), (("image",), 6), (("odometry",), 5), (("image", "odometry"), 10), ((), 1)],
)
def test_only_what_is_asked_for_is_read(
    make_log: MakeLog, sensors: tuple[str, ...], n_read: int
) -> None:
    """And bumps always; without odometry there is no block of poses."""
    events = [*map(scan, range(3)), *map(image, range(5)), *map(pose, range(4)), bump(1)]
    reader: Any = make_log(events)
    replay = replay_of(reader, *sensors)
    reader.n_read = 0

    batches = list(replay)

    counts = {"scan": 3, "image": 5, "odometry": 4}
    expected = [counts[name] if name in sensors else 0 for name in EVERYTHING]
    assert [len(stamps) for stamps in stamps_of(batches)] == expected
    assert [one for batch in batches for one in batch.bumps] == [Bump(ns(1), "", pressed=True)]
    assert reader.n_read == n_read  # scans twice: the first ones tell the usual beams
    assert all((batch.poses is not None) == ("odometry" in sensors) for batch in batches)


def test_log_without_a_sensor_that_is_asked_for(make_log: MakeLog) -> None:
    """What there is comes; there is no block of poses."""
    (batch,) = replay_of(make_log([image(0), bump(1)]), *EVERYTHING)

    assert (len(batch.frames), batch.scans, batch.poses) == (1, (), None)


def test_unknown_sensor_is_refused() -> None:
    """The error names those there are."""
    with pytest.raises(
        SettingError, match=r"^sensors: found radar, expected some of scan, image, odometry$"
    ):
        ReplayOptions(sensors=frozenset({"scan", "radar"}))


def test_broken_images_and_poses_are_left_out_and_counted(make_log: MakeLog) -> None:
    """Each kind by its name."""
    cut: Event = ("/camera/compressed", COMPRESSED, ns(0.5), {"payload": b"\x00\x01\x00\x00"})
    strange: Event = ("/camera/compressed", COMPRESSED, ns(0.6), {"payload": b"\xff\xff\x00\x00"})
    short: Event = ("/odom", ODOMETRY, ns(0.5), {"payload": b"\x00\x01\x00\x00"})
    replay = replay_of(
        make_log([image(0), cut, strange, image(1), pose(0), short, pose(1, x=np.nan)]),
        *EVERYTHING,
    )

    batches = list(replay)

    assert stamps_of(batches) == ([], [ns(0), ns(1)], [ns(0)])
    assert replay.skipped == {
        "an image cut short": 1,
        "an image that is no plain CDR": 1,
        "a pose cut short": 1,
        "a pose that is not finite or has no direction": 1,
    }


def test_header_stamps_are_sorted_and_late_ones_left_out(make_log: MakeLog) -> None:
    """Images come late against scans; by more than 2 s they and poses are left out by name."""
    events = [one for i in range(8) for one in (scan(i, i + 7), image(i + 0.2, i + 6.5))]
    late = [image(7.5, header_s=11), pose(7.6, header_s=11), pose(7.7, header_s=14)]
    replay = replay_of(make_log([*events, *late]), *EVERYTHING, time_source="header", block_scans=2)

    batches = list(replay)

    scans, images, poses = stamps_of(batches)
    assert scans == [(i + 7) * NS_PER_S for i in range(8)]
    assert images == [round((i + 6.5) * NS_PER_S) for i in range(8)]
    assert poses == [14 * NS_PER_S]
    assert replay.skipped == {
        "an image stamped before what came earlier": 1,
        "a pose stamped before what came earlier": 1,
    }


@pytest.mark.parametrize(
    ("sensors", "start_s"), [(EVERYTHING, 7), (("image", "odometry"), 20), (("odometry",), 30)]
)
def test_clock_is_told_by_the_first_sensor_there_is(
    make_log: MakeLog, sensors: tuple[str, ...], start_s: int
) -> None:
    """Scans, else images, else poses; those that cannot be read do not tell it."""
    broken = [(topic, kind, ns(0), {"payload": b""}) for topic, kind, *_ in (image(0), pose(0))]
    reader = make_log([*broken, scan(0, 7), image(0, 20), pose(0, 30)])

    replay = replay_of(reader, *sensors, time_source="header")

    assert replay.start_ns == start_s * NS_PER_S


def test_batches_of_large_images_are_bounded(make_log: MakeLog) -> None:
    """A batch ends with the image that makes 32 MB full."""
    size = MAX_FRAME_BYTES // 4 - 1
    reader = make_log([image(i, n_bytes=size) for i in range(12)])

    batches = list(replay_of(reader, "image"))

    assert [len(batch.frames) for batch in batches] == [5, 5, 2]
