"""Databases of rosbag2: old, foreign, or left by a recorder that died."""

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import open_log
from tests.logs.rows import ROWS, WriteLog, stamps, storage

STAMPS = [row[1] for row in ROWS]


@pytest.mark.parametrize("kind", ["sqlite3-message", "folder-mcap-message"])
def test_packed_message_that_is_broken(write_log: WriteLog, kind: str) -> None:
    """It is left out and counted."""
    path = storage(write_log(kind, ROWS))
    content = path.read_bytes()
    place = content.rindex(b"\x28\xb5\x2f\xfd")
    path.write_bytes(content[:place] + b"\xff" * 4 + content[place + 4 :])

    with open_log(path) as reader:
        found = stamps(reader)

    assert len(found) == len(ROWS) - 1
    assert [(damage.kind, damage.count) for damage in reader.damage] == [("message", 1)]


def test_recording_that_was_not_finished(write_log: WriteLog, tmp_path: Path) -> None:
    """What stands in the -wal is read too, through a copy."""
    source = write_log("sqlite3", ROWS) / "log.db3"
    copy = tmp_path / "crashed.db3"
    with closing(sqlite3.connect(source)) as database:
        database.execute("PRAGMA journal_mode = WAL").fetchall()
        database.execute("INSERT INTO messages VALUES (61, 1, ?, x'00010000')", (10**18 + 60,))
        database.commit()
        for ending in ("", "-wal"):
            shutil.copy(f"{source}{ending}", f"{copy}{ending}")
    before = {path.name for path in tmp_path.iterdir()}

    with open_log(copy) as reader:
        found = stamps(reader)

    assert found == [*STAMPS, 10**18 + 60]
    assert "recording not finished, read together with crashed.db3-wal" in reader.warnings[0]
    assert {path.name for path in tmp_path.iterdir()} == before


def test_database_of_something_else(tmp_path: Path) -> None:
    """SQLite has other uses."""
    path = tmp_path / "log.db3"
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE t (x)")

    with pytest.raises(LogError, match="without the tables of rosbag2"):
        open_log(path)


def test_database_of_the_first_rosbag2(tmp_path: Path) -> None:
    """No definitions, no distribution, types of two words."""
    path = tmp_path / "log.db3"
    with closing(sqlite3.connect(path)) as database:
        database.executescript(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);"
            "INSERT INTO topics VALUES (1, '/bump', 'std_msgs/Bool', 'cdr');"
            "INSERT INTO topics VALUES (NULL, NULL, NULL, NULL);"
            "INSERT INTO messages VALUES (1, 1, 5, x'0001000001');"
            "INSERT INTO messages VALUES (2, 1, 6, 'text');"
            "INSERT INTO messages VALUES (3, 1, 'late', x'0001000001');"
        )

    with open_log(path) as reader:
        messages = list(reader.messages(["/bump"]))
        decoded = reader.decode(messages[0])

    assert reader.topics[0].msgtype == "std_msgs/msg/Bool"
    assert [message.stamp_ns for message in messages] == [5]
    assert vars(decoded)["data"] is True


def test_names_with_signs_of_a_uri(write_log: WriteLog) -> None:
    """A database may be called anything."""
    path = write_log("sqlite3", ROWS) / "log.db3"

    with open_log(path.rename(path.with_name("50%? done#.db3"))) as reader:
        found = stamps(reader)

    assert found == STAMPS


def test_folder_of_a_recording_that_was_not_finished(write_log: WriteLog) -> None:
    """Its metadata.yaml is from before; what stands in the -wal counts."""
    folder = write_log("sqlite3", ROWS)
    with closing(sqlite3.connect(folder / "log.db3")) as database:
        database.execute("PRAGMA journal_mode = WAL").fetchall()
        database.execute("INSERT INTO messages VALUES (61, 1, ?, x'00010000')", (10**18 + 60,))
        database.commit()

        with open_log(folder) as reader:
            found = stamps(reader)

    assert found == [*STAMPS, 10**18 + 60]
    assert sum(topic.n_messages for topic in reader.topics) == reader.n_messages == 61
    assert [text.partition(": ")[2] for text in reader.warnings] == [
        "recording not finished, read together with log.db3-wal",
        "metadata.yaml counts 60 messages, the files hold 61",
    ]
