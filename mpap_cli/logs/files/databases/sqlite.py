"""The SQLite files of rosbag2, read-only; broken ones page by page."""

import shutil
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from mpap_cli.errors import LogError
from mpap_cli.logs.files.databases.content import (
    BROKEN_DATABASE,
    BROKEN_INDEX,
    BY_STAMP,
    Content,
    Database,
    connect,
    read_content,
)
from mpap_cli.logs.files.databases.row_groups import row_groups, runs_of_rows, unsound_rows
from mpap_cli.logs.files.runs import MAX_STAMP_NS, messages_in
from mpap_cli.logs.raw import Damage, LogFile, RawMessage, Reading, RunGroup, Topic

if TYPE_CHECKING:
    from mpap_cli.logs.files.databases.saved_database import SavedDatabase

UNFINISHED = ("-wal", "-journal")
# the same over the rows and over the index of stamps, which holds stamp and id of each row
_CHECKSUM = "COUNT(*), SUM(timestamp >> 32), SUM(timestamp % 1048573 * (1 + id % 1021))"


class SqliteFile(Database):
    """One .db3 file of rosbag2; ``n_messages`` is exact even where topics are not counted."""

    def __init__(self, path: Path, content: Content, database: Path, reading: Reading) -> None:
        self.path = path
        self.channels: Mapping[int, Topic] = content.channels
        self.n_messages = content.n_messages
        self.start_ns = content.start_ns
        self.end_ns = content.end_ns
        self.ros_distro = content.ros_distro
        self._database = database
        self._saved: SavedDatabase | None = None
        self._reading = reading
        self._is_checked = False
        self._lost: set[int] = set()

    @property
    def database(self) -> Path:
        """The file that is read: the log, or a copy that is settled or repaired."""
        return self._database

    def messages(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RawMessage]:
        """Yield the messages of the wanted channels in log time order, start <= t < end."""
        for group in self.runs(wanted, start_ns, end_ns):
            yield from messages_in(group.runs)

    def runs(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RunGroup]:
        """Yield the same messages in runs."""
        first = -MAX_STAMP_NS if start_ns is None else start_ns
        after = MAX_STAMP_NS if end_ns is None else end_ns
        if self._saved is None:
            try:
                self._require_whole_index()
                for group in self._select(wanted, first, after):
                    yield group
                    first = group.until_ns
            except BROKEN_DATABASE as err:
                self._save(err)
        if self._saved is not None:
            yield from self._saved.runs(wanted, first, after)

    def channel_bytes(self) -> Mapping[int, int]:
        """Return how large the payloads of each channel are; of large ones nothing is read."""
        if self._saved is not None:
            return self._saved.channel_bytes()
        # the limit keeps the payloads out of the sorting by topic
        lengths = "SELECT topic_id AS t, LENGTH(data) AS n FROM messages NOT INDEXED LIMIT -1"
        query = f"SELECT t, SUM(n) FROM ({lengths}) GROUP BY t"  # noqa: S608
        try:
            with closing(connect(self.database)) as database:
                sizes = database.execute(query).fetchall()
        except BROKEN_DATABASE as err:
            return self._save(err).channel_bytes()
        return {number: int(size or 0) for number, size in sizes if number in self.channels}

    def _require_whole_index(self) -> None:
        """Refuse an index that does not hold every message; that is looked at once."""
        if self._is_checked:
            return
        with closing(connect(self._database)) as database:
            by_row, by_stamp = (
                database.execute(f"SELECT {_CHECKSUM} FROM messages {how}").fetchone()  # noqa: S608
                for how in ("NOT INDEXED", f"WHERE timestamp >= {-MAX_STAMP_NS}")
            )
        if by_row != by_stamp:
            raise sqlite3.DatabaseError(BROKEN_INDEX)
        self._is_checked = True

    def _select(self, wanted: Mapping[int, Topic], first: int, after: int) -> Iterator[RunGroup]:
        """Yield messages out of the tables; what is broken is counted."""
        numbers, known = (",".join(map(str, some)) for some in (wanted, self.channels))
        query = (
            f"SELECT i.timestamp, m.rowid, m.topic_id, m.timestamp, m.data FROM {BY_STAMP} "  # noqa: S608
            f"WHERE i.timestamp >= ? AND i.timestamp < ? AND (m.topic_id IN ({numbers}) "
            f"OR m.topic_id NOT IN ({known}) OR m.topic_id IS NULL) "
            f"ORDER BY i.timestamp, i.id"
        )
        with closing(connect(self._database)) as database:
            for until_ns, rows in row_groups(database.execute(query, (first, after)), first):
                unsound = unsound_rows(rows, wanted)
                if unsound:
                    self._lose(unsound)
                sound = [row for row in rows if row[1] not in self._lost] if self._lost else rows
                if sound:
                    yield RunGroup(until_ns, runs_of_rows(sound, wanted))

    def _lose(self, numbers: Sequence[int]) -> None:
        """Report rows that are no messages once, however often the log is read."""
        if self._lost.issuperset(numbers):
            return
        self._lost.update(numbers)
        name, n_lost = self.path.name, len(self._lost)
        text = f"{name}: {n_lost:,} messages left out, their rows are broken"
        self._reading.add_damage(Damage(name, "message", n_lost, text))

    def _save(self, err: Exception) -> "SavedDatabase":
        """Go over to what is in the pages, and say so."""
        from mpap_cli.logs.files.databases.saved_database import (  # noqa: PLC0415  # numba is slow
            save_database,
        )

        if self._saved is None:
            self._saved = save_database(
                self.path, self._database, self._reading, str(err), self.channels
            )
            self.n_messages = self._saved.n_messages
        return self._saved


def open_sqlite(path: Path, reading: Reading, *, count: bool = True) -> LogFile:
    """Open a .db3 file.

    Parameters
    ----------
    path : Path
        File that begins with the magic of SQLite.
    reading : Reading
        Gets damage and warnings, and lends a folder for copies.
    count : bool
        Count the messages of each topic, which reads the whole table. Otherwise the topics
        count 0, the file counts its ids, and a broken one is refused.

    Returns
    -------
    LogFile
        Its messages, mostly of encoding ``cdr``.

    Raises
    ------
    LogError
        If it is not a database of rosbag2, or its topics are lost, or it is damaged and read
        strictly.
    """
    database = path
    try:
        database = _settled(path, reading)
        with closing(connect(database)) as opened:
            return SqliteFile(path, read_content(opened, path.name, count=count), database, reading)
    except BROKEN_DATABASE as err:
        if not count:
            msg = f"{path.name}: {err}"
            raise LogError(msg) from err
        from mpap_cli.logs.files.databases.saved_database import (  # noqa: PLC0415  # numba is slow
            save_database,
        )

        return save_database(path, database, reading, str(err))


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
