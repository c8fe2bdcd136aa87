"""The SQLite files of rosbag2, read-only; broken ones through a repaired copy."""

import shutil
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.files.runs import MAX_STAMP_NS, group_messages
from mpap_cli.logs.files.salvage_database import BROKEN_DATABASE, connect, salvage_database
from mpap_cli.logs.raw import Damage, RawMessage, Reading, RunGroup, Topic, ros2_name

UNFINISHED = ("-wal", "-journal")
_BLOCK_ROWS = 16  # a row may be an image of a megabyte
# One flipped bit makes a blob a text or a stamp a float.
_SOUND = "typeof(data) = 'blob' AND typeof(timestamp) = 'integer'"


@dataclass(frozen=True, slots=True)
class _Content:
    """What a database says about itself."""

    channels: dict[int, Topic]
    n_messages: int
    start_ns: int
    end_ns: int
    ros_distro: str


class SqliteFile:
    """One .db3 file of rosbag2; ``n_messages`` is exact even where topics are not counted."""

    def __init__(self, path: Path, content: _Content, database: Path, reading: Reading) -> None:
        self.path = path
        self.channels: Mapping[int, Topic] = content.channels
        self.n_messages = content.n_messages
        self.start_ns = content.start_ns
        self.end_ns = content.end_ns
        self.ros_distro = content.ros_distro
        self._database = database
        self._reading = reading

    def messages(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RawMessage]:
        """Yield the messages of the wanted channels in log time order, start <= t < end."""
        first = -MAX_STAMP_NS if start_ns is None else start_ns
        after = MAX_STAMP_NS if end_ns is None else end_ns
        n_same = 0
        try:
            for block in self._select(wanted, first, after):
                _require_order(block, first)
                yield from block
                last = block[-1].stamp_ns
                n_same = (n_same if last == first else 0) + sum(m.stamp_ns == last for m in block)
                first = last
        except BROKEN_DATABASE as err:
            self._repair(err)
            rest = chain.from_iterable(self._select(wanted, first, after))
            yield from islice(rest, n_same, None)

    def runs(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RunGroup]:
        """Yield the same messages in runs."""
        yield from group_messages(self.messages(wanted, start_ns, end_ns))

    def _select(
        self, wanted: Mapping[int, Topic], first: int, after: int
    ) -> Iterator[list[RawMessage]]:
        """Yield messages in blocks from the database as it is now."""
        query = (
            f"SELECT topic_id, timestamp, data FROM messages "  # noqa: S608  # numbers only
            f"WHERE timestamp >= ? AND timestamp < ? AND {_SOUND} "
            f"AND topic_id IN ({','.join(str(int(number)) for number in wanted)}) "
            f"ORDER BY timestamp, id"
        )
        with closing(connect(self._database)) as database:
            rows = database.execute(query, (first, after))
            while block := rows.fetchmany(_BLOCK_ROWS):
                yield [RawMessage(wanted[number], stamp, data) for number, stamp, data in block]

    def _repair(self, err: Exception) -> None:
        """Go over to a repaired copy, and say so."""
        self._database, found = _repaired(self.path, self._reading, str(err))
        self.n_messages = found.n_messages


def _require_order(block: Sequence[RawMessage], first: int) -> None:
    """Refuse what a broken index gives: stamps that fall."""
    stamps = [first, *(message.stamp_ns for message in block)]
    if stamps != sorted(stamps):
        msg = "its index of stamps is broken"
        raise sqlite3.DatabaseError(msg)


def open_sqlite(path: Path, reading: Reading, *, count: bool = True) -> SqliteFile:
    """Open a .db3 file.

    Parameters
    ----------
    path : Path
        File that begins with the magic of SQLite.
    reading : Reading
        Gets damage and warnings, and lends a folder for copies.
    count : bool
        Count the messages of each topic, which reads the whole table. Otherwise the topics
        count 0, and the file counts its ids.

    Returns
    -------
    SqliteFile
        Its messages, mostly of encoding ``cdr``.

    Raises
    ------
    LogError
        If it is not a database of rosbag2, or cannot be repaired, or is damaged and read
        strictly.
    """
    try:
        database = _settled(path, reading)
        with closing(connect(database)) as opened:
            return SqliteFile(path, _read_content(opened, path.name, count), database, reading)
    except BROKEN_DATABASE as err:
        database, content = _repaired(path, reading, str(err))
        return SqliteFile(path, content, database, reading)


def _settled(path: Path, reading: Reading) -> Path:
    """Return the database, or a copy in which what stands beside it is worked in.

    A recorder that dies leaves messages in the -wal, or half a change to undo in the -journal.
    """
    beside = [path.with_name(path.name + ending) for ending in UNFINISHED]
    beside = [other for other in beside if other.is_file() and other.stat().st_size]
    if not beside:
        return path
    folder = reading.scratch()
    try:
        for source in (path, *beside):
            shutil.copyfile(source, folder / source.name)
    except OSError as err:
        msg = f"{path.name}: cannot copy it for reading ({err.strerror}); name a folder in TMPDIR"
        raise LogError(msg) from err
    copy = folder / path.name
    with closing(sqlite3.connect(copy)) as opened:
        opened.execute("PRAGMA journal_mode = DELETE").fetchall()
        opened.execute("SELECT COUNT(*) FROM sqlite_master").fetchall()
    names = ", ".join(other.name for other in beside)
    reading.warn(f"{path.name}: recording not finished, read together with {names}")
    return copy


def _repaired(path: Path, reading: Reading, problem: str) -> tuple[Path, _Content]:
    """Salvage a broken database, and say so."""
    database = salvage_database(path, reading.scratch())
    with closing(connect(database)) as opened:
        content = _read_content(opened, path.name, count=True)
    text = f"{path.name}: {problem}; the {content.n_messages:,} whole messages found are used"
    reading.add_damage(Damage(path.name, "database", content.n_messages, text))
    return database, content


def _read_content(database: sqlite3.Connection, name: str, count: bool) -> _Content:
    """Read everything but the messages."""
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
    stamps, numbers = _extremes(database, "timestamp"), _extremes(database, "id")
    distro = ""
    if "ros_distro" in columns["schema"]:
        row = database.execute("SELECT ros_distro FROM schema").fetchone()
        distro = str(row[0]) if row else ""
    if stamps is None or numbers is None:
        return _Content(channels, 0, 0, 0, distro)
    n_messages = sum(counts.values()) if count else numbers[1] - numbers[0] + 1
    return _Content(channels, n_messages, *stamps, distro)


def _extremes(database: sqlite3.Connection, column: str) -> tuple[int, int] | None:
    """Return the smallest and the largest value of a column of messages; None if there is none."""
    found = [
        database.execute(
            f"SELECT {column} FROM messages WHERE typeof({column}) = 'integer' "  # noqa: S608
            f"AND {column} < {MAX_STAMP_NS} ORDER BY {column} {order} LIMIT 1"
        ).fetchone()
        for order in ("ASC", "DESC")
    ]
    return (found[0][0], found[1][0]) if found[0] and found[1] else None
