"""First bytes decide what a file is; every path that is no log gives one line."""

import tempfile
from pathlib import Path

import pytest
import zstandard

from mpap_cli.errors import LogError
from mpap_cli.logs.files import containers
from mpap_cli.logs.reader import READERS, open_log
from tests.logs.rows import IN_ORDER, SHUFFLED, WriteLog, read


@pytest.mark.parametrize(
    ("kind", "container"),
    [
        ("bag-lz4", "bag"),
        ("mcap-zstd", "mcap"),
        ("sqlite3-file", "rosbag2/sqlite3"),
        ("folder-mcap-file", "rosbag2/mcap"),
    ],
)
def test_container_is_named(write_log: WriteLog, kind: str, container: str) -> None:
    """By the files inside, packed or not."""
    with open_log(write_log(kind, SHUFFLED)) as reader:
        found = reader.container

    assert found == container


@pytest.mark.parametrize("kind", ["bag-none", "mcap-lz4"])
def test_first_bytes_decide_not_the_suffix(write_log: WriteLog, kind: str) -> None:
    """A log is read under whatever name."""
    path = write_log(kind, SHUFFLED)
    renamed = path.rename(path.with_name("log.db3"))

    with open_log(renamed) as reader:
        found = read(reader)

    assert found == IN_ORDER


def test_bare_database_is_read(write_log: WriteLog) -> None:
    """A .db3 taken out of its folder, also where its messages are packed one by one."""
    for kind in ("sqlite3", "sqlite3-message"):
        path = write_log(kind, SHUFFLED) / "log.db3"

        with open_log(path) as reader:
            found = read(reader)

        assert found == IN_ORDER
        assert reader.container == "sqlite3"


@pytest.mark.parametrize("kind", ["sqlite3-file", "folder-mcap-file"])
def test_packed_file_is_said_to_be_unpacked(write_log: WriteLog, kind: str) -> None:
    """It needs room on the disk."""
    with open_log(write_log(kind, SHUFFLED)) as reader:
        found = reader.warnings

    assert len(found) == 1
    assert "unpacked to a temporary folder" in found[0]


def test_every_container_has_a_reader() -> None:
    """The table names all containers of single files."""
    assert set(READERS) == {"bag", "mcap", "sqlite3"}


@pytest.mark.parametrize(
    ("name", "content", "text"),
    [
        ("zero.bag", b"", r"^zero\.bag: the file is empty$"),
        ("zero.mcap", b"", "the file is empty"),
        ("zero.db3", b"", "the file is empty"),
        ("a.bag", b"version https://git-lfs.github.com/spec/v1\noid", "git lfs pull"),
        ("notes.txt", b"Dear diary", "neither a ROS bag, a rosbag2 database nor an MCAP file"),
        ("x.db3", b"SQLite format 3\x00 and no more", "the database is broken"),
        ("x.mcap.zstd", b"\x28\xb5\x2f\xfd and no more", "zstd cannot unpack it"),
    ],
)
def test_file_that_is_no_log(tmp_path: Path, name: str, content: bytes, text: str) -> None:
    """One line that names the file and the reason."""
    path = tmp_path / name
    path.write_bytes(content)

    with pytest.raises(LogError, match=text) as raised:
        open_log(path)

    assert "\n" not in str(raised.value)


def test_missing_file(tmp_path: Path) -> None:
    """The path is named as it was given."""
    with pytest.raises(LogError, match=r"gone\.bag: no such file or directory"):
        open_log(tmp_path / "gone.bag")


def test_log_that_disappears_while_it_is_read(write_log: WriteLog) -> None:
    """It is an error of the log, not of the program."""
    path = write_log("bag-none", SHUFFLED)

    with open_log(path) as reader:
        path.unlink()
        with pytest.raises(LogError, match="cannot be read any more"):
            read(reader)


def test_file_packed_twice(write_log: WriteLog, tmp_path: Path) -> None:
    """Nobody does that on purpose."""
    packed = zstandard.compress(zstandard.compress(write_log("mcap-none", SHUFFLED).read_bytes()))
    path = tmp_path / "log.mcap.zstd"
    path.write_bytes(packed)

    with pytest.raises(LogError, match="packed twice"):
        open_log(path)


def test_packed_file_that_is_cut(write_log: WriteLog) -> None:
    """What comes out is read."""
    folder = write_log("folder-mcap-file", SHUFFLED * 200)
    path = folder / "log.mcap.zstd"
    path.write_bytes(path.read_bytes()[:-400])

    with open_log(path) as reader:
        n_found = sum(1 for _ in reader.messages(["/left"]))

    assert n_found > 1000
    assert [damage.kind for damage in reader.damage] == ["packed", "truncated"]


def test_packed_file_with_a_broken_block(write_log: WriteLog) -> None:
    """What was packed before it is read, to the last byte."""
    folder = write_log("folder-mcap-file", SHUFFLED * 200)
    path = folder / "log.mcap.zstd"
    content = zstandard.ZstdDecompressor().decompressobj().decompress(path.read_bytes())
    packed = bytearray(zstandard.ZstdCompressor(write_content_size=False).compress(content))
    packed[-9:] = b"\xff" * 9
    path.write_bytes(packed)

    with open_log(path) as reader:
        kinds = [damage.kind for damage in reader.damage]
        n_found = sum(1 for _ in reader.messages(["/left"]))

    assert n_found > 1000
    assert kinds[0] == "packed"


def test_packed_file_that_unpacks_without_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No log shrinks that much; the disk is not filled with it."""
    monkeypatch.setattr(containers, "MAX_CHUNK_BYTES", 1 << 20)
    path = tmp_path / "log.mcap.zstd"
    path.write_bytes(zstandard.compress(bytes(1 << 26)))

    with pytest.raises(LogError, match=r"log\.mcap\.zstd: unpacks to over .* no log does"):
        open_log(path)


def test_no_room_for_unpacking(
    write_log: WriteLog, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The error names the way out."""
    path = write_log("sqlite3-file", SHUFFLED)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))

    with pytest.raises(LogError, match=r"temporary folder: .*TMPDIR"):
        open_log(path)
