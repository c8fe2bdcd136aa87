"""A broken rosbag2 database: what its pages still hold, whatever became of its trees."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunked.chunks import BrokenRecordError
from mpap_cli.logs.files.databases.content import Content, Database, describe_topics
from mpap_cli.logs.files.databases.saved_rows import SavedRows, find_saved_rows
from mpap_cli.logs.files.databases.small_tables import read_small_tables
from mpap_cli.logs.files.runs import MAX_STAMP_NS, messages_in
from mpap_cli.logs.raw import Damage, RawMessage, Reading, RunGroup, Topic


class SavedDatabase(Database):
    """The whole messages of a broken .db3 file, read where they lie; a `LogFile`."""

    def __init__(self, path: Path, content: Content, rows: SavedRows) -> None:
        self.path = path
        self.channels: Mapping[int, Topic] = content.channels
        self.n_messages = content.n_messages
        self.start_ns = content.start_ns
        self.end_ns = content.end_ns
        self.ros_distro = content.ros_distro
        self._rows = rows

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
        return self._rows.groups(wanted, first, after)

    def channel_bytes(self) -> Mapping[int, int]:
        """Return how large the payloads of each channel are."""
        return self._rows.payload_bytes


def save_database(
    path: Path,
    source: Path,
    reading: Reading,
    problem: str,
    channels: Mapping[int, Topic] | None = None,
) -> SavedDatabase:
    """Find every whole message in a broken database, and say so.

    Parameters
    ----------
    path, source : Path
        The log, and the file to read: the log, or a copy with what stood beside it.
    reading : Reading
        Gets the damage.
    problem : str
        What is broken.
    channels : mapping of int to Topic, optional
        The topics where they are known; else they are looked for.

    Raises
    ------
    LogError
        If no topic is found, or the log is read strictly.
    """
    try:
        found = find_saved_rows(source)
    except BrokenRecordError as err:
        raise LogError(_beyond_repair(path, err)) from err
    distro, counts = "", found.counts
    if channels is None:
        tables = read_small_tables(source, found.layout, found.others)
        channels, distro = describe_topics(tables, counts), tables.ros_distro
    if not channels:
        raise LogError(_beyond_repair(path, problem))
    rows = found.only(channels)
    stamps_ns = rows.stamps_ns
    n_messages, n_lost = stamps_ns.size, found.stamps_ns.size - stamps_ns.size
    start_ns, end_ns = (int(stamps_ns[0]), int(stamps_ns[-1])) if n_messages else (0, 0)
    text = f"{path.name}: {problem}; the {n_messages:,} whole messages found are used"
    reading.add_damage(Damage(path.name, "database", n_messages, text))
    if n_lost:
        text = f"{path.name}: {n_lost:,} messages left out, their rows are broken"
        reading.add_damage(Damage(path.name, "message", n_lost, text))
    return SavedDatabase(path, Content(dict(channels), n_messages, start_ns, end_ns, distro), rows)


def _beyond_repair(path: Path, problem: object) -> str:
    """Say that messages alone cannot be told apart."""
    return f"{path.name}: the database is broken ({problem}) and its list of topics is lost"
