"""What the index behind a chunk says is taken where it can be believed, and only there."""

import struct
from collections import Counter
from pathlib import Path

import pytest

from mpap_cli.logs.files.chunked.chunk_indexes import ChunkIndex, read_bag_index, read_mcap_index
from mpap_cli.logs.files.chunked.compression import decompress
from mpap_cli.logs.files.mcap_files import mcap_records
from mpap_cli.logs.files.ros1_bags import bag_records
from mpap_cli.logs.files.salvaging.salvage_formats import scan_bag, scan_mcap
from mpap_cli.logs.reader import open_log
from tests.logs.files.mcaps import chunk_offsets, write_mcap
from tests.logs.rows import ROWS, SHUFFLED, WriteLog, stamps

KINDS = ["bag-none", "bag-lz4", "bag-bz2", "mcap-none", "mcap-zstd"]

HEAD_BYTES, ENTRY_BYTES = {"bag": 47, "mca": 15}, {"bag": 12, "mca": 16}


def indexes_of(path: Path) -> list[ChunkIndex | None]:
    """Return what is told of each chunk of a whole file."""
    read = read_mcap_index if path.suffix == ".mcap" else read_bag_index
    with path.open("rb") as stream:
        spans = (scan_mcap if path.suffix == ".mcap" else scan_bag)(stream).found.spans
        return [read(stream, span.offset) for span in spans]


def counts_of(index: ChunkIndex) -> list[int]:
    """Return how many messages each index record counts."""
    return list((index.span.n_messages or {}).values())


def unpacked_chunks(path: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Count the chunks that are unpacked to open a file without its end."""
    calls: list[str] = []

    def counted(compression: str, packed: bytes, size: int) -> tuple[bytes, str]:
        calls.append(compression)
        return decompress(compression, packed, size)

    for module in (bag_records, mcap_records):
        monkeypatch.setattr(module, "decompress", counted)
    with open_log(path):
        return len(calls)


@pytest.mark.parametrize("kind", KINDS)
def test_index_behind_each_chunk_is_read(write_log: WriteLog, kind: str) -> None:
    """Together they count every message, and every byte of the payloads or little more."""
    path = write_log(kind, ROWS)
    with open_log(path) as reader:
        messages = list(reader.messages(["/left", "/right"]))
        sizes = reader.topic_bytes()

    found = [index for index in indexes_of(path) if index is not None]

    counts: Counter[int] = Counter()
    for index in found:
        counts.update(index.span.n_messages)
    n_bytes = sum(len(message.payload) for message in messages)
    assert len(found) > 3
    assert counts.total() == len(ROWS)
    assert min(index.span.start_ns for index in found) == ROWS[0][1]
    assert sizes is not None
    assert n_bytes <= sum(sizes.values()) < n_bytes + 500


@pytest.mark.parametrize("kind", ["sqlite3", "sqlite3-file", "mcap-unchunked"])
def test_sizes_of_logs_without_chunks(write_log: WriteLog, kind: str) -> None:
    """They are exact."""
    path = write_log(kind, ROWS)
    expected: Counter[tuple[str, str]] = Counter()
    with open_log(path) as reader:
        for topic, _, payload in reader.messages(["/left", "/right"]):
            expected[topic.name, topic.msgtype] += len(payload)

        sizes = reader.topic_bytes()

    assert sizes == expected


@pytest.mark.parametrize("kind", KINDS)
def test_only_chunks_that_describe_topics_are_unpacked(
    write_log: WriteLog, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """Of a file that is cut off the rest is unpacked once, when it is read."""
    path = write_log(kind, ROWS)
    n_chunks = len(indexes_of(path))
    path.write_bytes(path.read_bytes()[:-300])

    n_unpacked = unpacked_chunks(path, monkeypatch)

    assert 0 < n_unpacked <= 4 < n_chunks


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rows", [ROWS, SHUFFLED], ids=["in order", "shuffled"])
def test_any_byte_of_an_index_may_be_wrong(
    write_log: WriteLog, kind: str, rows: list[tuple[str, int, str]]
) -> None:
    """No message is lost: the index is not believed, or it does not matter, or that is told."""
    path = write_log(kind, rows)
    index = next(one for one in indexes_of(path)[1:] if one is not None)
    content = path.read_bytes()[:-1]
    n_bytes = sum(HEAD_BYTES[kind[:3]] + ENTRY_BYTES[kind[:3]] * n for n in counts_of(index))

    for place in range(index.end - n_bytes, index.end):
        path.write_bytes(content[:place] + bytes([content[place] ^ 0x01]) + content[place + 1 :])
        with open_log(path) as reader:
            found = stamps(reader)
            told = [damage.kind for damage in reader.damage]
        assert len(found) >= len(rows) - ("chunk" in told)


def test_bounds_that_the_chunk_does_not_confirm(tmp_path: Path) -> None:
    """Then the chunk itself is looked at."""
    path = write_mcap(tmp_path / "log.mcap", [10, 20, 30], chunk_size=60)
    offset, _ = chunk_offsets(path)[0]
    content = bytearray(path.read_bytes())
    content[offset + 9 : offset + 17] = struct.pack("<Q", 5)
    path.write_bytes(content[:-1])

    with path.open("rb") as stream:
        index = read_mcap_index(stream, offset)

    with open_log(path) as reader:
        assert stamps(reader) == [10, 20, 30]
    assert index is None
