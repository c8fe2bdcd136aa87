"""ROS 1 bags broken in each way that they break."""

import struct
from pathlib import Path

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunked.chunks import BrokenRecordError
from mpap_cli.logs.files.ros1_bags.bag_records import parse_fields
from mpap_cli.logs.reader import open_log
from tests.logs.files.bags import ROWS, connection, field, message, record
from tests.logs.rows import WriteLog, stamps


def test_strict_reading_refuses_damage(write_log: WriteLog) -> None:
    """The first damage is the error."""
    path = write_log("bag-none", ROWS)
    path.write_bytes(path.read_bytes()[:-200])

    with pytest.raises(LogError, match=r"log\.bag: the bag is cut off.*without --strict"):
        open_log(path, strict=True)


@pytest.mark.parametrize("kind", ["bag-bz2", "bag-lz4"])
def test_broken_chunk_is_left_out_and_counted(write_log: WriteLog, kind: str) -> None:
    """Behind the index nothing else is lost."""
    path = write_log(kind, ROWS)
    content = bytearray(path.read_bytes())
    magic = {"bag-bz2": b"BZh9", "bag-lz4": b"\x04\x22\x4d\x18"}[kind]
    place = content.index(magic, content.index(magic) + 1)
    content[place : place + 4] = b"oops"
    path.write_bytes(content)

    with open_log(path) as reader:
        found = stamps(reader)
        again = stamps(reader)

    assert found == again
    assert 0 < len(found) < len(ROWS) == reader.n_messages
    assert [(damage.kind, damage.count) for damage in reader.damage] == [("chunk", 1)]
    assert f"{kind[4:]} cannot unpack it" in reader.damage[0].text
    n_lost = len(ROWS) - len(found)
    assert f"left out, {n_lost} messages lost" in reader.damage[0].text
    assert sum(reader.damage[0].lost.values()) == n_lost
    assert set(reader.damage[0].lost) <= {(topic.name, topic.msgtype) for topic in reader.topics}
    with open_log(path, strict=True) as reader, pytest.raises(LogError, match="left out"):
        stamps(reader)


def test_broken_record_in_a_chunk_is_noticed(write_log: WriteLog) -> None:
    """A message that claims to be longer than its chunk."""
    path = write_log("bag-none", ROWS)
    content = path.read_bytes()
    place = content.index(struct.pack("<I", 24) + struct.pack("<I", 20) + b"xxxx")
    path.write_bytes(content[:place] + b"\xff\xff\xff\x7f" + content[place + 4 :])

    with open_log(path) as reader:
        found = stamps(reader)

    assert len(found) == len(ROWS) - 1
    assert "a record in it is broken" in reader.damage[0].text


def test_stamp_that_the_index_does_not_know_is_left_out(write_log: WriteLog) -> None:
    """Otherwise time would run back or leap."""
    path = write_log("bag-none", ROWS)
    content = path.read_bytes()
    place = content.index(b"time=") + len(b"time=")
    path.write_bytes(content[:place] + b"\xff\xff\xff\xff" + content[place + 4 :])

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS[1:]]
    assert "a stamp in it is not what the index says" in reader.damage[0].text


def test_index_behind_the_end_of_the_file(write_log: WriteLog) -> None:
    """The position in the header is not believed."""
    path = write_log("bag-none", ROWS)
    content = path.read_bytes()
    (position,) = struct.unpack("<Q", parse_fields(content[17 : 17 + 69])[b"index_pos"])
    path.write_bytes(content.replace(struct.pack("<Q", position), b"\xff" * 8, 1))

    with open_log(path) as reader:
        found = stamps(reader)

    assert len(found) == len(ROWS)
    assert reader.damage[0].kind == "unindexed"


@pytest.mark.parametrize(
    "header", [b"\x04\0\0", b"\xff\0\0\0op=\x02", b"\x03\0\0\0abc"], ids=["size", "end", "equals"]
)
def test_broken_header(header: bytes) -> None:
    """Every way in which a header can end too early or lack its sign."""
    with pytest.raises(BrokenRecordError):
        parse_fields(header)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"\x08\0\0\0ver=\x01", b"\x05\0\0\0ver=\x01"),
        (b"start_time=", b"start_tame="),
        (b"chunk_pos=", b"chunk_bos="),
        (b"message_definition=", b"message_definition:"),
    ],
)
def test_index_that_is_broken(write_log: WriteLog, old: bytes, new: bytes) -> None:
    """The bag is read through."""
    path = write_log("bag-none", ROWS)
    content = path.read_bytes()
    (position,) = struct.unpack("<Q", parse_fields(content[17 : 17 + 69])[b"index_pos"])
    path.write_bytes(content[:position] + content[position:].replace(old, new))

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS]
    assert reader.damage[0].kind in {"unindexed", "truncated"}


def test_bag_without_position_of_its_index(tmp_path: Path) -> None:
    """The first record lacks the field."""
    path = tmp_path / "log.bag"
    head = b"#ROSBAG V2.0\n" + record(field(b"op", b"\x03"), b"")
    path.write_bytes(head + connection(0, b"/left") + message(b"abc"))

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [5_000_000_007]


def test_broken_connection_outside_the_index(tmp_path: Path) -> None:
    """What was read before it in the same place is used."""
    path = tmp_path / "log.bag"
    head = b"#ROSBAG V2.0\n" + record(field(b"op", b"\x03") + field(b"index_pos", bytes(8)), b"")
    broken = record(field(b"op", b"\x07") + field(b"conn", b"\x01"), b"")
    path.write_bytes(head + connection(0, b"/left") + message(b"abc") + broken)

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [5_000_000_007]
    assert {damage.kind for damage in reader.damage} == {"unindexed", "chunk"}


def test_index_that_leads_astray(write_log: WriteLog) -> None:
    """Places of chunks have no checksum: where none is, the bag is read through."""
    path = write_log("bag-lz4", ROWS)
    content = bytearray(path.read_bytes())
    place = content.index(b"chunk_pos=", content.index(b"chunk_pos=") + 1) + len(b"chunk_pos=")
    content[place] ^= 1
    path.write_bytes(content)

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS]
    assert reader.damage[0].kind == "unindexed"


def test_chunk_of_a_wrong_size(write_log: WriteLog) -> None:
    """Behind it, reading goes on; of two broken places the first is told."""
    path = write_log("bag-none", ROWS)
    content = bytearray(path.read_bytes())
    place = content.index(b"size=", content.index(b"size=") + 1) + len(b"size=")
    content[place + 1] ^= 0x40
    (position,) = struct.unpack("<Q", parse_fields(bytes(content[17 : 17 + 69]))[b"index_pos"])
    path.write_bytes(content[:position])

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS]
    assert "is broken at one place, at byte" in reader.damage[0].text
