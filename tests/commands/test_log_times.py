"""What commands say of the clocks of logs."""

import json
import shutil
from pathlib import Path

import pytest

from mpap_cli.logs.writing.writer import LogWriter
from mpap_cli.observations import NS_PER_S
from tests.commands.running import BAG, FIXTURES, done

LASER_SCAN, START_S = "sensor_msgs/msg/LaserScan", 1_600_000_000


def write_scans(path: Path, start_s: int, gap_s: int, n_scans: int = 60) -> Path:
    """Write scans of 10 Hz; in the middle log time leaps, header stamps go on."""
    with LogWriter(path, "mcap") as writer:
        for number in range(n_scans):
            own_ns = number * NS_PER_S // 10
            leap_ns = gap_s * NS_PER_S if number >= n_scans // 2 else 0
            stamp = {"sec": 5 + own_ns // NS_PER_S, "nanosec": own_ns % NS_PER_S}
            scan = {
                "header": {"stamp": stamp, "frame_id": "base_link"},
                "angle_min": -1.0,
                "angle_increment": 2 / 89,
                "range_max": 5.0,
                "ranges": [1.0 + number / 100] * 90,
            }
            writer.write("/scan", LASER_SCAN, start_s * NS_PER_S + own_ns + leap_ns, scan)
    return path


def test_info_and_learn_tell_of_a_clock_that_jumps(tmp_path: Path) -> None:
    """One line a kind: how often, when first, how far."""
    log = write_scans(tmp_path / "day.mcap", START_S, gap_s=120)

    facts = json.loads(done("info", log, "--format", "json").out)[0]
    learnt = done("learn", log, "-o", tmp_path / "out")

    findings = [
        "/scan: header stamps and log time part once, first at 123.0 s, by up to 120.0 s",
        "/scan: pauses once, first at 2.9 s, for up to 120.1 s",
    ]
    assert facts["warnings"] == findings
    assert all(f"mpap: day.mcap: {text}\n" in learnt.err for text in findings)


@pytest.mark.parametrize("path", [BAG, FIXTURES / "outdoor-gz", FIXTURES / "camera-a.mcap"])
def test_sound_clocks_are_not_spoken_of(path: Path) -> None:
    """Header stamps a little before log time."""
    assert json.loads(done("info", path, "--format", "json").out)[0]["warnings"] == []


def test_time_from_zero_is_no_date(tmp_path: Path) -> None:
    """The clock of a simulation."""
    log = write_scans(tmp_path / "sim.mcap", start_s=0, gap_s=0)

    text = done("info", log).out

    assert text.startswith("sim.mcap: MCAP, 5.9 s from 0.0 s (no date: its clock starts at 0), 60")


def test_logs_that_overlap_are_told(tmp_path: Path) -> None:
    """A copy under another name is another log."""
    shutil.copy(BAG, tmp_path / "copy.bag")

    learnt = done("learn", BAG, tmp_path / "copy.bag", "--no-recording", "-o", tmp_path / "out")

    words = "copy.bag: starts 80.0 s before indoor-a.bag ends; what both hold counts twice"
    assert f"mpap: {words}\n" in learnt.err
