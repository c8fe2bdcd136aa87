"""Only the chunks that hold a chosen topic are read out of a file and unpacked."""

from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.writer import CompressionType, Writer
from rosbags.rosbag1 import Writer as BagWriter

from mpap_cli.logs.files.chunked.compression import decompress
from mpap_cli.logs.files.mcap_files import mcap_records
from mpap_cli.logs.files.ros1_bags import bag_records
from mpap_cli.logs.reader import open_log

Write = Callable[[Path], Path]
N_CHUNKS, IN_TURN = 24, 3
MESSAGES = 10
CHUNK_BYTES = 4000
DEFINITION = "string data\n"


@pytest.fixture
def n_unpacked(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Collect the sizes of the chunks that are unpacked."""
    sizes: list[int] = []

    def counted(compression: str, packed: bytes, size: int) -> tuple[bytes, str]:
        sizes.append(size)
        return decompress(compression, packed, size)

    for module in (mcap_records, bag_records):
        monkeypatch.setattr(module, "decompress", counted)
    return sizes


def payload(number: int) -> bytes:
    """Return a message that fills a tenth of a chunk."""
    return b"\0\1\0\0" + number.to_bytes(4, "little") * (CHUNK_BYTES // MESSAGES // 4)


def write_mcap(path: Path) -> Path:
    """Write three chunks of one topic, then three of the next, and so on."""
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
        writer.start()
        channels = [writer.register_channel(f"/{name}", "cdr", 0) for name in "abcd"]
        for number in range(N_CHUNKS * MESSAGES):
            channel = channels[number // (IN_TURN * MESSAGES) % len(channels)]
            writer.add_message(channel, 10**18 + number, payload(number), 10**18 + number)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path


def write_bag(path: Path) -> Path:
    """Write the same into a bag."""
    bag = BagWriter(path)
    bag.set_compression(BagWriter.CompressionFormat.LZ4)
    bag.chunk_threshold = CHUNK_BYTES
    with bag:
        connections = [
            bag.add_connection(f"/{name}", "a_msgs/msg/A", msgdef=DEFINITION, md5sum="0" * 32)
            for name in "abcd"
        ]
        for number in range(N_CHUNKS * MESSAGES):
            connection = connections[number // (IN_TURN * MESSAGES) % len(connections)]
            bag.write(connection, 10**18 + number, payload(number))
    return path


@pytest.mark.parametrize(("write", "name"), [(write_mcap, "log.mcap"), (write_bag, "log.bag")])
@pytest.mark.parametrize(("topics", "share"), [("a", 4), ("bd", 2), ("abcd", 1)])
def test_chunks_of_other_topics_stay_packed(
    n_unpacked: list[int], tmp_path: Path, write: Write, name: str, topics: str, share: int
) -> None:
    """However many topics are chosen, each of their chunks is unpacked once.

    Chunks do not end exactly where a topic does, so a few hold two.
    """
    path = write(tmp_path / name)

    with open_log(path) as reader:
        found = list(reader.messages([f"/{topic}" for topic in topics]))
        n_chosen = len(n_unpacked)
        everything = list(reader.messages([f"/{topic}" for topic in "abcd"]))

    n_all = len(n_unpacked) - n_chosen
    assert len(found) * share == len(everything) == N_CHUNKS * MESSAGES
    assert n_all >= N_CHUNKS
    assert n_all // share <= n_chosen <= n_all // share + 4
