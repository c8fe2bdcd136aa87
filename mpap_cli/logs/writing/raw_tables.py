"""rosbag2 databases written row by row: topics and definitions as they were."""

import sqlite3
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mpap_cli.logs.passthrough.records import Record, TableChannel

_TYPES = {"id": "INTEGER PRIMARY KEY", "schema_version": "INTEGER PRIMARY KEY"}
_MESSAGES = """
CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,
timestamp INTEGER NOT NULL, data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
"""
_METADATA = """
CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,
metadata TEXT NOT NULL);
"""
_ROWS = 256


class RawTablesWriter:
    """Writes a database with the columns that its origin has; memory does not grow.

    Parameters
    ----------
    path : Path
        File that is not there yet.
    tables : mapping
        Columns of the tables schema, topics and message_definitions.
    schema_row : mapping
        The row of the table schema, by column.
    """

    def __init__(
        self, path: Path, tables: Mapping[str, tuple[str, ...]], schema_row: Mapping[str, Any]
    ) -> None:
        self._database = sqlite3.connect(path, isolation_level=None)
        # nothing else reads it before it is whole, and what is not is thrown away
        self._database.execute("PRAGMA journal_mode = OFF")
        self._database.execute("PRAGMA synchronous = OFF")
        self._tables = {**_PLAIN, **tables}
        for table, columns in self._tables.items():
            own = columns if table == "schema" or "id" in columns else ("id", *columns)
            cells = ",".join(f"{name} {_TYPES.get(name, 'TEXT NOT NULL')}" for name in own)
            self._database.execute(f"CREATE TABLE {table}({cells})")
        self._database.executescript(_MESSAGES + (_METADATA if "schema" in tables else ""))
        self._database.execute("BEGIN")
        if "schema" in tables:
            self._insert("schema", schema_row)
        self._defined: set[str] = set()
        self._n_topics = self._n_messages = 0

    def _insert(self, table: str, cells: Mapping[str, Any]) -> None:
        """Insert one row with the columns that there are; what it does not say is empty."""
        columns = [name for name in self._tables[table] if name != "id"]
        marks = ",".join("?" * len(columns))
        query = f"INSERT INTO {table} ({','.join(columns)}) VALUES ({marks})"  # noqa: S608
        self._database.execute(query, [cells.get(name, "") for name in columns])

    def add_channel(self, stored: TableChannel) -> int:
        """Announce a topic and the definition of its type; return its id."""
        name = stored.topic["type"]
        if stored.definition and name not in self._defined:
            self._insert("message_definitions", stored.definition)
            self._defined.add(name)
        self._insert("topics", stored.topic)
        self._n_topics += 1
        return self._n_topics

    def write(self, number: int, record: Record) -> None:
        """Append a message."""
        query = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)"
        self._database.execute(query, (number, record.stamp_ns, record.payload))
        self._n_messages += 1
        if self._n_messages % _ROWS == 0:
            self._database.execute("COMMIT")
            self._database.execute("BEGIN")

    def close(self) -> None:
        """Bring the last rows to the file."""
        self._database.execute("COMMIT")
        self._database.close()

    def abort(self) -> None:
        """Let go of the file."""
        self._database.close()


_PLAIN: Mapping[str, tuple[str, ...]] = {
    "topics": ("id", "name", "type", "serialization_format", "offered_qos_profiles")
}
