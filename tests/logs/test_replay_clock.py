"""Which part of a log is played back, and by which clock."""

from collections.abc import Callable
from typing import Any

import pytest

from mpap_cli.errors import SettingError, UsageError
from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.topics import TopicChoice, choose_roles
from mpap_cli.observations import NS_PER_S, Batch, Bump
from mpap_cli.params import BumperParams

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

TOUCH = "webots_ros/msg/BoolStamped"
START_S = 1000


def ns(seconds: float) -> int:
    """Return the stamp of a moment of the log."""
    return round((START_S + seconds) * NS_PER_S)


def stamp(seconds: float) -> dict[str, Any]:
    """Return a header with a stamp of another clock, which starts at 0."""
    return {"stamp": {"sec": int(seconds), "nanosec": round(seconds % 1 * NS_PER_S)}}


def scan(seconds: float, header_s: float = 0) -> Event:
    """Return a scan of four beams."""
    fields = {"header": stamp(header_s), "angle_increment": 0.1, "ranges": [1.0] * 4}
    return "/scan", "sensor_msgs/msg/LaserScan", ns(seconds), fields


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


def test_start_and_end_cut(make_log: MakeLog) -> None:
    """From start up to before end; first and last moment are those of the cut."""
    reader = make_log([scan(i) for i in range(10)])
    replay = replay_of(reader, start="2", end=str(ns(5)))

    assert scan_stamps(list(replay)) == [ns(2), ns(3), ns(4)]
    assert (replay.start_ns, replay.end_ns) == (ns(2), ns(5) - 1)
    assert (replay_of(reader).start_ns, replay_of(reader).end_ns) == (ns(0), ns(9))


def test_cut_that_misses_the_log(make_log: MakeLog, caplog: pytest.LogCaptureFixture) -> None:
    """A start behind the last message leaves nothing, and is told."""
    replay = replay_of(make_log([scan(0), scan(1)]), start="50")

    assert list(replay) == []
    assert (replay.start_ns, replay.end_ns) == (ns(50), ns(50))
    assert caplog.messages == ["log.mcap: nothing lies between --start and --end"]


@pytest.mark.parametrize(("start", "end"), [("5", "5"), ("1:00", "2"), ("x", None), (None, "-1")])
def test_cut_that_makes_no_sense(make_log: MakeLog, start: str | None, end: str | None) -> None:
    """An end that is not after the start, or no time at all, is an error of the option."""
    with pytest.raises(SettingError, match=r"--start|time"):
        replay_of(make_log([scan(0)]), start=start, end=end)


def test_header_stamps_are_sorted_and_shift_the_ends(make_log: MakeLog) -> None:
    """By header the clock is the robot's; what is late by more than 2 s is left out."""
    early = [scan(i, header_s=i + 7) for i in range(6)]
    swapped = [scan(6, header_s=14), scan(7, header_s=13.5)]
    late = scan(20, header_s=1)
    rest = [scan(i, header_s=i + 7) for i in range(8, 20)]
    replay = replay_of(
        make_log([*early, *swapped, *rest, late]), time_source="header", block_scans=5
    )

    batches = list(replay)

    expected = [*range(7, 13), 13.5, 14, *range(15, 27)]
    assert scan_stamps(batches) == [round(t * NS_PER_S) for t in expected]
    assert replay.skipped == {"stamped before what came earlier": 1}
    assert (replay.start_ns, replay.end_ns) == (7 * NS_PER_S, 27 * NS_PER_S)


def test_bumps_have_header_stamps_too(make_log: MakeLog) -> None:
    """Scans and bumps go by one clock, or an error says that they cannot."""
    touch: Event = ("/touch", TOUCH, ns(1), {"header": stamp(3.5), "data": True})
    reader = make_log([scan(0), touch])
    bare = make_log([scan(0), ("/bump", "std_msgs/msg/Bool", ns(1), {"data": True})])

    batches = list(replay_of(reader, "/touch", time_source="header"))

    assert bumps_of(batches) == [Bump(round(3.5 * NS_PER_S), "", pressed=True)]
    with pytest.raises(UsageError, match=r"/bump .*no header"):
        list(replay_of(bare, time_source="header"))


@pytest.mark.parametrize(("more", "start_s"), [([scan(1, header_s=5)], 4), ([], START_S)])
def test_clock_is_told_by_the_first_scan_that_can_be_read(
    make_log: MakeLog, more: list[Event], start_s: int
) -> None:
    """A broken scan does not tell it; without any, the ends stay in log time."""
    broken: Event = ("/scan", "sensor_msgs/msg/LaserScan", ns(0), {"payload": b""})

    replay = replay_of(make_log([broken, *more]), time_source="header")

    assert replay.start_ns == start_s * NS_PER_S
