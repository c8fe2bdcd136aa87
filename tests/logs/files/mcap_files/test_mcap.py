"""MCAP files of all kinds that the format allows."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import pytest
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Channel, Message, Schema
from mcap.writer import CompressionType, Writer

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, Span
from mpap_cli.logs.files.mcap_files.mcap_records import (
    McapFormat,
    parse_channel,
    parse_schema,
    records_in,
)
from mpap_cli.logs.reader import open_log
from tests.logs.files.mcaps import chunk_offsets, write_mcap
from tests.logs.rows import ROWS, WriteLog, stamps


def test_complete_file_without_summary_is_not_damaged(write_log: WriteLog) -> None:
    """Streaming writers leave the summary out."""
    path = write_log("mcap-no-summary", ROWS)

    with open_log(path, strict=True) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS]
    assert (reader.damage, reader.warnings) == ([], [])


def test_chunks_that_overlap_in_time_are_merged(tmp_path: Path) -> None:
    """Also where every chunk overlaps with the next two."""
    times = [10**18 + (number * 37) % 211 + number for number in range(400)]
    path = write_mcap(tmp_path / "log.mcap", times, chunk_size=500)

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == sorted(times)


def test_equal_stamps_stay_in_file_order(tmp_path: Path) -> None:
    """Also across chunks."""
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=100)
        writer.start()
        channel = writer.register_channel("/left", "cdr", 0)
        for number in range(50):
            writer.add_message(channel, 7, bytes([number]), 7)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type

    with open_log(path) as reader:
        found = [message.payload[0] for message in reader.messages(["/left"])]

    assert found == list(range(50))


def test_only_chunks_of_a_chosen_topic_are_unpacked(
    write_log: WriteLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A topic in one chunk costs one chunk."""
    rows = [*ROWS, ("/rare", 2 * 10**18, "once")]
    path = write_log("mcap-zstd", rows)
    unpacked = []
    load = McapFormat.load

    def counted(layout: McapFormat, stream: BinaryIO, span: Span) -> tuple[bytes, str]:
        unpacked.append(span.offset)
        return load(layout, stream, span)

    monkeypatch.setattr(McapFormat, "load", counted)
    with open_log(path) as reader:
        found = list(reader.messages(["/rare"]))

    assert (len(found), len(unpacked)) == (1, 1)


@pytest.mark.parametrize("with_summary", [True, False])
def test_messages_outside_chunks_are_found(tmp_path: Path, with_summary: bool) -> None:
    """The format allows both in one file; the chunk indexes then do not count all messages."""
    path = write_mcap(tmp_path / "log.mcap", [10, 20, 30], compression=CompressionType.NONE)
    builder = RecordBuilder()
    Message(channel_id=1, log_time=25, publish_time=25, sequence=0, data=b"").write(builder)
    loose: bytes = builder.end()  # type: ignore[no-untyped-call]  # mcap forgot the type
    content = path.read_bytes()
    first, length = chunk_offsets(path)[0]
    cut = first + length
    if with_summary:
        start, offsets = struct.unpack("<QQ", content[-28:-12])
        footer = struct.pack("<BQQQI", Opcode.FOOTER, 20, start + len(loose), offsets, 0)
        rest = content[cut:-37] + footer + content[-8:]
        head = rest.index(struct.pack("<BQQ", Opcode.STATISTICS, 46 + 10, 3)) + 9
        rest = rest[:head] + struct.pack("<Q", 4) + rest[head + 8 :]
    else:
        rest = struct.pack("<BQI", Opcode.DATA_END, 4, 0)
    path.write_bytes(content[:cut] + loose + rest)

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [10, 20, 25, 30]
    assert [damage.kind for damage in reader.damage] == ([] if with_summary else ["index"])


def test_topic_of_two_channels_is_one(tmp_path: Path) -> None:
    """Two publishers of one topic and type are summed; another type is another topic."""
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schemas = [writer.register_schema(f"pkg/{name}", "ros1msg", b"") for name in "ABA"]
        for number, schema in enumerate(schemas):
            channel = writer.register_channel("/left", "ros1", schema)
            writer.add_message(channel, number, b"", number)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type

    with open_log(path) as reader:
        found = [(m.topic.msgtype, m.stamp_ns) for m in reader.messages(["/left"])]

    assert [(t.name, t.msgtype, t.n_messages) for t in reader.topics] == [
        ("/left", "pkg/msg/A", 2),
        ("/left", "pkg/msg/B", 1),
    ]
    assert found == [("pkg/msg/A", 0), ("pkg/msg/B", 1), ("pkg/msg/A", 2)]


def test_encodings_that_are_not_read_are_listed(tmp_path: Path) -> None:
    """A topic in flatbuffer has a name, a type and a count, and no definition."""
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("foxglove.LaserScan", "flatbuffer", b"\xff\xfe")
        channel = writer.register_channel("/scan", "flatbuffer", schema)
        writer.add_message(channel, 1, b"\x08\x01", 1)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type

    with open_log(path) as reader:
        topic = reader.topics[0]
        message = next(reader.messages(["/scan"]))

    assert (topic.msgtype, topic.encoding) == ("foxglove.LaserScan", "flatbuffer")
    assert (topic.definition, topic.definition_format) == ("", "")
    with pytest.raises(LogError, match="as flatbuffer; only ros1, cdr, json and protobuf are read"):
        reader.decode(message)


@pytest.mark.parametrize("parse", [parse_schema, parse_channel])
def test_broken_schema_and_channel(parse: Callable[[bytes], Schema | Channel]) -> None:
    """The library's errors become ours."""
    for content in (
        b"",
        b"\x01\0\x02\0\xff\xff\xff\xff",
        b"\x01\0\x02\0\x01\0\0\0\xff" + bytes(12),
    ):
        with pytest.raises(BrokenRecordError):
            parse(content)


def test_broken_records_are_noticed() -> None:
    """A head or a record that is cut off."""
    record = struct.pack("<BQ", Opcode.HEADER, 3) + b"abc"

    assert list(records_in(record)) == [(Opcode.HEADER, 9, 12)]
    for content in (record[:-1], record + b"\x01"):
        with pytest.raises(BrokenRecordError):
            list(records_in(content))
