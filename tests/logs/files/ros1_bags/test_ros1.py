"""ROS 1 bags, also those without an index."""

import struct
from pathlib import Path

import numpy as np
import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.files.ros1_bags.bag_records import BagFormat, parse_fields
from mpap_cli.logs.reader import open_log
from tests.logs.files.bags import ROWS, connection, field, message, record
from tests.logs.rows import WriteLog, stamps

BAG_HEADER_BYTES = 13 + 4096 + 4


def without_index(content: bytes) -> bytes:
    """Return a bag as a recorder leaves it that is killed: no index, position 0."""
    (position,) = struct.unpack("<Q", parse_fields(content[17 : 17 + 69])[b"index_pos"])
    return content[:position].replace(struct.pack("<Q", position), bytes(8), 1)


def test_killed_recorder_leaves_a_readable_bag(write_log: WriteLog) -> None:
    """Without an index every message is found, and the log says so once."""
    path = write_log("bag-lz4", ROWS)
    path.write_bytes(without_index(path.read_bytes()))

    with open_log(path) as reader:
        found = stamps(reader)
        again = stamps(reader)

    assert found == again == [row[1] for row in ROWS]
    assert [(damage.kind, damage.count) for damage in reader.damage] == [("unindexed", len(ROWS))]
    assert "no usable index; all 60 messages found are used" in reader.damage[0].text


def test_bag_that_is_written_at_this_moment(tmp_path: Path) -> None:
    """The last chunk has no size yet: its messages stand in the file like records."""
    head = b"#ROSBAG V2.0\n" + record(
        field(b"op", b"\x03") + field(b"index_pos", bytes(8)), b" " * 50
    )
    open_chunk = record(
        field(b"op", b"\x05") + field(b"compression", b"none") + field(b"size", bytes(4)), b""
    )
    path = tmp_path / "log.bag.active"
    whole = head + open_chunk + connection(0, b"/left") + message(b"abc") + message(b"defg")
    path.write_bytes(whole + message(b"cut off")[:-3])

    with open_log(path) as reader:
        found = [message.payload for message in reader.messages(["/left"])]

    assert found == [b"abc", b"defg"]
    assert [damage.kind for damage in reader.damage] == ["truncated"]


@pytest.mark.parametrize("kind", ["bag-none", "bag-bz2", "bag-lz4"])
def test_bag_cut_anywhere_keeps_what_is_whole(write_log: WriteLog, kind: str) -> None:
    """The longer the rest, the more messages; never another error."""
    path = write_log(kind, ROWS)
    content = path.read_bytes()
    counts = []

    for size in range(BAG_HEADER_BYTES, len(content), 97):
        path.write_bytes(content[:size])
        with open_log(path) as reader:
            found = stamps(reader)
        assert found == [row[1] for row in ROWS[: len(found)]]
        assert [damage.kind for damage in reader.damage] in (["truncated"], ["unindexed"])
        assert reader.damage[0].count == reader.n_messages == len(found)
        counts.append(len(found))

    assert counts == sorted(counts)
    assert (counts[0], counts[-1]) == (0, len(ROWS))


def test_uncompressed_chunk_that_is_cut_gives_its_first_messages(write_log: WriteLog) -> None:
    """Not only whole chunks are read."""
    path = write_log("bag-none", ROWS[:4])
    content = path.read_bytes()
    third = [place for place in range(len(content)) if content[place:].startswith(b"x" * 20)][2]
    path.write_bytes(content[: third + 10])

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS[:2]]


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"#ROSBAG V1.2\n", "bag version '1.2', expected '2.0'.*rosbag fix"),
        (
            b"#ROSBAG V2.0\n"
            + record(field(b"op", b"\x03") + field(b"encryptor", b"rosbag/AesCbc"), b""),
            "the bag is encrypted",
        ),
    ],
)
def test_bag_of_another_kind(tmp_path: Path, content: bytes, text: str) -> None:
    """Old and encrypted bags are named as such."""
    path = tmp_path / "log.bag"
    path.write_bytes(content)

    with pytest.raises(LogError, match=text):
        open_log(path)


@pytest.mark.parametrize("order", ["op conn time", "conn op time", "time conn op", "op time conn"])
def test_header_fields_come_in_any_order(order: str) -> None:
    """The usual orders are known by their bytes, others are parsed."""
    records = connection(0, b"/left") + message(b"abc", order) + message(b"", order)

    (which, stamps_ns, starts, sizes), whole = BagFormat().walk(records, np.array([3, 0]))

    assert whole
    places = zip(starts, sizes, strict=True)
    assert [records[start : start + size] for start, size in places] == [b"abc", b""]
    assert stamps_ns.tolist() == [5_000_000_007] * 2
    assert which.tolist() == [1, 1]


def test_connections_of_one_topic_are_summed(write_log: WriteLog) -> None:
    """Two publishers are two connections; the topic is one, its slashes single."""
    path = write_log("bag-none", [("/left", 10**18, "a"), ("//left", 10**18 + 1, "b")])

    with open_log(path) as reader:
        found = stamps(reader)

    assert [(topic.name, topic.n_messages) for topic in reader.topics] == [("/left", 2)]
    assert len(found) == 2
