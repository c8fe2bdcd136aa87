"""Broken databases: rows that are no messages, and tables without the schema."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.files.databases.sqlite import open_sqlite
from mpap_cli.logs.raw import Reading
from mpap_cli.logs.reader import open_log
from tests.logs.files.databases.broken_rows import PAGE_BYTES, ROWS, STAMPS
from tests.logs.rows import stamps


def test_row_that_is_no_message(database: Path) -> None:
    """A payload that became a text, or a topic that does not exist: left out and counted."""
    with closing(sqlite3.connect(database)) as opened:
        opened.execute("UPDATE messages SET data = 'text' WHERE id = 3")
        opened.execute("UPDATE messages SET topic_id = 77 WHERE id = 5")
        opened.commit()

    with open_log(database) as reader:
        found, again = stamps(reader), stamps(reader)

    assert found == again == [stamp for stamp in STAMPS if stamp not in {STAMPS[2], STAMPS[4]}]
    assert [(damage.kind, damage.count) for damage in reader.damage] == [("message", 2)]
    with (
        open_log(database, strict=True) as reader,
        pytest.raises(LogError, match="rows are broken"),
    ):
        stamps(reader)


def test_topics_of_a_database_without_schema(database: Path) -> None:
    """They lie in a page of their own, as messages do."""
    content = bytearray(database.read_bytes())
    content[100:PAGE_BYTES] = b"\xff" * (PAGE_BYTES - 100)
    database.write_bytes(content)

    with open_log(database) as reader:
        found = stamps(reader)
        topics = {topic.name: topic.msgtype for topic in reader.topics}

    assert found == STAMPS
    assert topics == dict.fromkeys(("/left", "/right"), "std_msgs/msg/String")


def test_definitions_of_a_database_without_schema(database: Path) -> None:
    """They may be longer than a page; the first that defines a type is taken."""
    long = "string data\n" + "".join(f"# {number} of many words\n" for number in range(1_000))
    kinds = "std_msgs/msg/String"
    with closing(sqlite3.connect(database)) as opened, opened:
        opened.execute("DROP TABLE IF EXISTS message_definitions")
        opened.execute("DROP TABLE IF EXISTS schema")
        opened.executescript(
            "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
            "INSERT INTO schema VALUES (4, 'jazzy');"
            "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type, encoding,"
            "encoded_message_definition, type_description_hash);"
        )
        opened.execute(
            "INSERT INTO message_definitions VALUES (1, ?, 'ros2msg', ?, 'RIHS01_0')", (kinds, long)
        )
    content = bytearray(database.read_bytes())
    content[100:PAGE_BYTES] = b"\xff" * (PAGE_BYTES - 100)
    database.write_bytes(content)

    file = open_sqlite(database, Reading())
    with open_log(database) as reader:
        sizes = reader.topic_bytes()
        n_bytes = sum(len(message.payload) for message in reader.messages(["/left", "/right"]))

    topics = {topic.name: topic for topic in file.channels.values()}
    assert file.ros_distro == "jazzy"
    assert topics["/left"].definition == topics["/right"].definition == long
    assert topics["/left"].definition_format == "ros2msg"
    assert sizes is not None
    assert sum(sizes.values()) == n_bytes


def test_broken_database_in_the_middle_of_two_readings(database: Path) -> None:
    """What one reading found out holds for the other, and for sizes."""
    content = bytearray(database.read_bytes())
    leaves = [p for p in range(PAGE_BYTES, len(content), PAGE_BYTES) if content[p] == 0x0D]
    content[leaves[-1] : leaves[-1] + 100] = b"\xff" * 100
    database.write_bytes(content)

    with open_log(database) as reader:
        one = reader.messages(["/left", "/right"])
        first = next(one).stamp_ns
        found = stamps(reader)
        rest = [first, *(message.stamp_ns for message in one)]
        in_runs = [
            int(stamp)
            for group in reader.runs(["/left", "/right"])
            for run in group.runs
            for stamp in run.stamps_ns
        ]

    assert found == rest == sorted(in_runs)
    assert 200 < len(found) < len(ROWS)
