"""Records of a log before anything in it is understood: topics, payloads, damage."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Protocol, Self

from mpap_cli.errors import LogError
from mpap_cli.logs.remote.paths import LogPath
from mpap_cli.logs.scratch import ScratchFolder
from mpap_cli.observations import IntArray

TopicKey = tuple[str, str]  # name and type of a topic; both empty where it is not known


@dataclass(frozen=True, slots=True)
class Topic:
    """What a log says about one topic.

    ``msgtype`` has the form ``pkg/msg/Type``, or is the name of the schema as it stands
    (``foxglove.LaserScan``); ``encoding`` is ``ros1``, ``cdr``, ``json``, ``protobuf`` or
    another word, which is listed but not decoded; ``definition`` is the text of the message
    definition in ``definition_format`` (``ros1msg``, ``ros2msg``, ``ros2idl``, ``jsonschema``, or
    ``protobuf``, a FileDescriptorSet in base64), both empty where the log does not hold it.
    """

    name: str
    msgtype: str
    encoding: str
    n_messages: int
    definition: str
    definition_format: str


class RawMessage(NamedTuple):
    """One message as recorded; ``stamp_ns`` is log time. Named tuples are quick to make."""

    topic: Topic
    stamp_ns: int
    payload: bytes


@dataclass(frozen=True, slots=True, eq=False)
class RawRun:
    """Messages of one topic that follow one another in time, in one piece of memory.

    ``stamps_ns`` (n,) is log time, not decreasing; the payloads lie in ``records``:
    ``sizes`` (n,) bytes from ``starts`` (n,). All three are int64, and n is above 0.
    """

    topic: Topic
    stamps_ns: IntArray
    records: bytes
    starts: IntArray
    sizes: IntArray

    def __len__(self) -> int:
        return self.stamps_ns.size

    def payload(self, number: int) -> bytes:
        """Return one payload."""
        start = self.starts[number]
        return self.records[start : start + self.sizes[number]]

    def rows(self, rows: slice | IntArray) -> "RawRun":
        """Return some of the messages, which share the memory."""
        stamps_ns, starts, sizes = self.stamps_ns[rows], self.starts[rows], self.sizes[rows]
        return RawRun(self.topic, stamps_ns, self.records, starts, sizes)


class RunGroup(NamedTuple):
    """A stretch of a log before ``until_ns``; the runs of a topic follow one another in time."""

    until_ns: int
    runs: Sequence[RawRun]


@dataclass(frozen=True, slots=True)
class Damage:
    """What is broken in one file; ``path`` is its base name.

    By ``kind``, ``count`` counts

    - ``unindexed``, ``truncated``, ``index``, ``database``: whole messages found
      (the file has no index, ends early, has a broken index, is a broken database);
    - ``chunk``: chunks left out (all their messages, or those behind the broken place);
    - ``message``, ``file``: messages, or files, left out;
    - ``packed``: bytes unpacked before a packed file breaks off.

    ``text`` is one sentence; ``lost`` counts what is missing of `Topic.n_messages`, if known.
    """

    path: str
    kind: str
    count: int
    text: str
    lost: Mapping[TopicKey, int] = field(default_factory=dict)


class PayloadError(LogError):
    """One message does not fit the definition of its type; the others may."""


@dataclass(slots=True)
class Reading:
    """What one open log collects while it is read, and the folder for unpacked files.

    ``damage`` has one record per file and kind; ``strict`` makes an error of the first.
    """

    strict: bool = False
    damage: list[Damage] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    _folder: ScratchFolder | None = None

    def add_damage(self, damage: Damage) -> None:
        """Note a damage in place of what was known about this file and kind.

        Raises
        ------
        LogError
            If the log is read strictly.
        """
        if self.strict:
            msg = f"{damage.text}; without --strict the rest is used"
            raise LogError(msg)
        kept = [d for d in self.damage if (d.path, d.kind) != (damage.path, damage.kind)]
        self.damage[:] = [*kept, damage]

    def warn(self, text: str) -> None:
        """Note a warning, once."""
        if text not in self.warnings:
            self.warnings.append(text)

    def scratch(self) -> Path:
        """Return a private folder that :meth:`close` removes.

        Raises
        ------
        LogError
            If no temporary folder can be made.
        """
        if self._folder is None:
            try:
                self._folder = ScratchFolder("mpap-log-")
            except OSError as err:
                msg = f"temporary folder: {err.strerror}; name one with room in TMPDIR"
                raise LogError(msg) from err
        return self._folder.path

    def close(self) -> None:
        """Remove the private folder."""
        if self._folder is not None:
            self._folder.remove()
            self._folder = None


class LogFile(Protocol):
    """One file of a log, whatever its container.

    ``channels`` maps the file's own ids to topics (several ids may share a topic); counts
    and stamps are those of all messages; ``ros_distro`` is empty where it is not recorded.
    No file handle stays open between two calls.
    """

    channels: Mapping[int, Topic]
    n_messages: int
    start_ns: int
    end_ns: int
    ros_distro: str

    @property
    def path(self) -> LogPath:
        """Where the file lies."""

    def messages(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RawMessage]:
        """Yield the messages of the wanted channels in log time order, start <= t < end."""
        ...

    def runs(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RunGroup]:
        """Yield the same messages in runs."""
        ...


class LogReader(Protocol):
    """One log, of one file or several, as one stream in time order.

    ``container`` is ``bag``, ``sqlite3``, ``mcap``, ``rosbag2/sqlite3`` or ``rosbag2/mcap``;
    ``start_ns`` and ``end_ns`` are the log times of the first and the last message (both 0
    where there is none); ``damage`` grows while messages are read.
    """

    path: LogPath
    container: str
    topics: tuple[Topic, ...]
    n_messages: int
    start_ns: int
    end_ns: int
    damage: list[Damage]
    warnings: list[str]

    def messages(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[RawMessage]:
        """Yield the messages of the topics so named in log time order, start <= t < end."""
        ...

    def runs(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[RunGroup]:
        """Yield the same messages in runs."""
        ...

    def decode(self, message: RawMessage) -> object:
        """Return the fields of a message as attributes; of JSON and protobuf a mapping."""
        ...

    def topic_bytes(self) -> Mapping[TopicKey, int] | None:
        """Return how large the payloads of each topic are; None where no index tells."""
        ...

    def undefined_types(self) -> tuple[str, ...]:
        """Return the types of messages for which no definition is at hand, sorted."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...


def ros2_name(msgtype: str) -> str:
    """Return a type's name in its ROS 2 form.

    >>> ros2_name("sensor_msgs/LaserScan"), ros2_name("foxglove.LaserScan")
    ('sensor_msgs/msg/LaserScan', 'foxglove.LaserScan')
    """
    package, _, name = msgtype.partition("/")
    return f"{package}/msg/{name}" if name and "/" not in name else msgtype
