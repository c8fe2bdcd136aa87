"""Log time against the stamps of headers, and logs that follow one another."""

from collections.abc import Callable, Sequence
from typing import Any

import pytest

from mpap_cli.logs.clocks import clock_shift_ns, out_of_turn
from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.topics import choose_roles
from mpap_cli.observations import NS_PER_S
from mpap_cli.params import BumperParams

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

LASER_SCAN, YEAR_2020_S = "sensor_msgs/msg/LaserScan", 1_577_836_800
JUMPED = "/scan: header stamps and log time part"


def scan(log_s: float, header_s: float) -> Event:
    """Return a scan of four beams, recorded and stamped in seconds from 1970."""
    stamp = {"sec": int(header_s), "nanosec": round(header_s % 1 * NS_PER_S)}
    fields = {"header": {"stamp": stamp}, "angle_increment": 0.1, "ranges": [1.0] * 4}
    return "/scan", LASER_SCAN, round(log_s * NS_PER_S), fields


def findings(
    make_log: MakeLog, seconds: Sequence[tuple[float, float]], **options: Any
) -> list[str]:
    """Replay scans with these log times and header stamps; return what is odd."""
    reader = make_log([scan(*pair) for pair in seconds])
    replay = Replay(reader, choose_roles(reader), BumperParams(), ReplayOptions(**options))
    for _ in range(2):  # it is told of one iteration, not of all
        list(replay)
    return list(replay.clock_findings())


def steady(n: int, log_s: float = 100, header_s: float = 7) -> list[tuple[float, float]]:
    """Return the moments of a scanner of 5 Hz whose clock has another start."""
    return [(log_s + i / 5, header_s + i / 5) for i in range(n)]


def test_clocks_with_different_starts_are_nothing_odd(make_log: MakeLog) -> None:
    """Nor are messages that come late."""
    late = [(log_s + 0.15 * (i % 3 == 0), own_s) for i, (log_s, own_s) in enumerate(steady(30))]

    assert findings(make_log, steady(600)) == []
    assert findings(make_log, late) == []


@pytest.mark.parametrize(
    ("seconds", "expected"),
    [
        (
            [*steady(10), *steady(10, log_s=3702, header_s=9)],
            [f"{JUMPED} once, first at 3,602.0 s, by up to 3,600.0 s"],
        ),
        (
            [*steady(10), *steady(10, log_s=102, header_s=5009)],
            [f"{JUMPED} once, first at 2.0 s, by up to 5,000.0 s"],
        ),
        (
            [*steady(10), *steady(10, log_s=102, header_s=1)],
            ["/scan: header stamps fall once", f"{JUMPED} once, first at 2.0 s, by up to 8.0 s"],
        ),
    ],
    ids=["log time set", "headers set", "headers start again"],
)
def test_jump_of_a_clock_is_told(
    make_log: MakeLog, seconds: list[tuple[float, float]], expected: list[str]
) -> None:
    """How often, when first, and by how much."""
    found = findings(make_log, seconds)

    assert [text for text in found if "pauses" not in text] == expected


def test_log_time_set_back_mixes_messages(make_log: MakeLog) -> None:
    """Read in log time order, those before and those after lie between one another."""
    seconds = [*steady(20), *steady(20, log_s=101.9, header_s=60)]

    found = findings(make_log, seconds)

    assert len(found) == 2
    assert "header stamps fall 10 times" in found[0]
    assert "part 21 times, first at 1.9 s" in found[1]


def test_headers_without_stamp_are_counted(make_log: MakeLog) -> None:
    """They are no jumps of a clock."""
    seconds = [(log_s, 0 if i % 4 == 0 else own_s) for i, (log_s, own_s) in enumerate(steady(40))]

    assert findings(make_log, seconds) == ["/scan: 10 of 40 headers have no stamp"]


def test_pauses_are_told(make_log: MakeLog) -> None:
    """Unless the sensor is that slow."""
    seconds = [*steady(10), *steady(10, 110, 17), *steady(10, 130, 37)]
    slow = [(100 + 9 * i, 7 + 9 * i) for i in range(10)]

    assert findings(make_log, seconds) == [
        "/scan: pauses 2 times, first at 1.8 s, for up to 18.2 s"
    ]
    assert findings(make_log, slow) == []


def test_findings_do_not_depend_on_the_clock_asked_for(make_log: MakeLog) -> None:
    """The same is told by header stamps."""
    seconds = [*steady(10), *steady(10, log_s=102, header_s=5009)]

    assert findings(make_log, seconds, time_source="header") == findings(make_log, seconds)


def test_simulated_time_from_zero_is_played_back(make_log: MakeLog) -> None:
    """The first stamp is 0, and nothing is odd about it."""
    reader = make_log([scan(i / 5, i / 5) for i in range(20)])
    replay = Replay(reader, choose_roles(reader), BumperParams(), ReplayOptions(end="2"))

    (batch,) = replay

    assert (replay.start_ns, replay.end_ns) == (0, 2 * NS_PER_S - 1)
    assert batch.scans[0].stamps_ns.tolist() == [i * NS_PER_S // 5 for i in range(10)]
    assert replay.clock_findings() == ()


def test_first_message_that_can_be_read_tells_the_clock(make_log: MakeLog) -> None:
    """Header minus log time; without messages to go by nothing is known."""
    broken: Event = ("/scan", LASER_SCAN, 0, {"payload": b""})
    reader, silent = make_log([broken, scan(100, 7)]), make_log([broken])

    for log, shift_s in ((reader, -93), (silent, 0)):
        (topic,) = log.topics
        assert clock_shift_ns(log, {"scan": topic}) == shift_s * NS_PER_S


@pytest.mark.parametrize(
    ("first_s", "then_s", "words"),
    [
        (YEAR_2020_S, YEAR_2020_S + 20, ""),
        (YEAR_2020_S, YEAR_2020_S - 5, "starts before the log given before it"),
        (
            YEAR_2020_S,
            YEAR_2020_S + 4,
            "starts 5.0 s before log.mcap ends; what both hold counts twice",
        ),
        (0, 4, ""),
        (4, 0, "starts before the log given before it"),
    ],
)
def test_logs_that_do_not_follow_one_another(
    make_log: MakeLog, first_s: int, then_s: int, words: str
) -> None:
    """Simulations share stamps without sharing time."""
    before, reader = (
        make_log([scan(start_s + i, start_s + i) for i in range(10)])
        for start_s in (first_s, then_s)
    )

    assert out_of_turn(reader, before) == words
