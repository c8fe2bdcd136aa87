"""One log, of one file or several, as one stream of raw messages in time order."""

import heapq
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import chain, islice
from operator import attrgetter
from types import TracebackType
from typing import Self

from mpap_cli.errors import LogError
from mpap_cli.logs.files.definitions_store import DefinitionsStore
from mpap_cli.logs.files.overlapping import overlapping
from mpap_cli.logs.files.ros2 import Folder
from mpap_cli.logs.files.runs import END_NS, group_messages, merge_groups, messages_in
from mpap_cli.logs.files.topic_bytes import bytes_by_topic
from mpap_cli.logs.raw import (
    Damage,
    LogFile,
    RawMessage,
    Reading,
    RunGroup,
    Topic,
    TopicKey,
)
from mpap_cli.logs.remote.paths import LogPath, RemotePath

_CDR = b"\x00"
_PIECE_BYTES, _MOST_PIECES = 1 << 18, 1 << 10  # larger than 256 MiB is no message


class LogStream:
    """One log of one file or several; a :class:`LogReader`."""

    def __init__(
        self, path: LogPath, folder: Folder, reading: Reading, definitions: DefinitionsStore
    ) -> None:
        self.path = path
        self.container = folder.container
        self.damage = reading.damage
        self.warnings = reading.warnings
        self._files = folder.files
        self._reading = reading
        self._definitions = definitions
        topics = join_topics([topic for file in self._files for topic in file.channels.values()])
        if folder.counts:
            topics = {
                key: replace(topic, n_messages=folder.counts.get(key[:2], 0))
                for key, topic in topics.items()
            }
        self._topics = topics
        self.topics = tuple(topics.values())
        filled = [file for file in self._files if file.n_messages]
        self.n_messages = sum(file.n_messages for file in filled)
        self.start_ns = min((file.start_ns for file in filled), default=0)
        self.end_ns = max((file.end_ns for file in filled), default=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._reading.close()
        if isinstance(self.path, RemotePath):
            self.path.tell_traffic()

    def decode(self, message: RawMessage) -> object:
        """Return the fields of a message as attributes; of JSON and protobuf a mapping.

        Raises
        ------
        PayloadError
            If this message does not fit its definition.
        LogError
            If its type has no definition, or its encoding is not read.
        """
        return self._definitions.decode(message)

    def topic_bytes(self) -> Mapping[TopicKey, int] | None:
        """Return how large the payloads of each topic are; None where no index tells."""
        return bytes_by_topic(self._files)

    def undefined_types(self) -> tuple[str, ...]:
        """Return the types of messages for which no definition is at hand, sorted."""
        return self._definitions.undefined_types(self.topics)

    def messages(
        self,
        topics: Collection[str],
        start_ns: int | None = None,
        end_ns: int | None = None,
    ) -> Iterator[RawMessage]:
        """Yield the messages of some topics in log time order.

        Parameters
        ----------
        topics : collection of str
            Names; those that the log does not hold are passed over.
        start_ns, end_ns : int, optional
            Log times; start <= t < end.

        Yields
        ------
        RawMessage
            With the topic as in ``topics``.

        Raises
        ------
        LogError
            If a file cannot be read any more; read strictly, at the first damage.
        """
        with self._foreign_errors_named():
            for part in overlapping(self._files, start_ns, end_ns):
                streams = [
                    self._unpacked(file, self._wanted(file, topics), start_ns, end_ns)
                    for file in part
                ]
                if len(streams) == 1:
                    yield from streams[0]
                else:
                    yield from heapq.merge(*streams, key=attrgetter("stamp_ns"))

    def runs(
        self,
        topics: Collection[str],
        start_ns: int | None = None,
        end_ns: int | None = None,
    ) -> Iterator[RunGroup]:
        """Yield the same messages in runs; parameters and errors are those of `messages`."""
        with self._foreign_errors_named():
            parts = list(overlapping(self._files, start_ns, end_ns))
            ends_ns = [min(file.start_ns for file in part) for part in parts[1:]] + [END_NS]
            for part, end_of_part_ns in zip(parts, ends_ns, strict=False):
                streams = [
                    self._unpacked_runs(file, self._wanted(file, topics), start_ns, end_ns)
                    for file in part
                ]
                for until_ns, runs in merge_groups(streams):
                    yield RunGroup(min(until_ns, end_of_part_ns), runs)

    @contextmanager
    def _foreign_errors_named(self) -> Iterator[None]:
        """Turn an error of the operating system into one that names the log."""
        try:
            yield
        except OSError as err:
            msg = f"{self.path.name}: cannot be read any more ({err.strerror or err})"
            raise LogError(msg) from err

    def _wanted(self, file: LogFile, names: Collection[str]) -> dict[int, Topic]:
        """Return the channels of a file that bear one of the names."""
        return {
            number: self._topics[topic.name, topic.msgtype, topic.encoding]
            for number, topic in file.channels.items()
            if topic.name in names
        }

    def _unpacked(
        self,
        file: LogFile,
        wanted: Mapping[int, Topic],
        start_ns: int | None,
        end_ns: int | None,
    ) -> Iterator[RawMessage]:
        """Yield the messages of one file, unpacked if each of them is packed."""
        messages = file.messages(wanted, start_ns, end_ns) if wanted else iter(())
        first = next(messages, None)
        if first is None:
            return
        if _is_packed(first.topic, first.payload):
            yield from self._unpack_each(file, chain([first], messages))
        else:
            yield first
            yield from messages

    def _unpacked_runs(
        self,
        file: LogFile,
        wanted: Mapping[int, Topic],
        start_ns: int | None,
        end_ns: int | None,
    ) -> Iterator[RunGroup]:
        """Yield the runs of one file, unpacked if each message is packed."""
        groups = file.runs(wanted, start_ns, end_ns) if wanted else iter(())
        first = next(groups, None)
        if first is None:
            return
        earliest = next(messages_in(first.runs))
        if _is_packed(earliest.topic, earliest.payload):
            yield from group_messages(self._unpacked(file, wanted, start_ns, end_ns))
        else:
            yield first
            yield from groups

    def _unpack_each(self, file: LogFile, packed: Iterator[RawMessage]) -> Iterator[RawMessage]:
        """Unpack messages one by one; leave out and count what cannot be unpacked."""
        from zstandard import ZstdDecompressor, ZstdError  # noqa: PLC0415  # few logs need it

        unpack, lost = ZstdDecompressor().stream_reader, 0
        for message in packed:
            if message.payload.startswith(_CDR):
                yield message
                continue
            try:
                pieces = iter(partial(unpack(message.payload).read, _PIECE_BYTES), b"")
                payload = b"".join(islice(pieces, _MOST_PIECES))
                is_whole = not next(pieces, b"")
            except ZstdError:
                is_whole = False
            if not is_whole:
                lost += 1
                text = f"{file.path.name}: {lost:,} messages left out, zstd cannot unpack them"
                self._reading.add_damage(Damage(file.path.name, "message", lost, text))
                continue
            yield RawMessage(message.topic, message.stamp_ns, payload)


def _is_packed(topic: Topic, payload: bytes) -> bool:
    """Tell whether the messages of a file are packed one by one, by the first of them.

    metadata.yaml, which would tell, may be missing; but CDR always begins with a zero.
    """
    return topic.encoding == "cdr" and not payload.startswith(_CDR)


def join_topics(parts: Sequence[Topic]) -> dict[tuple[str, str, str], Topic]:
    """Sum what several channels or files say about the same topics, sorted by name.

    A name with two types or encodings stays two topics.
    """
    joined: dict[tuple[str, str, str], Topic] = {}
    for part in sorted(parts, key=lambda topic: (topic.name, topic.msgtype, topic.encoding)):
        key = (part.name, part.msgtype, part.encoding)
        known = joined.get(key)
        if known is None:
            joined[key] = part
            continue
        told = known if known.definition else part
        joined[key] = Topic(
            *key, known.n_messages + part.n_messages, told.definition, told.definition_format
        )
    return joined
