"""Broken databases: rows come out of the pages, whatever became of the tree."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
import zstandard

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunked.chunks import BrokenRecordError
from mpap_cli.logs.files.databases.saved_rows import find_saved_rows
from mpap_cli.logs.reader import open_log
from tests.logs.files.databases.broken_rows import LENGTHS, PAGE_BYTES, ROWS, STAMPS
from tests.logs.rows import WriteLog, stamps


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7, 0.9, 0.99])
def test_database_cut_anywhere_keeps_whole_rows(database: Path, share: float) -> None:
    """About as many rows as bytes; all of them sound, in time order."""
    content = database.read_bytes()
    database.write_bytes(content[: int(share * len(content))])

    with open_log(database) as reader:
        found = stamps(reader)
        payloads = {len(message.payload) for message in reader.messages(["/left", "/right"])}

    assert found == sorted(found)
    assert set(found) <= set(STAMPS)
    assert len(found) > (share - 0.15) * len(ROWS)
    assert payloads == {4 + 4 + length + 1 for length in LENGTHS}
    assert [(damage.kind, damage.count) for damage in reader.damage] == [("database", len(found))]
    assert f"the {len(found):,} whole messages found are used" in reader.damage[0].text
    with pytest.raises(LogError, match="without --strict"):
        open_log(database, strict=True)


def test_packed_database_that_was_cut_before(database: Path) -> None:
    """It is unpacked and repaired in the same temporary folder."""
    content = database.read_bytes()
    packed = database.with_suffix(".db3.zstd")
    packed.write_bytes(zstandard.compress(content[: len(content) // 2]))

    with open_log(packed) as reader:
        found = stamps(reader)

    assert 0 < len(found) == reader.n_messages
    assert [damage.kind for damage in reader.damage] == ["database"]


def test_folder_of_a_cut_database(database: Path) -> None:
    """metadata.yaml counts what is not there; only the damage is told."""
    content = database.read_bytes()
    database.write_bytes(content[: len(content) // 2])

    with open_log(database.parent) as reader:
        found = stamps(reader)

    assert 0 < len(found) == reader.n_messages == sum(t.n_messages for t in reader.topics)
    assert reader.warnings == []


def test_page_that_breaks_while_reading(database: Path) -> None:
    """Messages before it, and after it, come once and in order."""
    content = bytearray(database.read_bytes())
    leaves = [
        place for place in range(PAGE_BYTES, len(content), PAGE_BYTES) if content[place] == 0x0D
    ]
    middle = leaves[len(leaves) // 2]
    content[middle : middle + 100] = b"\xff" * 100
    database.write_bytes(content)

    with open_log(database) as reader:
        found = stamps(reader)

    assert found == sorted(set(found))
    assert len(ROWS) - 30 < len(found) < len(ROWS)
    assert [damage.kind for damage in reader.damage] == ["database"]


def test_equal_stamps_around_the_break_come_once(write_log: WriteLog) -> None:
    """Reading goes on behind the messages that were given out."""
    path = write_log("sqlite3", [("/left", 7, f"{n:0300}") for n in range(400)]) / "log.db3"
    content = bytearray(path.read_bytes())
    leaves = [p for p in range(PAGE_BYTES, len(content), PAGE_BYTES) if content[p] == 0x0D]
    content[leaves[-2] : leaves[-2] + 100] = b"\xff" * 100
    path.write_bytes(content)

    with open_log(path) as reader:
        found = [message.payload for message in reader.messages(["/left"])]

    assert found == sorted(set(found))
    assert 350 < len(found) < 400


def test_index_that_is_out_of_order(database: Path) -> None:
    """The rows are right, the order of the index is not."""
    with closing(sqlite3.connect(database)) as opened:
        opened.execute("PRAGMA writable_schema = ON")
        opened.execute(
            "UPDATE sqlite_schema SET sql = replace(sql, 'ASC', 'DESC') WHERE type = 'index'"
        )
        opened.commit()

    with open_log(database) as reader:
        found = stamps(reader)

    assert found == STAMPS
    assert [damage.kind for damage in reader.damage] == ["database"]


def test_database_without_topics(database: Path) -> None:
    """Messages alone cannot be told apart."""
    content = database.read_bytes()
    database.write_bytes(content[:PAGE_BYTES])

    with pytest.raises(LogError, match=r"log\.db3: the database is broken .* topics is lost"):
        open_log(database)


@pytest.mark.parametrize("header", [b"", b"SQLite format 3\x00" + bytes(84)])
def test_header_of_a_database_that_is_broken(tmp_path: Path, header: bytes) -> None:
    """Without the size of a page nothing can be found."""
    path = tmp_path / "log.db3"
    path.write_bytes(header)

    with pytest.raises(BrokenRecordError, match="the header of the database is broken"):
        find_saved_rows(path)


def index_leaf(content: bytearray) -> int:
    """Return where a page of the index of stamps begins."""
    return next(p for p in range(0, len(content), PAGE_BYTES) if content[p] == 0x0A)


def test_stamp_that_differs_in_the_index(database: Path) -> None:
    """The row has the right one, and is given out with it."""
    content = bytearray(database.read_bytes())
    leaf = index_leaf(content)
    place = next(
        at
        for stamp in STAMPS
        if (at := content.find(stamp.to_bytes(8, "big"), leaf, leaf + PAGE_BYTES)) > 0
    )
    content[place + 7] ^= 0x80
    database.write_bytes(content)

    with open_log(database) as reader:
        found = stamps(reader)

    assert found == STAMPS
    assert [damage.kind for damage in reader.damage] == ["database"]
    assert "its index of stamps is broken" in reader.damage[0].text


def test_stamp_that_differs_in_the_row(database: Path) -> None:
    """A message that is suddenly the first of all is found before the others are given out."""
    content = bytearray(database.read_bytes())
    changed = len(STAMPS) // 2
    text = STAMPS[changed].to_bytes(8, "big")
    leaves = (p for p in range(0, len(content), PAGE_BYTES) if content[p] == 0x0D)
    places = (content.find(text, leaf, leaf + PAGE_BYTES) for leaf in leaves)
    content[next(place for place in places if place > 0)] ^= 0x08
    database.write_bytes(content)

    with open_log(database) as reader:
        found = stamps(reader)

    others = STAMPS[:changed] + STAMPS[changed + 1 :]
    assert found == [STAMPS[changed] - (8 << 56), *others]
    assert [damage.kind for damage in reader.damage] == ["database"]


@pytest.mark.parametrize("whole", [True, False], ids=["folder", "file"])
def test_message_that_the_index_has_lost(database: Path, whole: bool) -> None:
    """The index is not believed, be the messages counted or not."""
    content = bytearray(database.read_bytes())
    content[index_leaf(content) + 4] -= 1
    database.write_bytes(content)

    with open_log(database.parent if whole else database) as reader:
        found = stamps(reader)

    assert found == STAMPS
    assert [damage.kind for damage in reader.damage] == ["database"]
