"""A simulated log holds what happened, in every container, and the truth beside it."""

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from mpap_cli.errors import OutputError
from mpap_cli.logs.writing.storages import CONTAINERS
from mpap_cli.observations import NS_PER_S, BoolArray, Float32Array, IntArray
from mpap_cli.simulation import sources
from mpap_cli.simulation.bumper import Faults
from mpap_cli.simulation.scenario import SimulatedLog, simulate
from mpap_cli.simulation.settings import SimulationParams

ROSBAGS = ("bag", "rosbag2-sqlite3", "rosbag2-mcap", "mcap")


def read(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Return stamps and messages by topic, read with rosbags."""
    found: dict[str, list[tuple[int, Any]]] = {}
    with AnyReader([path]) as reader:
        for connection, stamp, payload in reader.messages():
            message = reader.deserialize(payload, connection.msgtype)
            found.setdefault(connection.topic, []).append((stamp, message))
    return found


def read_json(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Return stamps and messages by topic of a log in JSON."""
    found: dict[str, list[tuple[int, Any]]] = {}
    with path.open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            entry = (message.log_time, json.loads(message.data))
            found.setdefault(channel.topic, []).append(entry)
    return found


def scans_of(found: dict[str, list[tuple[int, Any]]]) -> tuple[IntArray, Float32Array]:
    """Return the stamps and ranges of the scans."""
    stamps = np.array([stamp for stamp, _ in found["/scan"]], np.int64)
    ranges = [m["ranges"] if isinstance(m, dict) else m.ranges for _, m in found["/scan"]]
    return stamps, np.array(ranges, np.float32)


def in_contact(log: SimulatedLog, stamps: IntArray) -> BoolArray:
    """Return which stamps lie in a contact, by the table of truth."""
    with log.truth_path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    times = (stamps - log.start_ns) / NS_PER_S
    inside = np.zeros(len(stamps), bool)
    for row in rows:
        inside |= (times >= float(row["start_s"])) & (times < float(row["end_s"]))
    return inside


def test_scans_are_the_same_in_every_container(tmp_path: Path) -> None:
    """The container changes neither stamps nor ranges, not even in JSON."""
    found = {}

    for name in ROSBAGS:
        path = tmp_path / (f"{name}.bag" if name == "bag" else f"{name}.mcap")
        log = simulate(path, SimulationParams(container=name, duration_s=8))
        found[name] = scans_of(read(log.path))
    log = simulate(tmp_path / "json", SimulationParams(container="mcap-json", duration_s=8))
    found["json"] = scans_of(read_json(log.path))

    stamps, ranges = found["bag"]
    assert ranges.shape == (80, 180)
    for other_stamps, other_ranges in found.values():
        assert stamps.tobytes() == other_stamps.tobytes()
        assert ranges.tobytes() == other_ranges.tobytes()


def test_messages_come_in_time_order_at_their_rates(tmp_path: Path) -> None:
    """10 Hz scans, odometry, commands and bumper; one transform; log time never runs back."""
    params = SimulationParams(bumper="bool", duration_s=60)

    log = simulate(tmp_path / "log.mcap", params)

    found = read(log.path)
    counts = {topic: len(messages) for topic, messages in found.items()}
    assert counts == {"/tf_static": 1, "/scan": 600, "/odom": 600, "/cmd_vel": 600, "/bumper": 600}
    assert (log.n_scans, log.n_messages) == (600, sum(counts.values()))
    with AnyReader([log.path]) as reader:
        stamps = [stamp for _, stamp, _ in reader.messages()]
    assert stamps == sorted(stamps)
    assert (stamps[0], stamps[-1]) == (log.start_ns, log.end_ns)
    assert log.start_ns == params.start_stamp_ns
    for stamp, scan in found["/scan"]:
        header_ns = scan.header.stamp.sec * NS_PER_S + scan.header.stamp.nanosec
        assert 0 < stamp - header_ns < 20_000_000
        assert (header_ns - params.start_stamp_ns) % 100_000_000 == 0


def test_size_of_a_block_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same settings give the same bytes, however many steps are simulated at once."""
    params = SimulationParams(world="outdoor", seed=5, duration_s=40)

    logs = [simulate(tmp_path / "a.mcap", params)]
    monkeypatch.setattr(sources, "_BLOCK_STEPS", 37)
    logs.append(simulate(tmp_path / "b.mcap", params))

    assert logs[0].path.read_bytes() == logs[1].path.read_bytes()
    assert logs[0].contacts == logs[1].contacts
    assert len(logs[0].contacts) > 0


def test_truth_is_a_table_of_contacts(tmp_path: Path) -> None:
    """The table has a row per contact; times count from the first message."""
    params = SimulationParams(seed=28, duration_s=80, container="bag")

    log = simulate(tmp_path / "day.bag", params)

    lines = log.truth_path.read_text(encoding="utf-8").splitlines()
    assert log.truth_path.name == "day.bag.truth.csv"
    assert lines[0] == "log,start_s,end_s,visible,cause,bearing_deg"
    assert len(lines) == 1 + len(log.contacts)
    name, start_s, end_s, visible, cause, bearing_deg = lines[1].split(",")
    first = log.contacts[0]
    assert name == "day.bag"
    assert float(start_s) == pytest.approx((first.start_ns - log.start_ns) / NS_PER_S)
    assert float(end_s) == pytest.approx((first.end_ns - log.start_ns) / NS_PER_S)
    assert (visible == "1", cause) == (first.visible, first.cause)
    assert float(bearing_deg) == pytest.approx(first.bearing_deg, abs=0.05)
    assert all(abs(contact.bearing_deg) <= 80 for contact in log.contacts)
    assert all(log.start_ns <= c.start_ns < c.end_ns <= log.end_ns for c in log.contacts)


def test_sound_bumper_agrees_with_the_truth(tmp_path: Path) -> None:
    """Without faults the bumper is pressed in contact and hardly ever else; with them it is not."""
    share = []

    for i, faults in enumerate((Faults(late=0, held=0, missed=0), Faults(held=0.9))):
        params = SimulationParams(seed=28, duration_s=80, bumper="bool", faults=faults)
        log = simulate(tmp_path / f"{i}.mcap", params)
        found = read(log.path)["/bumper"]
        pressed = np.array([message.data for _, message in found])
        truth = in_contact(log, np.array([stamp for stamp, _ in found], np.int64))
        share.append(float(np.mean(pressed == truth)))

    assert share[0] > 0.98
    assert share[1] < 0.95


@pytest.mark.parametrize("tf_topic", ["/tf_static", "/tf"])
@pytest.mark.parametrize("forward_deg", [0.0, 180.0, -20.0])
def test_scanner_always_looks_ahead(tmp_path: Path, tf_topic: str, forward_deg: float) -> None:
    """A turned scanner has a turned transform and turned angles; the ranges are the same."""
    plain = simulate(tmp_path / "plain.mcap", SimulationParams(duration_s=2))
    params = SimulationParams(duration_s=2, forward_deg=forward_deg, tf_topic=tf_topic)

    log = simulate(tmp_path / "log.mcap", params)

    found = read(log.path)
    transform = found[tf_topic][0][1].transforms[0]
    assert transform.header.frame_id == "base_link"
    assert transform.child_frame_id == found["/scan"][0][1].header.frame_id
    turn = transform.transform.rotation
    yaw = 2 * math.atan2(turn.z, turn.w)
    scan = found["/scan"][0][1]
    first_in_base = math.remainder(yaw + scan.angle_min, math.tau)
    assert first_in_base == pytest.approx(-math.pi / 2, abs=1e-6)
    assert scan.angle_max - scan.angle_min == pytest.approx(math.radians(179), abs=1e-5)
    assert len(found[tf_topic]) == (1 if tf_topic == "/tf_static" else 20)
    assert scans_of(found)[1].tobytes() == scans_of(read(plain.path))[1].tobytes()


def test_json_log_holds_scans_with_their_pose_and_presses(tmp_path: Path) -> None:
    """A JSON log has two topics; the scan's pose tells where the scanner is on the robot."""
    params = SimulationParams(container="mcap-json", duration_s=2, forward_deg=90, no_return="zero")

    log = simulate(tmp_path / "log.mcap", params)

    found = read_json(log.path)
    assert set(found) == {"/scan", "/bump"}
    _, scan = found["/scan"][0]
    assert scan["frame_id"] == "base_link"
    assert scan["pose"]["orientation"]["z"] == pytest.approx(-math.sqrt(0.5))
    assert scan["start_angle"] == pytest.approx(0.0)
    assert found["/bump"][0][1]["pressed"] is False


def test_odometry_follows_the_drive_with_an_error(tmp_path: Path) -> None:
    """Odometry moves as fast as commanded, within a tenth, and turns as well."""
    log = simulate(tmp_path / "log.mcap", SimulationParams(duration_s=60, seed=3))

    found = read(log.path)
    speeds = np.array([message.twist.twist.linear.x for _, message in found["/odom"]])
    commands = np.array([message.linear.x for _, message in found["/cmd_vel"]])
    assert np.median(speeds[speeds > 0.2]) == pytest.approx(commands.max(), rel=0.1)
    places = np.array([(m.pose.pose.position.x, m.pose.pose.position.y) for _, m in found["/odom"]])
    driven = np.hypot(*np.diff(places, axis=0).T).sum()
    assert driven == pytest.approx(np.abs(speeds).sum() * 0.1, rel=0.1)


def test_one_world_can_be_walked_twice(tmp_path: Path) -> None:
    """With the same world seed the first scan is nearly the same, the walk is another."""
    seeds = (28, 124)

    logs = [
        simulate(
            tmp_path / f"{seed}.mcap", SimulationParams(seed=seed, world_seed=28, duration_s=20)
        )
        for seed in seeds
    ]

    first, second = (scans_of(read(log.path))[1] for log in logs)
    assert np.mean(np.abs(first[0] - second[0]) < 0.05) > 0.8
    assert np.mean(np.abs(first[-1] - second[-1]) < 0.05) < 0.5


def test_existing_log_is_refused(tmp_path: Path) -> None:
    """A log that exists stays, and no truth is written beside it."""
    path = tmp_path / "log.mcap"
    path.write_text("mine")

    with pytest.raises(OutputError, match="exists already"):
        simulate(path, SimulationParams(duration_s=1))

    assert [p.name for p in tmp_path.iterdir()] == ["log.mcap"]


def test_an_older_truth_is_not_overwritten(tmp_path: Path) -> None:
    """Where a truth lies already, neither it nor a log is written."""
    (tmp_path / "log.mcap.truth.csv").write_text("mine")

    with pytest.raises(OutputError, match=r"truth\.csv: exists"):
        simulate(tmp_path / "log.mcap", SimulationParams(duration_s=1))

    assert [path.name for path in tmp_path.iterdir()] == ["log.mcap.truth.csv"]


def test_a_log_needs_a_name() -> None:
    """An empty path is refused in words."""
    with pytest.raises(OutputError, match="no name for a log"):
        simulate(Path(), SimulationParams(duration_s=1))


@pytest.mark.parametrize("container", CONTAINERS)
def test_simulated_time_may_start_at_zero(tmp_path: Path, container: str) -> None:
    """A log may begin at 0 ns, as simulators' clocks do."""
    params = SimulationParams(container=container, duration_s=1, start_stamp_ns=0)

    log = simulate(tmp_path / "log", params)

    assert 0 <= log.start_ns < 20_000_000
    assert log.n_scans == 10
