"""Logs made of chunks (.bag and MCAP): their index, time order, broken chunks."""

import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import BinaryIO, Protocol

import numpy as np

from mpap_cli.logs.files.chunked.broken_chunks import BrokenChunks, lost_in
from mpap_cli.logs.files.runs import END_NS, cut_runs, in_turn, messages_in
from mpap_cli.logs.raw import RawMessage, RawRun, Reading, RunGroup, Topic
from mpap_cli.logs.remote.paths import LogPath
from mpap_cli.logs.remote.range_stream import RangeStream
from mpap_cli.observations import IntArray


class BrokenRecordError(ValueError):
    """A record does not follow the format, or the bytes end before it does."""


@dataclass(frozen=True, slots=True)
class Span:
    """Records of a file that are read at once: one chunk, or a run of records outside chunks.

    ``offset`` is where the chunk's record, or the run, begins; ``loose_bytes`` is the length
    of a run and 0 for a chunk. ``n_messages`` counts by channel; None: any channel may be
    in it. Stamps are those of the first and the last message. ``cut`` marks what the end
    of the file cuts off, which is reported with the file.
    """

    offset: int
    start_ns: int
    end_ns: int
    n_messages: Mapping[int, int] | None
    loose_bytes: int = 0
    cut: bool = False


@dataclass(frozen=True, slots=True)
class Index:
    """Where the messages of one file are; ``broken`` says by offset which chunks cannot be read."""

    channels: Mapping[int, Topic]
    spans: Sequence[Span]
    broken: Mapping[int, str] = field(default_factory=dict)


def make_index(
    channels: Mapping[int, Topic],
    spans: Iterable[Span],
    counts: Mapping[int, int] | None = None,
    broken: Mapping[int, str] | None = None,
) -> Index:
    """Build an index; messages are counted over the spans where ``counts`` is not given."""
    filled = [span for span in spans if span.n_messages is None or span.n_messages]
    if counts is None:
        total: Counter[int] = Counter()
        for span in filled:
            total.update(span.n_messages or {})
        counts = total
    counted = {
        number: replace(topic, n_messages=counts.get(number, 0))
        for number, topic in channels.items()
    }
    return Index(counted, sorted(filled, key=attrgetter("start_ns")), broken or {})


class ChunkFormat(Protocol):
    """How one container stores records."""

    def load(self, stream: BinaryIO, span: Span) -> tuple[bytes, str]:
        """Return the records of a span, unpacked, and what is wrong with them ("": nothing).

        Of a chunk that the end of the file cuts off, the records before the cut come back;
        of a chunk whose bytes are wrong, none.
        """
        ...

    def walk(self, records: bytes, wanted: IntArray) -> tuple[IntArray, bool]:
        """Find messages of the wanted channels in unpacked records; tell whether all is whole.

        The array (4, n) says where in ``wanted`` the channel is, and stamp, start and size
        of the payload. Without wanted channels it says the channel, and of records that are no
        messages -1 - kind and where they begin. What follows a broken record is found too.
        """
        ...


def file_size(stream: BinaryIO) -> int:
    """Return the size of an open file in bytes."""
    if isinstance(stream, RangeStream):
        return stream.size
    return os.fstat(stream.fileno()).st_size


def seek_to(stream: BinaryIO, offset: int) -> None:
    """Go to a place in an open file.

    Raises
    ------
    BrokenRecordError
        If the file ends before it.
    """
    if offset > file_size(stream):
        msg = "it lies behind the end of the file"
        raise BrokenRecordError(msg)
    stream.seek(offset)


def read_up_to(stream: BinaryIO, size: int) -> bytes:
    """Read that many bytes, or what is left of the file where the number is too large."""
    return stream.read(max(0, min(size, file_size(stream) - stream.tell())))


def in_time_order(
    spans: Sequence[Span], load: Callable[[Span], list[RawRun]]
) -> Iterator[RunGroup]:
    """Yield the runs of spans sorted by start.

    What a span holds beyond the start of the next one waits, so only spans that overlap in
    time are in memory together.
    """
    waiting: list[RawRun] = []
    for number, span in enumerate(spans, 1):
        until_ns = spans[number].start_ns if number < len(spans) else END_NS
        ready, waiting = cut_runs([*waiting, *load(span)], until_ns)
        if ready:
            yield RunGroup(until_ns, ready)


def _runs_in(records: bytes, found: IntArray, topics: Sequence[Topic]) -> list[RawRun]:
    """Part messages by topic; ``topics`` says which topic each channel belongs to."""
    numbers = {topic: number for number, topic in enumerate(dict.fromkeys(topics))}
    alone = len(numbers) == 1
    topic_of = np.array([numbers[topic] for topic in topics], dtype=np.int64)[found[0]]
    runs = []
    for topic, number in numbers.items():
        columns = found[1:] if alone else found[1:, topic_of == number]
        if not columns.size:
            continue
        if (columns[0, 1:] < columns[0, :-1]).any():
            columns = columns[:, np.argsort(columns[0], kind="stable")]
        stamps_ns, starts, sizes = columns
        runs.append(RawRun(topic, stamps_ns, records, starts, sizes))
    return runs


class ChunkedFile:
    """One .bag or MCAP file with an index, its own or one made by reading it through."""

    def __init__(self, path: LogPath, layout: ChunkFormat, index: Index, reading: Reading) -> None:
        self.path = path
        self.channels: Mapping[int, Topic] = index.channels
        self.ros_distro = ""
        self.n_messages = sum(topic.n_messages for topic in index.channels.values())
        self.start_ns = min((span.start_ns for span in index.spans), default=0)
        self.end_ns = max((span.end_ns for span in index.spans), default=0)
        self.layout = layout
        self.spans = index.spans
        n_chunks = len({span.offset for span in index.spans} | index.broken.keys())
        self._kept: tuple[int, bytes, str] | None = None
        self._broken = BrokenChunks(path.name, n_chunks, index.channels, reading)
        for offset, problem in index.broken.items():
            self._broken.note(offset, problem, None)

    def messages(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RawMessage]:
        """Yield the messages of the wanted channels in log time order, start <= t < end."""
        for group in self._groups(wanted, start_ns, end_ns):
            yield from messages_in(group.runs)

    def runs(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RunGroup]:
        """Yield the same messages in runs."""
        for until_ns, runs in self._groups(wanted, start_ns, end_ns):
            yield RunGroup(until_ns, in_turn(runs))

    def _groups(
        self, wanted: Mapping[int, Topic], start_ns: int | None, end_ns: int | None
    ) -> Iterator[RunGroup]:
        """Yield runs that need not follow one another."""
        first = self.start_ns if start_ns is None else start_ns
        after = self.end_ns + 1 if end_ns is None else end_ns
        spans = [
            span
            for span in self.spans
            if first <= span.end_ns
            and span.start_ns < after
            and (span.n_messages is None or not wanted.keys().isdisjoint(span.n_messages))
        ]
        numbers, topics = np.array(list(wanted), dtype=np.int64), list(wanted.values())
        with self.path.open("rb") as stream:

            def load(span: Span) -> list[RawRun]:
                records, found = self._read_span(stream, span, numbers)
                if span.start_ns < first or after <= span.end_ns:
                    found = found[:, (found[1] >= first) & (found[1] < after)]
                return _runs_in(records, found, topics)

            yield from in_time_order(spans, load)
        if len(spans) > 1:
            self._kept = None

    def _read_span(self, stream: BinaryIO, span: Span, wanted: IntArray) -> tuple[bytes, IntArray]:
        """Return the records of a span and its messages, as `ChunkFormat.walk` does."""
        records, problem = self._load(stream, span)
        found, whole = self.layout.walk(records, wanted)
        if not whole:
            problem = problem or "a record in it is broken"
        fits = (span.start_ns <= found[1]) & (found[1] <= span.end_ns)
        if not fits.all():
            problem = problem or "a stamp in it is not what the index says"
            found = found[:, fits]
        if span.n_messages is not None:
            n_messages = sum(span.n_messages.get(number, 0) for number in wanted.tolist())
            if found.shape[1] != n_messages:
                problem = problem or "it does not hold the messages that the index says"
        if problem and not span.cut:
            bounds = (span.start_ns, span.end_ns)
            lost = lost_in(records, self.layout.walk, span.n_messages, *bounds)
            self._broken.note(span.offset, problem, lost)
        return records, found

    def _load(self, stream: BinaryIO, span: Span) -> tuple[bytes, str]:
        """Return what `ChunkFormat.load` does.

        One chunk stays until another is asked for: whoever looks a log over reads its first
        messages only, one topic after the other.
        """
        if self._kept is None or self._kept[0] != span.offset:
            self._kept = None
            self._kept = (span.offset, *self.layout.load(stream, span))
        return self._kept[1:]
