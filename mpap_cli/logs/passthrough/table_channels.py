"""How rosbag2 databases describe their topics, read as it stands."""

from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple, cast

from mpap_cli.logs.files.databases.content import BROKEN_DATABASE, connect
from mpap_cli.logs.files.databases.sqlite import SqliteFile
from mpap_cli.logs.passthrough.records import TableChannel
from mpap_cli.logs.raw import LogFile, Topic

TABLES: Mapping[str, tuple[str, ...]] = {
    "schema": ("schema_version", "ros_distro"),
    "topics": (
        "id",
        "name",
        "type",
        "serialization_format",
        "offered_qos_profiles",
        "type_description_hash",
    ),
    "message_definitions": (
        "topic_type",
        "encoding",
        "encoded_message_definition",
        "type_description_hash",
    ),
}
"""Columns that are copied of each table, beside the messages."""


class Table(NamedTuple):
    """Those columns of a table that are copied, and its rows."""

    columns: tuple[str, ...]
    rows: list[dict[str, Any]]


def read_tables(file: LogFile) -> dict[str, Table]:
    """Return the small tables of a database; none of those that cannot be read."""
    # a database lies on this machine, or its copy does
    path = file.database if isinstance(file, SqliteFile) else cast("Path", file.path)
    found: dict[str, Table] = {}
    for table, columns in TABLES.items():
        try:
            with closing(connect(path)) as database:
                there = {row[1] for row in database.execute(f"PRAGMA table_info({table})")}
                names = [name for name in columns if name in there]
                query = f"SELECT {','.join(names)} FROM {table}"  # noqa: S608
                rows = database.execute(query).fetchall() if names else []
        except BROKEN_DATABASE:
            continue
        if names:
            found[table] = Table(tuple(names), [dict(zip(names, r, strict=True)) for r in rows])
    return found


def table_channels(file: LogFile, tables: Mapping[str, Table]) -> dict[int, TableChannel]:
    """Return the topics of a database by id, with the definitions of their types."""
    none = Table((), [])
    described = tables.get("message_definitions", none)
    definitions = {str(row["topic_type"]): row for row in described.rows}
    told = {row["id"]: row for row in tables.get("topics", none).rows}
    return {
        number: TableChannel(
            _texts(told[number]) if number in told else _of_topic(topic),
            _texts(definitions.get(topic.msgtype, {})),
        )
        for number, topic in file.channels.items()
    }


def _texts(row: Mapping[str, Any]) -> dict[str, str]:
    """Return the cells of a row but its id as texts."""
    return {name: "" if cell is None else str(cell) for name, cell in row.items() if name != "id"}


def _of_topic(topic: Topic) -> dict[str, str]:
    """Describe a topic whose row is lost."""
    return {
        "name": topic.name,
        "type": topic.msgtype,
        "serialization_format": topic.encoding,
        "offered_qos_profiles": "",
    }
