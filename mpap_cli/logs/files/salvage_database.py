"""A broken rosbag2 database: its whole rows are copied into a new one."""

import shutil
import sqlite3
from contextlib import closing, suppress
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunks import BrokenRecordError
from mpap_cli.logs.files.salvage_pages import (
    TopicRow,
    read_sizes,
    rows_in_pages,
    topics_in_pages,
)

BROKEN_DATABASE = (sqlite3.Error, UnicodeDecodeError, OverflowError)
"""What reading a broken database may raise."""

_N_PAGES_AT = 28
_TABLES = """
CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);
CREATE TABLE message_definitions(topic_type, encoding, encoded_message_definition);
CREATE TABLE messages(id INTEGER, topic_id INTEGER, timestamp INTEGER, data BLOB);
CREATE UNIQUE INDEX once ON messages (id, topic_id, timestamp);
"""
_INDEX = "CREATE INDEX timestamp_idx ON messages (timestamp ASC, id)"


def connect(path: Path) -> sqlite3.Connection:
    """Open a database for reading, as a file that nobody else writes."""
    uri = f"{path.resolve().as_uri()}?mode=ro&immutable=1"
    database = sqlite3.connect(uri, uri=True)
    database.text_factory = lambda text: text.decode(errors="replace")
    return database


def salvage_database(path: Path, folder: Path) -> Path:
    """Copy every row that can still be read into a new database.

    Parameters
    ----------
    path : Path
        The broken database; it is not changed.
    folder : Path
        Private folder for the copies.

    Returns
    -------
    Path
        A sound database.

    Raises
    ------
    LogError
        If the list of topics cannot be read, or there is no room for the copies.
    """
    try:
        broken = _with_true_size(path, folder / f"broken-{path.name}")
        saved = folder / f"saved-{path.name}"
        saved.unlink(missing_ok=True)
        with closing(connect(broken)) as source, closing(sqlite3.connect(saved)) as target:
            _copy_rows(path, source, target)
        broken.unlink()
    except (*BROKEN_DATABASE, BrokenRecordError) as err:
        msg = f"{path.name}: the database is broken ({err}) and its list of topics is lost"
        raise LogError(msg) from err
    except OSError as err:
        msg = f"{path.name}: cannot copy it for repair ({err.strerror}); name a folder in TMPDIR"
        raise LogError(msg) from err
    return saved


def _with_true_size(path: Path, copy: Path) -> Path:
    """Copy a database, cut to whole pages, with the number of pages that it really has."""
    shutil.copyfile(path, copy)
    with copy.open("r+b") as stream:
        pages = read_sizes(stream)
        stream.truncate(pages.number * pages.size)
        stream.seek(_N_PAGES_AT)
        stream.write(pages.number.to_bytes(4, "big"))
    return copy


def _copy_rows(path: Path, source: sqlite3.Connection, target: sqlite3.Connection) -> None:
    """Copy topics, definitions and all whole messages."""
    target.executescript(_TABLES)
    topics = _read_topics(path, source)
    target.executemany("INSERT OR IGNORE INTO topics VALUES (?, ?, ?, ?)", topics)
    with suppress(*BROKEN_DATABASE):  # older logs have no such table
        texts = source.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        )
        target.executemany("INSERT INTO message_definitions VALUES (?, ?, ?)", texts.fetchall())
    target.executemany("INSERT OR IGNORE INTO messages VALUES (?, ?, ?, ?)", rows_in_pages(path))
    target.execute(_INDEX)
    target.commit()


def _read_topics(path: Path, source: sqlite3.Connection) -> list[TopicRow]:
    """Read the topics, out of the pages if the database does not give them."""
    try:
        found = source.execute("SELECT id, name, type, serialization_format FROM topics").fetchall()
    except BROKEN_DATABASE as err:
        found = list(topics_in_pages(path))
        if not found:
            msg = str(err)
            raise BrokenRecordError(msg) from err
    return found
