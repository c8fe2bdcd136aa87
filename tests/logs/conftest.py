"""Logs in memory: messages as dictionaries, encoded and decoded as in a file."""

import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest
from rosbags.serde import SerdeError

from mpap_cli.logs.bumps.bumpers import BUMPER_RULES, BumpDecoder, BumperRule
from mpap_cli.logs.files.runs import group_messages
from mpap_cli.logs.raw import Damage, LogReader, PayloadError, RawMessage, RunGroup, Topic
from mpap_cli.logs.remote.paths import LogPath
from mpap_cli.logs.writing.encoding import RosEncoder
from mpap_cli.observations import Bump
from mpap_cli.params import BumperParams

Event = tuple[str, str, int, Mapping[str, Any]]
MakeLog = Callable[..., LogReader]

ENCODINGS = {0: "json", 1: "ros1", 2: "cdr"}


class MemoryReader:
    """A log of messages that were never in a file (ros_version 0: JSON)."""

    def __init__(self, events: Sequence[Event], ros_version: int, empty: Sequence[Topic]) -> None:
        self.path: LogPath = Path("log.mcap")
        self.container = "mcap"
        self.damage: list[Damage] = []
        self.warnings: list[str] = []
        self.n_read = 0
        self._encoder = RosEncoder(ros_version or 2)
        self._messages = [self._encode(*event, ENCODINGS[ros_version]) for event in events]
        names = sorted({(message.topic.name, message.topic.msgtype) for message in self._messages})
        counted = [
            Topic(name, msgtype, ENCODINGS[ros_version], self._count(name, msgtype), "", "")
            for name, msgtype in names
        ]
        self.topics = (*counted, *empty)
        self.n_messages = len(self._messages)
        self.start_ns = min((message.stamp_ns for message in self._messages), default=0)
        self.end_ns = max((message.stamp_ns for message in self._messages), default=0)

    def _encode(
        self, name: str, msgtype: str, stamp_ns: int, fields: Mapping[str, Any], encoding: str
    ) -> RawMessage:
        topic = Topic(name, msgtype, encoding, 1, "", "")
        if isinstance(fields.get("payload"), bytes):
            return RawMessage(topic, stamp_ns, fields["payload"])
        if encoding == "json":
            return RawMessage(topic, stamp_ns, json.dumps(fields).encode())
        return RawMessage(topic, stamp_ns, self._encoder.encode(msgtype, fields))

    def _count(self, name: str, msgtype: str) -> int:
        kinds = [(message.topic.name, message.topic.msgtype) for message in self._messages]
        return kinds.count((name, msgtype))

    def messages(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[RawMessage]:
        """Yield messages in time order, and count them."""
        for message in sorted(self._messages, key=lambda message: message.stamp_ns):
            after_start = start_ns is None or message.stamp_ns >= start_ns
            before_end = end_ns is None or message.stamp_ns < end_ns
            if message.topic.name in topics and after_start and before_end:
                self.n_read += 1
                yield message

    def runs(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[RunGroup]:
        """Yield messages in runs."""
        yield from group_messages(self.messages(topics, start_ns, end_ns))

    def topic_bytes(self) -> None:
        """There is no index."""

    def undefined_types(self) -> tuple[str, ...]:
        """Messages that were encoded have a definition."""
        return ()

    def decode(self, message: RawMessage) -> object:
        """Decode a message; one cut short is an error of that message."""
        store, msgtype = self._encoder.store, message.topic.msgtype
        try:
            if message.topic.encoding == "json":
                return json.loads(message.payload)
            if message.topic.encoding == "ros1":
                return store.deserialize_ros1(message.payload, msgtype)
            return store.deserialize_cdr(message.payload, msgtype)
        except (SerdeError, ValueError) as err:
            text = f"{self.path.name}: {message.topic.name}: cut short"
            raise PayloadError(text) from err

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        pass


@pytest.fixture
def make_log() -> MakeLog:
    """Return a function that makes a log of (topic, type, stamp_ns, fields) events."""

    def make(
        events: Sequence[Event], *, ros_version: int = 2, empty: Sequence[Topic] = ()
    ) -> LogReader:
        return MemoryReader(events, ros_version, empty)

    return make


@pytest.fixture
def decode_bumps(make_log: MakeLog) -> Callable[..., list[Bump]]:
    """Return a function that encodes messages, one a nanosecond, and decodes them as bumps."""

    def decode(
        msgtype: str,
        messages: Sequence[Mapping[str, Any]],
        *,
        rule: BumperRule | None = None,
        ros_version: int = 2,
        params: BumperParams | None = None,
        **words: Any,
    ) -> list[Bump]:
        events = [("/bump", msgtype, stamp, fields) for stamp, fields in enumerate(messages)]
        reader = make_log(events, ros_version=ros_version)
        rule = rule or BUMPER_RULES[msgtype]
        sensors: dict[str, int] = {}
        decoder = BumpDecoder(reader, rule, params or BumperParams(), sensors=sensors, **words)
        pieces = [decoder(run)[0] for group in reader.runs({"/bump"}) for run in group.runs]
        names = list(sensors)
        return [
            Bump(int(stamp_ns), names[code // 2], bool(code % 2))
            for piece in pieces
            for stamp_ns, code in zip(piece.stamps_ns, piece.codes, strict=True)
        ]

    return decode
