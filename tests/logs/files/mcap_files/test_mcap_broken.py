"""MCAP files broken in each way that they break."""

import struct
from pathlib import Path

import pytest
from mcap.opcode import Opcode
from mcap.writer import CompressionType

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import open_log
from tests.logs.files.mcaps import chunk_offsets, write_mcap
from tests.logs.rows import ROWS, WriteLog, stamps


def change(path: Path, place: int, text: bytes) -> None:
    """Overwrite bytes of a file."""
    content = path.read_bytes()
    path.write_bytes(content[:place] + text + content[place + len(text) :])


@pytest.mark.parametrize("kind", ["mcap-none", "mcap-lz4", "mcap-zstd", "mcap-unchunked"])
def test_file_cut_anywhere_keeps_what_is_whole(write_log: WriteLog, kind: str) -> None:
    """The longer the rest, the more messages; never another error."""
    path = write_log(kind, ROWS)
    content = path.read_bytes()
    counts = []

    for size in range(9, len(content), 61):
        path.write_bytes(content[:size])
        with open_log(path) as reader:
            found = stamps(reader)
        assert found == [row[1] for row in ROWS[: len(found)]]
        assert [damage.kind for damage in reader.damage] in (["truncated"], ["index"])
        assert reader.damage[0].count == reader.n_messages == len(found)
        counts.append(len(found))

    assert counts == sorted(counts)
    assert (counts[0], counts[-1]) == (0, len(ROWS))


def test_truncated_file_tells_where_and_how_much(write_log: WriteLog) -> None:
    """The sentence names file, byte and count; read strictly it is the error."""
    path = write_log("mcap-zstd", ROWS)
    second, _ = chunk_offsets(path)[1]
    path.write_bytes(path.read_bytes()[: second + 20])

    with open_log(path) as reader:
        damage = reader.damage

    text = f"log.mcap: the file is cut off or broken at byte {second:,}; the {damage[0].count} "
    assert damage[0].text.startswith(text)
    with pytest.raises(LogError, match="cut off or broken at byte"):
        open_log(path, strict=True)


@pytest.mark.parametrize(
    ("kind", "problem"),
    [
        ("mcap-none", "its checksum is wrong"),
        ("mcap-lz4", "lz4 cannot unpack it|its checksum is wrong"),
        ("mcap-zstd", "zstd cannot unpack it|its checksum is wrong"),
    ],
)
def test_broken_chunk_is_left_out_and_counted(write_log: WriteLog, kind: str, problem: str) -> None:
    """A changed byte costs its chunk, nothing else, and is reported once."""
    path = write_log(kind, ROWS)
    (second, length), n_chunks = chunk_offsets(path)[1], len(chunk_offsets(path))
    change(path, second + length - 20, b"\xff\xfe\xfd")

    with open_log(path) as reader:
        found, again = stamps(reader), stamps(reader)

    assert found == again
    assert 0 < len(found) < len(ROWS) == reader.n_messages
    assert set(found) < {row[1] for row in ROWS}
    assert [(damage.kind, damage.count) for damage in reader.damage] == [("chunk", 1)]
    assert f"1 of {n_chunks} chunks damaged and left out" in reader.damage[0].text
    with open_log(path, strict=True) as reader, pytest.raises(LogError, match=problem):
        stamps(reader)


@pytest.mark.parametrize(
    ("place", "text", "problem"),
    [
        (0, b"\x01", "its head is broken"),
        (9 + 16, b"\xff" * 7, "it declares .* bytes"),
        (9 + 28, b"\xff", "its head is broken"),
        (9 + 32, b"zip7", "its compression 'zip7' is unknown"),
    ],
)
def test_broken_head_of_a_chunk(write_log: WriteLog, place: int, text: bytes, problem: str) -> None:
    """Kind, size, name of the compression: nothing is believed before memory is taken."""
    path = write_log("mcap-zstd", ROWS)
    second, _ = chunk_offsets(path)[1]
    change(path, second + place, text)

    with open_log(path, strict=True) as reader, pytest.raises(LogError, match=problem):
        stamps(reader)


def test_broken_summary_is_made_anew(write_log: WriteLog) -> None:
    """Its checksum tells; all messages are found by reading the file through."""
    path = write_log("mcap-zstd", ROWS)
    content = path.read_bytes()
    change(path, content.rindex(b"/right"), b"/wrong")

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS]
    assert [topic.name for topic in reader.topics] == ["/left", "/right"]
    assert [damage.kind for damage in reader.damage] == ["index"]
    assert "the checksum of its summary is wrong; all 60 messages" in reader.damage[0].text


def test_broken_chunk_of_a_file_without_index(write_log: WriteLog) -> None:
    """It is unpacked when it is read, and reported then, with what is lost."""
    path = write_log("mcap-none", ROWS)
    second, length = chunk_offsets(path)[1]
    change(path, second + length - 20, b"\xff\xfe\xfd")
    path.write_bytes(path.read_bytes()[:-1])

    with open_log(path) as reader:
        found = stamps(reader)

    assert 0 < len(found) < len(ROWS) == reader.n_messages
    assert sum(reader.damage[1].lost.values()) == len(ROWS) - len(found)
    assert f"{len(ROWS) - len(found)} messages lost" in reader.damage[1].text
    assert [damage.kind for damage in reader.damage] == ["index", "chunk"]


def test_impossible_stamp_is_left_out(tmp_path: Path) -> None:
    """It would not fit into 64 bits with a sign."""
    path = write_mcap(tmp_path / "log.mcap", [10, 20, 2**64 - 1])

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [10, 20]
    assert "a stamp in it is not what the index says" in reader.damage[0].text


@pytest.mark.parametrize(
    ("opcode", "content", "problem"),
    [
        (Opcode.CHUNK_INDEX, b"short", "its list of chunks is broken"),
        (
            Opcode.CHUNK_INDEX,
            struct.pack("<QQQQI", 0, 0, 8, 50, 10) + struct.pack("<HQQ", 1, 58, 7),
            "its list of chunks is broken",
        ),
        (Opcode.STATISTICS, b"short", "its statistics are broken"),
        (Opcode.SCHEMA, b"short", "a schema is broken"),
    ],
)
def test_broken_record_in_the_summary(
    write_log: WriteLog, opcode: Opcode, content: bytes, problem: str
) -> None:
    """The summary is given up, the file read through."""
    path = write_log("mcap-zstd", ROWS)
    whole = path.read_bytes()
    (start,) = struct.unpack("<Q", whole[-28:-20])
    record = struct.pack("<BQ", opcode, len(content)) + content
    footer = struct.pack("<BQQQI", Opcode.FOOTER, 20, start, 0, 0)
    path.write_bytes(whole[:start] + record + footer + whole[-8:])

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS]
    assert problem in reader.damage[0].text


def test_summary_behind_the_end_of_the_file(write_log: WriteLog) -> None:
    """Its position is not believed."""
    path = write_log("mcap-zstd", ROWS)
    change(path, path.stat().st_size - 28, b"\xff" * 8)

    with open_log(path) as reader:
        found = stamps(reader)

    assert found == [row[1] for row in ROWS]
    assert "the position of its summary is wrong" in reader.damage[0].text


def test_chunk_behind_the_end_of_the_file(write_log: WriteLog) -> None:
    """An index without checksum can point anywhere."""
    path = write_log("mcap-zstd", ROWS)
    first, length = chunk_offsets(path)[0]
    place = path.read_bytes().rindex(struct.pack("<QQ", first, length))
    change(path, place, b"\xff" * 5)
    change(path, path.stat().st_size - 12, bytes(4))

    with open_log(path) as reader:
        found = stamps(reader)

    assert 0 < len(found) <= len(ROWS)
    assert reader.damage


@pytest.mark.parametrize("options", [{"enable_crcs": False}, {"use_chunking": False}])
@pytest.mark.parametrize("size", [1, 100, 2**40], ids=["short", "long", "huge"])
def test_message_of_a_wrong_size(tmp_path: Path, options: dict[str, bool], size: int) -> None:
    """Reading goes on behind it, whatever it swallows."""
    stamps_ns = list(range(10**18, 10**18 + 30))
    words = {**options, "compression": CompressionType.NONE}
    path = write_mcap(tmp_path / "log.mcap", stamps_ns, **words)
    place = path.read_bytes().index(struct.pack("<Q", stamps_ns[7])) - 14
    change(path, place, struct.pack("<Q", 62 + size))

    with open_log(path) as reader:
        found = stamps(reader)

    assert set(stamps_ns) - set(found) <= {stamps_ns[7]}
    assert reader.damage
