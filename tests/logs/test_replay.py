"""Logs played back in batches."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.topics import TopicChoice, choose_roles
from mpap_cli.observations import NS_PER_S, Batch, Bump
from mpap_cli.params import BumperParams

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

LASER_SCAN, BOOL = "sensor_msgs/msg/LaserScan", "std_msgs/msg/Bool"
KOBUKI = "kobuki_msgs/msg/BumperEvent"
START_S = 1000


def ns(seconds: float) -> int:
    """Return the stamp of a moment of the log."""
    return round((START_S + seconds) * NS_PER_S)


def scan(seconds: float, n_beams: int = 4) -> Event:
    """Return a scan whose ranges tell its moment."""
    ranges = np.full(n_beams, seconds, dtype=np.float32)
    fields = {"angle_increment": 0.1, "range_max": 9.0, "ranges": ranges}
    return "/scan", LASER_SCAN, ns(seconds), fields


def bump(seconds: float, pressed: bool, topic: str = "/bump") -> Event:
    """Return a std_msgs/Bool."""
    return topic, BOOL, ns(seconds), {"data": pressed}


def replay_of(reader: LogReader, *bumps: str, **options: Any) -> Replay:
    """Make the replay of a log."""
    roles = choose_roles(reader, TopicChoice(bumps=bumps))
    return Replay(reader, roles, BumperParams(), ReplayOptions(**options))


def bumps_of(batches: list[Batch]) -> list[Bump]:
    """Return all bumps in the order they came."""
    return [one for batch in batches for one in batch.bumps]


def scan_stamps(batches: list[Batch]) -> list[int]:
    """Return the stamps of all scans in the order they came."""
    return [int(t) for batch in batches for block in batch.scans for t in block.stamps_ns]


def test_scans_come_in_blocks(make_log: MakeLog) -> None:
    """A block has the ranges of its scans, row by row, and they may be written to."""
    replay = replay_of(make_log([scan(0.1 * i) for i in range(10)]), block_scans=4)

    batches = list(replay)

    assert [len(block.stamps_ns) for batch in batches for block in batch.scans] == [4, 4, 2]
    assert scan_stamps(batches) == [ns(0.1 * i) for i in range(10)]
    ranges = np.concatenate([block.ranges for batch in batches for block in batch.scans])
    rows = np.array([0.1 * i for i in range(10)], dtype=np.float32)
    np.testing.assert_array_equal(ranges, np.repeat(rows[:, np.newaxis], 4, axis=1))
    assert ranges.dtype == np.float32
    assert batches[0].scans[0].ranges.flags.writeable
    assert replay.bump_kind is None


def test_a_block_ends_where_the_geometry_changes(make_log: MakeLog) -> None:
    """Beam counts that vary stay in one batch, in blocks of their own."""
    sizes = [8, 8, 7, 9, 9, 8]
    reader = make_log([scan(i, n_beams=size) for i, size in enumerate(sizes)])

    (batch,) = replay_of(reader)

    assert [block.ranges.shape for block in batch.scans] == [(2, 8), (1, 7), (2, 9), (1, 8)]
    assert [block.geometry.n_beams for block in batch.scans] == [8, 7, 9, 8]


def test_batches_come_where_no_scans_do(make_log: MakeLog) -> None:
    """A batch spans at most two minutes of log time, with scans or without."""
    reader = make_log([scan(0), *(bump(12 * i, pressed=i % 2 == 0) for i in range(1, 60))])

    batches = list(replay_of(reader))

    assert len(batches) == 6
    assert [len(batch.scans) for batch in batches] == [1, 0, 0, 0, 0, 0]
    assert [batch.until_ns for batch in batches] == [ns(12 * t) for t in (10, 21, 32, 43, 54, 59)]


def test_equal_stamps_stay_in_one_batch(make_log: MakeLog) -> None:
    """No later batch holds anything stamped at or before ``until_ns``."""
    reader = make_log([scan(0), scan(1), scan(1), bump(1, pressed=True), scan(1), scan(2)])

    batches = list(replay_of(reader, block_scans=2))

    assert [batch.until_ns for batch in batches] == [ns(1), ns(2)]
    assert scan_stamps(batches) == [ns(t) for t in (0, 1, 1, 1, 2)]
    assert len(batches[0].bumps) == 1


def test_of_a_level_stream_only_changes_come(make_log: MakeLog) -> None:
    """The first message and the changes become bumps, over batches too."""
    states = [False, False, True, True, False, False]
    reader = make_log([bump(8 * i, pressed=state) for i, state in enumerate(states)])
    replay = replay_of(reader)

    batches = list(replay)

    changes = [(0, False), (16, True), (32, False)]
    assert bumps_of(batches) == [Bump(ns(t), "", state) for t, state in changes]
    assert replay.bump_kind == "level"


def test_edges_keep_their_sensors(make_log: MakeLog) -> None:
    """Each sensor has its own state."""
    events = [(0, 0, 1), (1, 2, 1), (2, 0, 0), (3, 2, 0)]
    reader = make_log([("/bumper", KOBUKI, ns(t), {"bumper": b, "state": s}) for t, b, s in events])
    replay = replay_of(reader)

    batches = list(replay)

    assert bumps_of(batches) == [Bump(ns(t), str(b), s == 1) for t, b, s in events]
    assert replay.bump_kind == "edge"


def test_of_pulses_every_touch_comes(make_log: MakeLog) -> None:
    """Touches are not changes; a message that is no touch is left out."""
    reader = make_log([bump(i, pressed=i != 1) for i in range(4)])
    replay = replay_of(reader, "/bump:pulse=0.75")

    batches = list(replay)

    assert bumps_of(batches) == [Bump(ns(t), "", pressed=True) for t in (0, 2, 3)]
    assert (replay.bump_kind, replay.hold_s) == ("pulse", 0.75)


def test_several_bump_topics_are_joined_by_sensor(make_log: MakeLog) -> None:
    """Each topic is a sensor of its own, so that one release does not hide another press."""
    kobuki = ("/event", KOBUKI, ns(3), {"bumper": 2, "state": 1})
    left = [bump(0, pressed=True, topic="/left"), bump(2, pressed=False, topic="/left")]
    right = [bump(1, pressed=True, topic="/right")]
    replay = replay_of(make_log([*left, *right, kobuki]), "/left", "/right", "/event")

    batches = list(replay)

    assert bumps_of(batches) == [
        Bump(ns(0), "/left", pressed=True),
        Bump(ns(1), "/right", pressed=True),
        Bump(ns(2), "/left", pressed=False),
        Bump(ns(3), "/event:2", pressed=True),
    ]
    assert (replay.bump_kind, replay.hold_s) == ("edge", 0.25)


@pytest.mark.parametrize(
    ("way", "kind"), [("", "level"), (":pulse=0.5", "pulse"), (":edge=data", "edge")]
)
def test_topics_of_one_kind_keep_it(make_log: MakeLog, way: str, kind: str) -> None:
    """Only topics of different kinds become edges, so that levels can be held from the start."""
    reader = make_log([bump(0, pressed=True, topic=topic) for topic in ("/left", "/right")])

    replay = replay_of(reader, "/left" + way, "/right" + way)

    assert replay.bump_kind == kind


def test_broken_messages_are_left_out_and_counted(make_log: MakeLog) -> None:
    """Scans cut short, scans with few beams and bad bumps do not stop the rest."""
    cut: Event = ("/scan", LASER_SCAN, ns(0.5), {"payload": b"\x00\x01\x00\x00"})
    bad: Event = ("/bump", BOOL, ns(0.6), {"payload": b"\x00"})
    whole = [scan(i, n_beams=20) for i in range(5)]
    few = scan(5, n_beams=9)
    replay = replay_of(make_log([*whole, cut, bad, few, bump(1, pressed=True)]))

    batches = list(replay)

    assert scan_stamps(batches) == [ns(i) for i in range(5)]
    assert bumps_of(batches) == [Bump(ns(1), "", pressed=True)]
    assert replay.skipped == {
        "a message shorter than its header": 1,
        "a scan with fewer than half the usual beams": 1,
        "a bump message that does not fit its definition": 1,
    }


def test_iteration_starts_anew(make_log: MakeLog) -> None:
    """A second iteration gives the same batches and the same counts."""
    reader = make_log([scan(0), scan(1, n_beams=1), bump(1, pressed=True)])
    replay = replay_of(reader)

    first, second = ((list(replay), dict(replay.skipped)) for _ in range(2))

    assert scan_stamps(first[0]) == scan_stamps(second[0]) == [ns(0)]
    assert bumps_of(first[0]) == bumps_of(second[0])
    assert first[1] == second[1]


def test_another_type_under_the_same_name_is_left_out(make_log: MakeLog) -> None:
    """A topic is a name with a type."""
    other: Event = ("/scan", "std_msgs/msg/String", ns(0.5), {"data": "x"})

    batches = list(replay_of(make_log([scan(0), other, scan(1)])))

    assert scan_stamps(batches) == [ns(0), ns(1)]


def test_log_without_roles_has_no_batches(make_log: MakeLog) -> None:
    """Neither scans nor bumps: nothing comes."""
    replay = replay_of(make_log([("/odom", "nav_msgs/msg/Odometry", ns(0), {})]))

    assert list(replay) == []
