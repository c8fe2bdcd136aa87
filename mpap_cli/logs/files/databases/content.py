"""What a rosbag2 database says about itself, beside its messages."""

import sqlite3
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.files.databases.small_tables import SmallTables
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.raw import Topic, ros2_name

BROKEN_INDEX = "its index of stamps is broken"
# The index has stamps of its own, which may differ from those of the rows if a bit flips.
BY_STAMP = "messages AS i LEFT JOIN messages AS m NOT INDEXED ON m.rowid = i.rowid"

BROKEN_DATABASE = (sqlite3.Error, UnicodeDecodeError, OverflowError)
"""What reading a broken database may raise."""


@dataclass(frozen=True, slots=True)
class Content:
    """What a database says about itself."""

    channels: dict[int, Topic]
    n_messages: int
    start_ns: int
    end_ns: int
    ros_distro: str


class Database(ABC):
    """A .db3 file, whole or broken; a `LogFile`."""

    @abstractmethod
    def channel_bytes(self) -> Mapping[int, int]:
        """Return how large the payloads of each channel are; of large ones nothing is read."""


def connect(path: Path) -> sqlite3.Connection:
    """Open a database for reading, as a file that nobody else writes."""
    uri = f"{path.resolve().as_uri()}?mode=ro&immutable=1"
    database = sqlite3.connect(uri, uri=True)
    database.text_factory = lambda text: text.decode(errors="replace")
    return database


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
    counts = {}
    if count:
        query = "SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id"
        counts = dict(database.execute(query).fetchall())
    tables = _read_tables(database, columns)
    channels = describe_topics(tables, counts)
    stamps, numbers = _first_and_last(database, "timestamp"), _first_and_last(database, "id")
    if stamps is None or numbers is None:
        return Content(channels, 0, 0, 0, tables.ros_distro)
    n_messages = sum(counts.values()) if count else numbers[1] - numbers[0] + 1
    return Content(channels, n_messages, *stamps, tables.ros_distro)


def _read_tables(database: sqlite3.Connection, columns: Mapping[str, set[str]]) -> SmallTables:
    """Read topics, definitions and distribution, as far as there are such tables."""
    topics = {
        number: (name, msgtype, str(encoding))
        for number, name, msgtype, encoding in database.execute(
            "SELECT id, name, type, serialization_format FROM topics ORDER BY id"
        )
        if isinstance(number, int) and isinstance(name, str) and isinstance(msgtype, str)
    }
    definitions = {}
    if columns["message_definitions"]:
        query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        definitions = {
            msgtype: (form, text)
            for msgtype, form, text in database.execute(query)
            if isinstance(form, str) and isinstance(text, str)
        }
    row = None
    if "ros_distro" in columns["schema"]:
        row = database.execute("SELECT ros_distro FROM schema").fetchone()
    return SmallTables(topics, definitions, str(row[0]) if row else "")


def describe_topics(tables: SmallTables, counts: Mapping[int, int]) -> dict[int, Topic]:
    """Return the topics by id, with how many messages each has."""
    channels = {}
    for number, (name, msgtype, encoding) in tables.topics.items():
        form, text = tables.definitions.get(msgtype, ("", ""))
        form = form if form in {"ros2msg", "ros2idl"} and text else ""
        n_messages = counts.get(number, 0)
        text = text if form else ""
        channels[number] = Topic(name, ros2_name(msgtype), encoding, n_messages, text, form)
    return channels


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
