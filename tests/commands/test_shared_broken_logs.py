"""Traps and damaged copies: one clear line, what is whole is used, never a traceback."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.commands.running import Outcome, mpap

pytestmark = pytest.mark.shared
NO_SCAN = "no scan, image or bump topic"


class Trap(NamedTuple):
    """A log, how ``learn`` ends, what it says; messages and scans that ``info`` counts."""

    path: str
    code: int
    words: tuple[str, ...]
    messages: int | None = None
    scans: int | None = None


READ = [
    Trap("traps/folder-named.bag", 0, ("never fired",), 4036, 113),
    Trap("traps/made-stale-metadata", 0, ("metadata.yaml names", "never fired"), 1545, 153),
    Trap("traps/made-no-metadata", 0, ("metadata.yaml is missing", "never fired"), 1545, 153),
    Trap("traps/beam-count-varies", 0, ("no bump topic",), 712, 238),
    Trap(
        "traps/broken-scans-37-beams",
        0,
        ("skipped: a scan with fewer than half the usual beams", "never fired"),
        7301,
        83,
    ),
    Trap("traps/two-scan-topics.bag", 2, ("/front_scan, /rear_scan", "--scan-topic"), 661),
    Trap("traps/mcap-no-scan", 2, (NO_SCAN, "/imu/data (sensor_msgs/msg/Imu)"), 6578),
    Trap("traps/cmd-vel-only.bag", 2, (NO_SCAN, "/cmd_vel (geometry_msgs/msg/Twist)"), 1525),
    Trap("traps/example.bag", 2, (NO_SCAN, "turtlesim/msg/Color"), 8647),
    Trap("traps/example-bz2.bag", 2, (NO_SCAN, "turtlesim/msg/Color"), 8647),
    Trap("traps/example-lz4.bag", 2, (NO_SCAN, "turtlesim/msg/Color"), 8647),
    Trap("traps/split-5-files-sqlite3", 2, (NO_SCAN, "AAA (std_msgs/msg/String)"), 6074),
    Trap("traps/split-5-files-mcap", 2, (NO_SCAN, "HHH (std_msgs/msg/String)"), 6074),
]
UNREADABLE = [
    Trap("traps/stale-metadata", 1, ("metadata.yaml names", "no messages")),
    Trap("traps/made-empty-rosbag2", 1, ("no messages",)),
    Trap("traps/no-messages.bag", 1, ("no messages",)),
    Trap("traps/git-lfs-pointer.bag", 1, ("git lfs pull",)),
    Trap("traps/git-lfs-pointer.mcap", 1, ("git lfs pull",)),
    Trap("damaged/zero.bag", 1, ("the file is empty",)),
    Trap("damaged/zero.mcap", 1, ("the file is empty",)),
    Trap("damaged/zero.db3", 1, ("the file is empty",)),
    Trap("damaged/zero-db3-folder", 1, ("the file is empty",)),
]


class Damaged(NamedTuple):
    """A damaged log: the words of the damage, and the whole messages in it."""

    path: str
    words: str
    scans: int
    bumps: int
    messages: int
    presses: int


DAMAGED = [
    Damaged("damaged/cut70.bag", "cut off or broken", 102, 141, 1478, 0),
    Damaged("damaged/unindexed.bag", "no usable index", 145, 194, 2079, 2),
    Damaged("damaged/killed.bag.active", "cut off or broken", 144, 193, 2066, 2),
    Damaged("damaged/cut70.mcap", "cut off or broken", 206, 216, 1864, 0),
    Damaged("damaged/cut70.db3", "malformed", 126, 134, 1290, 0),
    Damaged("damaged/cut70-db3", "malformed", 126, 134, 1290, 0),
]
# one of 32 chunks is left out, and what it held by the index is not counted
FLIPPED = [
    Damaged("damaged/flipped-byte-crc.mcap", "its checksum is wrong", 271, 292, 2462, 2),
    Damaged("damaged/flipped-byte-zstd.mcap", "zstd cannot unpack it", 271, 292, 2461, 2),
]


def facts_of(outcome: Outcome) -> dict[str, Any]:
    """Return what ``info --format json`` printed of one log."""
    facts: list[dict[str, Any]] = json.loads(outcome.out)
    return facts[0]


@pytest.mark.parametrize("trap", [*READ, *UNREADABLE], ids=lambda trap: trap.path)
def test_learn_says_what_is_wrong(shared_logs: Path, tmp_path: Path, trap: Trap) -> None:
    """The exit code, and on stderr the name of the log and the reason."""
    outcome = mpap("learn", shared_logs / trap.path, "-o", tmp_path / "out")

    assert outcome.code == trap.code
    assert all(words in outcome.err for words in trap.words)
    assert trap.path.rpartition("/")[2] in outcome.err or "zero-db3" in trap.path
    assert all(line.startswith("mpap: ") for line in outcome.err.splitlines())
    assert (tmp_path / "out" / "learn" / "model.npz").exists() is (trap.code == 0)


@pytest.mark.parametrize("trap", READ, ids=lambda trap: trap.path)
def test_info_shows_what_can_be_read(shared_logs: Path, trap: Trap) -> None:
    """A log from which nothing can be learnt is no error of info."""
    outcome = mpap("info", shared_logs / trap.path, "--format", "json")

    facts = facts_of(outcome)
    assert outcome.code == 0
    assert facts["messages"] == trap.messages
    assert sum(topic["messages"] for topic in facts["topics"]) == trap.messages
    assert (facts["scan"] and facts["scan"]["scans"]) == trap.scans


@pytest.mark.parametrize("trap", UNREADABLE, ids=lambda trap: trap.path)
def test_info_refuses_what_cannot_be_read(shared_logs: Path, trap: Trap) -> None:
    """Exit code 1, the reason, and nothing on stdout."""
    outcome = mpap("info", shared_logs / trap.path)

    assert (outcome.code, outcome.out) == (1, "")
    assert all(words in outcome.err for words in trap.words)


@pytest.mark.parametrize("damaged", [*DAMAGED, *FLIPPED], ids=lambda damaged: damaged.path)
def test_what_is_whole_is_used(shared_logs: Path, tmp_path: Path, damaged: Damaged) -> None:
    """Exit code 3, the damage in one line, and every whole message counted."""
    shown = mpap("info", shared_logs / damaged.path, "--format", "json")
    learnt = mpap("learn", shared_logs / damaged.path, "-o", tmp_path / "out")

    facts = facts_of(shown)
    assert (shown.code, learnt.code) == (3, 3)
    assert len(facts["damage"]) == 1
    assert damaged.words in facts["damage"][0]
    assert facts["damage"][0] in learnt.err
    counts = {topic["name"]: topic["messages"] for topic in facts["topics"]}
    assert (facts["messages"], counts["/bump"]) == (damaged.messages, damaged.bumps)
    assert (facts["scan"]["scans"], facts["bump"]["presses"]) == (damaged.scans, damaged.presses)
    assert learnt.out.startswith(f"{damaged.scans} scans of 1 log")


@pytest.mark.parametrize("damaged", [*DAMAGED, *FLIPPED], ids=lambda damaged: damaged.path)
def test_strict_refuses_damage(shared_logs: Path, tmp_path: Path, damaged: Damaged) -> None:
    """--strict: exit code 1, the damage named, no results."""
    outcome = mpap("learn", shared_logs / damaged.path, "--strict", "-o", tmp_path / "out")

    assert outcome.code == 1
    assert damaged.words in outcome.err.splitlines()[-1]
    assert not (tmp_path / "out").exists()
