"""Logs on a web server: the same messages as from the disk, and few bytes."""

import logging
import re
import tempfile
from pathlib import Path

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import expand_paths, open_log
from tests.conftest import WriteLog
from tests.logs.remote.conftest import Serve
from tests.logs.remote.served import ROWS, big_rows, messages_of, remote


@pytest.mark.parametrize("has_ranges", [True, False])
def test_gives_the_messages_of_the_local_log(
    write_log: WriteLog, log_kind: str, serve: Serve, has_ranges: bool
) -> None:
    """Every container gives the same messages by URL, with or without ranges."""
    log = write_log(log_kind, ROWS)
    server = serve(log.parent, has_ranges=has_ranges)

    found = messages_of(remote(server, log.name))

    assert found == messages_of(log)


@pytest.mark.parametrize("kind", ["mcap-none", "bag-none"])
def test_fetches_the_chosen_chunks_only(write_log: WriteLog, serve: Serve, kind: str) -> None:
    """Scans of a log full of images are read without the images."""
    log = write_log(kind, big_rows())
    server = serve(log.parent)

    found = messages_of(remote(server, log.name), "/scan")

    assert found == messages_of(log, "/scan")
    assert log.stat().st_size > 4_000_000
    assert server.n_bytes < 0.05 * log.stat().st_size


def test_opens_a_log_by_its_summary(write_log: WriteLog, serve: Serve) -> None:
    """Topics and times of an MCAP file take two requests."""
    log = write_log("mcap-none", big_rows())
    server = serve(log.parent)

    with open_log(remote(server, log.name)) as reader:
        n_messages = reader.n_messages

    assert n_messages == 50
    assert len(server.asked) == 2


def test_tells_what_was_fetched(
    write_log: WriteLog, serve: Serve, caplog: pytest.LogCaptureFixture
) -> None:
    """The bytes and requests are told at the end, for those who want to know."""
    log = write_log("mcap-none", big_rows())
    server = serve(log.parent)
    path = remote(server, log.name)
    caplog.set_level(logging.DEBUG, "mpap_cli")

    messages_of(path, "/scan")

    size = log.stat().st_size
    expected = f"log.mcap: {server.n_bytes:,} of {size:,} bytes fetched in {len(server.asked)}"
    assert expected in caplog.text


@pytest.mark.parametrize("kind", ["sqlite3", "mcap-no-summary"])
def test_copies_what_cannot_be_read_by_ranges(
    write_log: WriteLog,
    serve: Serve,
    kind: str,
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """A database, or a file without an index, is copied once; the copy is gone in the end."""
    log = write_log(kind, ROWS)
    aside = tmp_path / "aside"
    aside.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(aside))
    server = serve(log.parent)
    caplog.set_level(logging.INFO, "mpap_cli")

    messages_of(remote(server, log.name))

    size = next(one for one in (log, *log.parent.rglob("*.db3")) if one.is_file()).stat().st_size
    assert f"copied to a temporary folder first ({size / 1e6:.1f} MB)" in caplog.text
    assert caplog.text.count("copied to") == 1
    assert size < server.n_bytes < size + 2 * 16384 + 4096
    assert not list(aside.iterdir())


def test_reads_what_a_recorder_left_beside_a_database(write_log: WriteLog, serve: Serve) -> None:
    """A -wal beside a database on the server is fetched with it."""
    database = next(write_log("sqlite3", ROWS).glob("*.db3"))
    database.with_name(database.name + "-wal").write_bytes(bytes(100))
    server = serve(database.parent)

    with open_log(remote(server, database.name)) as reader:
        warnings = list(reader.warnings)

    assert any("recording not finished" in text for text in warnings)


def test_uses_the_whole_messages_of_a_cut_file(write_log: WriteLog, serve: Serve) -> None:
    """A file that was cut off is salvaged as on the disk, with the same words."""
    log = write_log("mcap-zstd", ROWS)
    log.write_bytes(log.read_bytes()[:-5000])
    server = serve(log.parent)

    with open_log(remote(server, log.name)) as reader, open_log(log) as local:
        found = len(list(reader.messages({"/scan"})))
        expected = len(list(local.messages({"/scan"})))

    assert found == expected > 0
    assert reader.damage == local.damage != []


def test_finds_logs_by_a_pattern(write_log: WriteLog, serve: Serve) -> None:
    """A pattern stands for the files that a page links to, by name."""
    log = write_log("mcap-zstd", ROWS)
    for name in ("b.mcap", "a.mcap", "c.bag"):
        (log.parent / name).write_bytes(log.read_bytes())
    log.unlink()
    server = serve(log.parent.parent)

    found = expand_paths([f"{server.url}/{log.parent.name}/*.mcap"])

    assert [path.name for path in found] == ["a.mcap", "b.mcap"]
    assert messages_of(found[0]) == messages_of(log.parent / "a.mcap")


def test_says_that_a_pattern_matches_nothing(tmp_path: Path, serve: Serve) -> None:
    """The error names the pattern."""
    server = serve(tmp_path)

    with pytest.raises(LogError, match=re.escape("/*.mcap: matches no file or folder")):
        expand_paths([f"{server.url}/*.mcap"])
