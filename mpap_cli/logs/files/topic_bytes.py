"""How large the messages of each topic are, as the indexes of a log tell."""

from collections import Counter
from collections.abc import Iterable, Mapping

import numpy as np

from mpap_cli.logs.files.chunked.chunk_indexes import read_bag_index, read_mcap_index
from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, ChunkedFile
from mpap_cli.logs.files.databases.content import Database
from mpap_cli.logs.files.ros1_bags.bag_records import BagFormat
from mpap_cli.logs.raw import LogFile, TopicKey
from mpap_cli.logs.remote.range_stream import RangeStream

_EVERY = np.empty(0, np.int64)


def bytes_by_topic(files: Iterable[LogFile]) -> Mapping[TopicKey, int] | None:
    """Sum the payloads of each topic; None where the index of one file does not tell."""
    total: Counter[TopicKey] = Counter()
    for file in files:
        sizes = _channel_bytes(file)
        if sizes is None:
            return None
        for number, size in sizes.items():
            topic = file.channels.get(number)
            if topic is not None:
                total[topic.name, topic.msgtype] += size
    return total


def _channel_bytes(file: LogFile) -> Mapping[int, int] | None:
    """Sum the payloads of each channel of a file."""
    if isinstance(file, Database):
        return file.channel_bytes()
    return _bytes_in_chunks(file) if isinstance(file, ChunkedFile) else None


def _bytes_in_chunks(file: ChunkedFile) -> Mapping[int, int] | None:
    """Read the index behind each chunk; records outside chunks are looked at themselves."""
    read_index = read_bag_index if isinstance(file.layout, BagFormat) else read_mcap_index
    total: Counter[int] = Counter()
    with file.path.open("rb") as stream:
        if isinstance(stream, RangeStream):  # each index would take a request
            return None
        for span in file.spans:
            if span.loose_bytes:
                records, _ = file.layout.load(stream, span)
                found, _ = file.layout.walk(records, _EVERY)
                for number, size in found[[0, 3]][:, found[0] >= 0].T.tolist():
                    total[number] += size
                continue
            try:
                index = read_index(stream, span.offset)
            except BrokenRecordError:
                return None
            if index is None:
                return None
            total.update(index.sizes())
    return total
