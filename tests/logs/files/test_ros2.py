"""rosbag2 folders: metadata.yaml that fits, is missing, stale or broken; splits."""

import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import open_log
from tests.logs.rows import ROWS, Rows, WriteLog, stamps, storage

STAMPS = [row[1] for row in ROWS]
FOLDERS = {"sqlite3": "log.db3", "folder-mcap": "log.mcap"}


@pytest.fixture(params=list(FOLDERS))
def folder(request: pytest.FixtureRequest, write_log: WriteLog) -> Path:
    """Return a folder of each storage."""
    return write_log(request.param, ROWS)


def split(write_log: WriteLog, kind: str, parts: Sequence[Rows]) -> Path:
    """Write a folder of several files without metadata.yaml."""
    first, *others = [write_log(kind, rows) for rows in parts]
    (first / "metadata.yaml").unlink()
    for number, other in enumerate(others):
        source = storage(other)
        source.rename(first / f"part_{number}{source.suffix}")
    return first


def test_metadata_stands_for_its_folder(folder: Path) -> None:
    """Both ways to name a log give the same."""
    with open_log(folder / "metadata.yaml") as reader:
        found = stamps(reader)

    assert found == STAMPS
    assert reader.path.name == "log"
    assert reader.warnings == []


def test_folder_named_like_a_bag(folder: Path) -> None:
    """The name of a folder says nothing."""
    with open_log(folder.rename(folder.with_name("drive.bag"))) as reader:
        found = stamps(reader)

    assert found == STAMPS


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        (None, "metadata.yaml is missing"),
        ("", "metadata.yaml cannot be understood"),
        ("a: [b", "metadata.yaml cannot be understood"),
        ("[" * 500, "metadata.yaml cannot be understood"),
        ("rosbag2_bagfile_information: 5", "metadata.yaml cannot be understood"),
        ("rosbag2_bagfile_information: {version: 9}", "metadata.yaml cannot be understood"),
    ],
)
def test_metadata_that_does_not_help(folder: Path, text: str | None, warning: str) -> None:
    """The file beside it is read, with a warning."""
    metadata = folder / "metadata.yaml"
    metadata.unlink()
    if text is not None:
        metadata.write_text(text)

    with open_log(folder) as reader:
        found = stamps(reader)

    assert found == STAMPS
    assert reader.warnings == [f"log: {warning}"]


def test_metadata_that_cannot_be_decoded(folder: Path) -> None:
    """Bytes that are no text are told like other faults."""
    (folder / "metadata.yaml").write_bytes(b"\xff\xfe\xff")

    with open_log(folder) as reader:
        found = stamps(reader)

    assert found == STAMPS
    assert "metadata.yaml cannot be read" in reader.warnings[0]


def test_stale_metadata(folder: Path) -> None:
    """It names a file that was renamed: what is there is read, with a warning."""
    source = storage(folder)
    source.rename(folder / f"renamed{source.suffix}")

    with open_log(folder) as reader:
        found = stamps(reader)

    assert found == STAMPS
    name = f"renamed{source.suffix}"
    text = f"log: metadata.yaml names {source.name}, which is not there; reading {name}"
    assert reader.warnings == [text]


def test_metadata_that_counts_otherwise(folder: Path) -> None:
    """The files are right, with a warning."""
    metadata = folder / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("message_count: 40", "message_count: 41"))

    with open_log(folder) as reader:
        counts = [topic.n_messages for topic in reader.topics]

    assert counts == [40, 20]
    assert reader.warnings == ["log: metadata.yaml counts 61 messages, the files hold 60"]


def test_metadata_chooses_among_files(folder: Path) -> None:
    """What it does not name, here a copy, is not read."""
    source = storage(folder)
    shutil.copy(source, folder / f"copy{source.suffix}")

    with open_log(folder) as reader:
        found = stamps(reader)

    assert found == STAMPS


def test_folder_with_two_kinds_and_no_metadata(write_log: WriteLog) -> None:
    """Likely one is the other converted; the user must say which."""
    folder = write_log("sqlite3", ROWS)
    storage(write_log("folder-mcap", ROWS)).rename(folder / "log.mcap")
    (folder / "metadata.yaml").unlink()

    with pytest.raises(LogError, match=r"holds both \.db3 and \.mcap files; name one"):
        open_log(folder)


def test_folder_without_log(tmp_path: Path) -> None:
    """Not a rosbag2 folder."""
    (tmp_path / "notes.txt").write_text("Dear diary")

    with pytest.raises(LogError, match=r"no \.db3 or \.mcap file in this folder"):
        open_log(tmp_path)


def test_file_without_suffix_is_found(folder: Path) -> None:
    """First bytes decide, also in a folder."""
    storage(folder).rename(folder / "part_0")
    (folder / "metadata.yaml").unlink()

    with open_log(folder) as reader:
        found = stamps(reader)

    assert found == STAMPS


@pytest.mark.parametrize("kind", list(FOLDERS))
def test_splits_are_one_log(write_log: WriteLog, kind: str) -> None:
    """In time order even where the files overlap; topics are summed."""
    folder = split(write_log, kind, [ROWS[40:], ROWS[0:25:2], ROWS[1:25:2], ROWS[25:40]])

    with open_log(folder) as reader:
        found = stamps(reader)
        window = list(reader.messages(["/left"], STAMPS[30], STAMPS[35]))

    assert found == STAMPS
    assert [(topic.name, topic.n_messages) for topic in reader.topics] == [
        ("/left", 40),
        ("/right", 20),
    ]
    assert {message.topic for message in window} == {reader.topics[0]}
    assert [message.stamp_ns for message in window] == [
        row[1] for row in ROWS[30:35] if row[0] == "/left"
    ]


@pytest.mark.parametrize("kind", list(FOLDERS))
def test_broken_split_is_left_out(write_log: WriteLog, kind: str) -> None:
    """The others are read; read strictly it is an error."""
    folder = split(write_log, kind, [ROWS[:30], ROWS[30:]])
    empty = folder / f"part_0{storage(folder).suffix}"
    empty.write_bytes(b"")

    with open_log(folder) as reader:
        found = stamps(reader)

    assert found == STAMPS[:30]
    assert [(damage.kind, damage.count) for damage in reader.damage] == [("file", 1)]
    assert f"1 of 2 files left out ({empty.name}: the file is empty)" in reader.damage[0].text
    with pytest.raises(LogError, match="1 of 2 files left out"):
        open_log(folder, strict=True)


def test_folder_of_an_empty_file(folder: Path) -> None:
    """Nothing is left to read."""
    storage(folder).write_bytes(b"")

    with pytest.raises(LogError, match="the file is empty"):
        open_log(folder)
