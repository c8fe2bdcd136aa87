"""One log as records that can be copied: nothing is unpacked, decoded or left out."""

import heapq
import struct
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from copy import copy
from dataclasses import dataclass
from fnmatch import fnmatchcase
from operator import attrgetter
from types import TracebackType
from typing import cast

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunked.chunks import ChunkedFile
from mpap_cli.logs.files.mcap_files.mcap_records import MESSAGE_HEAD_BYTES, McapFormat
from mpap_cli.logs.files.overlapping import overlapping
from mpap_cli.logs.files.ros1_bags.bag_records import BagFormat
from mpap_cli.logs.passthrough.channels import channels_of, origin_of
from mpap_cli.logs.passthrough.records import Origin, RawChannel, Record
from mpap_cli.logs.raw import Damage, LogFile, Reading, Topic
from mpap_cli.logs.reader import LogPath, open_files
from mpap_cli.observations import IntArray

_HEAD = struct.Struct("<HIQQ")


class _WithHeads(McapFormat):
    """An MCAP file whose payloads come with channel, sequence and stamps before them."""

    def walk(self, records: bytes, wanted: IntArray) -> tuple[IntArray, bool]:
        """Find messages in unpacked records; a payload begins with the head of its record."""
        found, whole = super().walk(records, wanted)
        found[2] -= MESSAGE_HEAD_BYTES
        found[3] += MESSAGE_HEAD_BYTES
        return found, whole


@dataclass(frozen=True, slots=True)
class _Numbered(Topic):
    """A topic that knows the number of its channel, so that two channels never are one."""

    number: int


class PassthroughLog(AbstractContextManager["PassthroughLog"]):
    """One log of one file or several, record by record.

    Attributes
    ----------
    path : Path or RemotePath
        The log.
    origin : Origin
        What it says about itself.
    channels : tuple of RawChannel
        A record names one by its number in this order. Those of several files are one if
        they are described alike.
    damage : list of Damage
        Grows while records are read.
    """

    def __init__(self, path: LogPath, *, strict: bool = False) -> None:
        self._reading = Reading(strict=strict)
        self.path, folder = open_files(path, self._reading)
        self.damage: list[Damage] = self._reading.damage
        self._files = folder.files
        try:
            self.channels, self._numbers = channels_of(self._files)
            self.origin: Origin = origin_of(self.path, folder)
        except BaseException:
            self._reading.close()
            raise

    def records(
        self, channels: Collection[int], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[Record]:
        """Yield the records of some channels in log time order, start <= t < end.

        Raises
        ------
        LogError
            If a file cannot be read any more; read strictly, at the first damage.
        """
        wanted = frozenset(channels)
        try:
            for part in overlapping(self._files, start_ns, end_ns):
                streams = [self._records_of(file, wanted, start_ns, end_ns) for file in part]
                yield from heapq.merge(*streams, key=attrgetter("stamp_ns"))
        except OSError as err:
            msg = f"{self.path.name}: cannot be read any more ({err.strerror or err})"
            raise LogError(msg) from err

    def _records_of(
        self, file: LogFile, wanted: Collection[int], start_ns: int | None, end_ns: int | None
    ) -> Iterator[Record]:
        """Yield the records of one file."""
        numbers = self._numbers[str(file.path)]
        topics: Mapping[int, Topic] = {
            own: _Numbered("", "", "", 0, "", "", number)
            for own, number in numbers.items()
            if number in wanted
        }
        if not topics:
            return
        with_heads = isinstance(file, ChunkedFile) and not isinstance(file.layout, BagFormat)
        if isinstance(file, ChunkedFile) and with_heads:
            file = copy(file)
            file.layout = _WithHeads()
        for message in file.messages(topics, start_ns, end_ns):
            number, stamp_ns = cast("_Numbered", message.topic).number, message.stamp_ns
            payload, published_ns, sequence = message.payload, stamp_ns, 0
            if with_heads:
                _, sequence, _, published_ns = _HEAD.unpack_from(payload)
                payload = payload[MESSAGE_HEAD_BYTES:]
            yield Record(number, stamp_ns, published_ns, sequence, payload)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._reading.close()


def chosen_channels(channels: Sequence[RawChannel], topics: Sequence[str]) -> list[int]:
    """Return the numbers of the channels whose topics match a name or glob; all without any."""
    return [
        number
        for number, channel in enumerate(channels)
        if not topics or any(fnmatchcase(channel.topic, pattern) for pattern in topics)
    ]
