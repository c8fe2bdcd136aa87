"""Recorded logs: what is in them by an independent count, and what is left of damaged ones."""

from collections import Counter
from pathlib import Path

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import open_log

pytestmark = pytest.mark.shared

# log: container, messages of all topics
WHOLE = {
    "real/neato-2018-a3.bag": ("bag", 2079),
    "gazebo/gazebo-g1.bag": ("bag", 32_853),
    "gazebo/turtlebot3-scan-only.bag": ("bag", 538),
    "real/neato-2024-e5": ("rosbag2/sqlite3", 1840),
    "converted/neato-2024-e1-mcap": ("rosbag2/mcap", 2546),
    "converted/neato-2024-e1.mcap": ("mcap", 2546),
    "converted/neato-2018-a2-json.mcap": ("mcap", 337),
    "traps/cmd-vel-only.bag": ("bag", 1525),
    "traps/two-scan-topics.bag": ("bag", 661),
    "traps/mcap-no-scan": ("rosbag2/mcap", 6578),
    "traps/example.bag": ("bag", 8647),
    "traps/example-bz2.bag": ("bag", 8647),
    "traps/example-lz4.bag": ("bag", 8647),
    "traps/split-5-files-sqlite3": ("rosbag2/sqlite3", 6074),
    "traps/split-5-files-mcap": ("rosbag2/mcap", 6074),
    "traps/made-empty-rosbag2": ("rosbag2/sqlite3", 0),
    "traps/no-messages.bag": ("bag", 0),
}
# log: kind of damage, messages of /scan, /bump and all topics that are read
DAMAGED = {
    "cut70.bag": ("truncated", 102, 141, 1478),
    "unindexed.bag": ("unindexed", 145, 194, 2079),
    "killed.bag.active": ("truncated", 144, 193, 2066),
    "cut70.mcap": ("truncated", 206, 216, 1864),
    "flipped-byte-crc.mcap": ("chunk", 271, 292, 2462),
    "flipped-byte-zstd.mcap": ("chunk", 271, 292, 2461),
    "cut70.db3": ("database", 126, 134, 1290),
    "cut70-db3": ("database", 126, 134, 1290),
}
# log: what the warning says, messages of all topics
WARNED = {
    "made-stale-metadata": ("which is not there; reading renamed_0.db3", 1545),
    "made-no-metadata": ("metadata.yaml is missing", 1545),
    "stale-metadata": ("which is not there; reading wall_follow.db3", 0),
}
REFUSED = {
    "damaged/zero.bag": "the file is empty",
    "damaged/zero.mcap": "the file is empty",
    "damaged/zero.db3": "the file is empty",
    "damaged/zero-db3-folder": "the file is empty",
    "traps/git-lfs-pointer.bag": "git lfs pull",
    "traps/git-lfs-pointer.mcap": "git lfs pull",
}


@pytest.mark.parametrize("name", WHOLE)
def test_whole_log(shared_logs: Path, name: str) -> None:
    """Every message comes once, in time order, and the index counts right."""
    container, n_messages = WHOLE[name]

    with open_log(shared_logs / name, strict=True) as reader:
        messages = list(reader.messages([topic.name for topic in reader.topics]))

    stamps = [message.stamp_ns for message in messages]
    assert (reader.container, len(messages)) == (container, n_messages)
    assert reader.n_messages == sum(topic.n_messages for topic in reader.topics) == n_messages
    assert stamps == sorted(stamps)
    assert reader.start_ns == min(stamps, default=0)
    assert reader.end_ns == max(stamps, default=0)
    assert reader.warnings == []


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_log(shared_logs: Path, name: str) -> None:
    """As many messages as an independent scan of the bytes found, less broken chunks."""
    kind, n_scans, n_bumps, n_messages = DAMAGED[name]

    with open_log(shared_logs / "damaged" / name) as reader:
        counts = Counter(m.topic.name for m in reader.messages([t.name for t in reader.topics]))

    assert (counts["/scan"], counts["/bump"]) == (n_scans, n_bumps)
    assert counts.total() == n_messages
    assert [damage.kind for damage in reader.damage] == [kind]


@pytest.mark.parametrize("name", WARNED)
def test_folder_with_wrong_metadata(shared_logs: Path, name: str) -> None:
    """What is there is read, with one warning."""
    warning, n_messages = WARNED[name]

    with open_log(shared_logs / "traps" / name) as reader:
        found = list(reader.messages([topic.name for topic in reader.topics]))

    assert len(found) == n_messages
    assert len(reader.warnings) == 1
    assert warning in reader.warnings[0]


@pytest.mark.parametrize("name", REFUSED)
def test_file_that_is_no_log(shared_logs: Path, name: str) -> None:
    """One line says why."""
    with pytest.raises(LogError, match=REFUSED[name]):
        open_log(shared_logs / name)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("real/neato-2018-a1.bag", "converted/neato-2018-a1-ros1profile.mcap"),
        ("real/neato-2024-e1", "converted/neato-2024-e1.mcap"),
        ("converted/neato-2024-e1-mcap", "converted/neato-2024-e1.mcap"),
        ("traps/example.bag", "traps/example-bz2.bag"),
        ("traps/example.bag", "traps/example-lz4.bag"),
        ("traps/split-5-files-sqlite3", "traps/split-5-files-mcap"),
    ],
)
def test_containers_hold_the_same(shared_logs: Path, one: str, other: str) -> None:
    """Payload by payload, for the topics that both have."""
    contents = []

    for name in (one, other):
        with open_log(shared_logs / name) as reader:
            contents.append(
                {
                    topic.name: [m.payload for m in reader.messages([topic.name])]
                    for topic in reader.topics
                }
            )

    shared = contents[0].keys() & contents[1].keys()
    assert len(shared) > 1
    assert {name: contents[0][name] for name in shared} == {
        name: contents[1][name] for name in shared
    }
