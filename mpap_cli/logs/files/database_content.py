"""What a rosbag2 database says about itself, beside its messages."""

import sqlite3
from dataclasses import dataclass

from mpap_cli.errors import LogError
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.raw import Topic, ros2_name

BROKEN_INDEX = "its index of stamps is broken"
# The index has stamps of its own, which may differ from those of the rows if a bit flips.
BY_STAMP = "messages AS i LEFT JOIN messages AS m NOT INDEXED ON m.rowid = i.rowid"


@dataclass(frozen=True, slots=True)
class Content:
    """What a database says about itself."""

    channels: dict[int, Topic]
    n_messages: int
    start_ns: int
    end_ns: int
    ros_distro: str


def read_content(database: sqlite3.Connection, name: str, *, count: bool) -> Content:
    """Read everything but the messages; ``count`` those, topic by topic.

    Raises
    ------
    LogError
        If it is not a database of rosbag2.
    """
    columns = {
        table: {row[1] for row in database.execute(f"PRAGMA table_info({table})")}
        for table in ("topics", "messages", "message_definitions", "schema")
    }
    if not {"topic_id", "timestamp", "data"} <= columns["messages"] or not columns["topics"]:
        msg = f"{name}: an SQLite database without the tables of rosbag2 (topics, messages)"
        raise LogError(msg)
    definitions = {}
    if columns["message_definitions"]:
        query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        definitions = {row[0]: (row[1], row[2]) for row in database.execute(query)}
    counts = {}
    if count:
        query = "SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id"
        counts = dict(database.execute(query).fetchall())
    channels = {}
    for number, topic, msgtype, encoding in database.execute(
        "SELECT id, name, type, serialization_format FROM topics ORDER BY id"
    ):
        if not (isinstance(number, int) and isinstance(topic, str) and isinstance(msgtype, str)):
            continue
        form, text = definitions.get(msgtype, ("", ""))
        form = form if form in {"ros2msg", "ros2idl"} and text else ""
        n_messages = counts.get(number, 0)
        channels[number] = Topic(
            topic, ros2_name(msgtype), str(encoding), n_messages, text if form else "", form
        )
    stamps, numbers = _first_and_last(database, "timestamp"), _first_and_last(database, "id")
    distro = ""
    if "ros_distro" in columns["schema"]:
        row = database.execute("SELECT ros_distro FROM schema").fetchone()
        distro = str(row[0]) if row else ""
    if stamps is None or numbers is None:
        return Content(channels, 0, 0, 0, distro)
    n_messages = sum(counts.values()) if count else numbers[1] - numbers[0] + 1
    return Content(channels, n_messages, *stamps, distro)


def _first_and_last(database: sqlite3.Connection, column: str) -> tuple[int, int] | None:
    """Return the smallest and the largest value of a column of messages; None if there is none."""
    found = [
        database.execute(
            f"SELECT i.{column}, m.{column} FROM {BY_STAMP} "  # noqa: S608
            f"WHERE typeof(i.{column}) = 'integer' "
            f"AND i.{column} < {MAX_STAMP_NS} ORDER BY i.{column} {order} LIMIT 1"
        ).fetchone()
        for order in ("ASC", "DESC")
    ]
    if not (found[0] and found[1]):
        return None
    if any(indexed != own for indexed, own in found):
        raise sqlite3.DatabaseError(BROKEN_INDEX)
    return found[0][0], found[1][0]
