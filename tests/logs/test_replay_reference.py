"""What comes out of a replay is what a plain loop over single messages gives."""

import functools
import tempfile
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from mcap.writer import Writer as McapWriter

from mpap_cli.logs.bumps.expression import field_values, parse_expression
from mpap_cli.logs.fields import FieldError, scan_view
from mpap_cli.logs.raw import LogReader, PayloadError, RawMessage
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.topics import Roles, TopicChoice, choose_roles
from mpap_cli.logs.writing import storages
from mpap_cli.logs.writing.writer import LogWriter
from mpap_cli.observations import NS_PER_S, Bump
from mpap_cli.params import BumperParams

START_S = 1_600_000_000
MARGIN_NS = 2 * NS_PER_S
CONTAINERS = [*storages.CONTAINERS, "rosbag2-sqlite3/zstd-message"]
STAMPED, EDGE, JSON = "webots_ros/msg/BoolStamped", "kobuki_msgs/msg/BumperEvent", "Bumper"


@dataclass
class Played:
    """All that a replay gives."""

    scans: list[tuple[int, list[float], Any]] = field(default_factory=list)
    bumps: list[Bump] = field(default_factory=list)
    skipped: Counter[str] = field(default_factory=Counter)


def write_log(path: Path, container: str, seed: int, bump_type: str) -> Path:
    """Write scans of changing geometry and bumps, some broken, some out of order."""
    rng = np.random.default_rng(seed)
    name, _, compression = container.partition("/")
    is_json = name == "mcap-json"
    path /= "log.bag" if name == "bag" else "log.mcap" if name.startswith("mcap") else "log"
    with LogWriter(path, name, compression or None) as writer:
        storage: Any = writer._storage
        if name == "bag":
            storage._bag.chunk_threshold = 2000
        writer.add_topic("/scan", "foxglove.LaserScan" if is_json else "sensor_msgs/msg/LaserScan")
        for topic in ("/bump", "/other"):
            writer.add_topic(topic, bump_type)
        offset_s, n_beams = 0.0, 8
        for number in range(90):
            offset_s += rng.choice([0.0, 0.05, 0.1, 0.1, 0.1, 12.0 * (number % 20 == 0)])
            late_s = rng.choice([0, 0, 0, 0.5, 3.5 * (number % 10 == 0)])
            stamp_ns = round((START_S + offset_s - late_s * rng.integers(2)) * NS_PER_S)
            inside_ns = round((START_S - 50 + offset_s - late_s) * NS_PER_S)
            n_beams = int(rng.choice([n_beams, n_beams, n_beams, 8, 9, 3]))
            stamp = {"sec": inside_ns // NS_PER_S, "nanosec": inside_ns % NS_PER_S}
            topic = str(rng.choice(["/scan", "/scan", "/bump", "/bump", "/other"]))
            if topic == "/scan":
                fields = scan_fields(rng.random(n_beams), stamp, is_json=is_json)
            else:
                fields = bump_fields(bump_type, stamp, rng)
            msgtype, topic_id = writer._topics[topic]
            payload = writer._encoder.encode(msgtype, fields)
            broken = rng.random() < 0.05 and number > 9
            storage.write(topic_id, stamp_ns, payload[: len(payload) // 2] if broken else payload)
    return path


def scan_fields(ranges: Any, stamp: dict[str, int], *, is_json: bool) -> dict[str, Any]:
    """Return the fields of a scan."""
    if is_json:
        inside = {"sec": stamp["sec"], "nsec": stamp["nanosec"]}
        angles = {"start_angle": -1.0, "end_angle": 1.0}
        return {"timestamp": inside, "frame_id": "laser", "ranges": ranges, **angles}
    header = {"stamp": stamp, "frame_id": "laser"}
    return {"header": header, "angle_increment": 0.1, "range_max": 9.0, "ranges": ranges}


def bump_fields(msgtype: str, stamp: dict[str, int], rng: np.random.Generator) -> dict[str, Any]:
    """Return the fields of a bump."""
    pressed = bool(rng.integers(2))
    if msgtype == STAMPED:
        return {"header": {"stamp": stamp}, "data": pressed}
    if msgtype == EDGE:
        return {"bumper": int(rng.integers(3)), "state": int(pressed)}
    return {"pressed": pressed}


def play_plainly(reader: LogReader, roles: Roles, options: ReplayOptions) -> Played:
    """Read message by message: the reference."""
    played = Played()
    start_ns, end_ns = (
        reader.start_ns + round(float(text) * NS_PER_S) if text else None
        for text in (options.start, options.end)
    )
    by_header = options.time_source == "header"
    names = {"/scan", *(role.topic.name for role in roles.bumps)}
    first = [
        len(scan[1])
        for scan in map(read, list(reader.messages({"/scan"}))[:200])
        if not isinstance(scan, str)
    ]
    events: list[tuple[int, int, Any]] = []
    for message in reader.messages(names, start_ns, end_ns):
        if message.topic.name == "/scan":
            scan = read(message, options.time_source)
            if isinstance(scan, str):
                played.skipped[scan] += 1
            elif len(scan[1]) < np.median(first) / 2:
                played.skipped["a scan with fewer than half the usual beams"] += 1
            else:
                events.append((message.stamp_ns, scan[0], scan))
            continue
        try:
            decoded = reader.decode(message)
        except PayloadError:
            played.skipped["a bump message that does not fit its definition"] += 1
            continue
        (role,) = (role for role in roles.bumps if role.topic.name == message.topic.name)
        stamp_ns = inner_stamp_ns(decoded) if by_header else message.stamp_ns
        named_by = role.rule.sensor_field
        sensor = ",".join(map(str, field_values(decoded, named_by))) if named_by else ""
        prefix = message.topic.name + (":" if sensor else "") if len(roles.bumps) > 1 else ""
        pressed = parse_expression(role.rule.expression)(decoded)
        events.append((message.stamp_ns, stamp_ns, Bump(stamp_ns, prefix + sensor, pressed)))
    take_events(played, events, [role.topic.name for role in roles.bumps])
    return played


def take_events(played: Played, events: list[tuple[int, int, Any]], topics: list[str]) -> None:
    """Leave out what is late, sort the rest, and keep the bumps that say something new."""
    kept = []
    for recorded_ns, stamp_ns, event in events:
        latest_ns = max(other[1] for other in events if other[0] <= recorded_ns)
        if stamp_ns < latest_ns - MARGIN_NS:
            played.skipped["stamped before what came earlier"] += 1
        else:
            kept.append((recorded_ns, event))
    states: dict[str, bool] = {}
    several = len(topics) > 1
    played.scans = sorted((e for _, e in kept if not isinstance(e, Bump)), key=lambda e: e[0])
    bumps = [(recorded_ns, event) for recorded_ns, event in kept if isinstance(event, Bump)]
    bumps.sort(
        key=lambda bump: (
            bump[1].stamp_ns,
            bump[0],
            topics.index(bump[1].sensor.split(":")[0]) if several else 0,
        )
    )
    for _, bump in bumps:
        if states.get(bump.sensor) is not bump.pressed:
            states[bump.sensor] = bump.pressed
            played.bumps.append(bump)


def read(
    message: RawMessage, time_source: Literal["log", "header"] = "log"
) -> tuple[int, list[float], Any] | str:
    """Read a scan, or say what is wrong with it."""
    try:
        stamp_ns, ranges, geometry = scan_view(message, time_source)
    except FieldError as err:
        return str(err)
    return stamp_ns, ranges.tolist(), geometry


def inner_stamp_ns(decoded: Any) -> int:
    """Return the stamp of a header."""
    stamp = decoded.header.stamp
    return int(stamp.sec) * NS_PER_S + int(stamp.nanosec)


def play(replay: Replay, block_scans: int) -> Played:
    """Replay a log, and look at how the batches follow one another."""
    played = Played()
    last_ns = -1
    for batch in replay:
        scans = [
            (int(stamp_ns), ranges.tolist(), block.geometry)
            for block in batch.scans
            for stamp_ns, ranges in zip(block.stamps_ns, block.ranges, strict=True)
        ]
        played.scans.extend(scans)
        played.bumps.extend(batch.bumps)
        stamps_ns = [scan[0] for scan in scans] + [bump.stamp_ns for bump in batch.bumps]
        assert all(last_ns < stamp_ns <= batch.until_ns for stamp_ns in stamps_ns)
        assert len([scan for scan in scans if scan[0] < scans[-1][0]]) < block_scans
        last_ns = batch.until_ns
    played.skipped = replay.skipped
    return played


every_option = st.builds(
    lambda cut, **others: ReplayOptions(start=cut[0], end=cut[1], **others),
    cut=st.sampled_from([(None, None), ("1.5", None), ("0.7", "13.2")]),
    time_source=st.sampled_from(["log", "header"]),
    block_scans=st.sampled_from([3, 20, 1024]),
)


@pytest.mark.parametrize("container", CONTAINERS)
@settings(
    max_examples=settings().max_examples // 12, phases=[Phase.generate]
)  # each example writes a log
@given(
    seed=st.integers(0, 10**6),
    bumps=st.sampled_from([("/bump",), ("/bump", "/other"), ()]),
    bump_type=st.sampled_from([STAMPED, EDGE]),
    options=every_option,
)
def test_replay_is_the_plain_loop(
    container: str, seed: int, bumps: tuple[str, ...], bump_type: str, options: ReplayOptions
) -> None:
    """Scans, changes of bumps and counts, for every container, clock, cut and block."""
    bump_type = JSON if container == "mcap-json" else bump_type
    if bump_type != STAMPED and bumps:
        options = replace(options, time_source="log")
    choice = TopicChoice(bumps=bumps, bump_from="topic" if bumps else "none")
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(storages, "McapFile", functools.partial(McapWriter, chunk_size=2000))
        path = write_log(Path(folder), container, seed, bump_type)
        with open_log(path) as reader:
            roles = choose_roles(reader, choice)
            found = play(Replay(reader, roles, BumperParams(), options), options.block_scans)
            expected = play_plainly(reader, roles, options)

    assert found == expected
