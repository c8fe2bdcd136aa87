"""Logs in stores that fsspec reads, here its memory, and URLs of this machine."""

import errno
import pickle
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

import fsspec
import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import LogPath, expand_paths, open_log
from mpap_cli.logs.remote import copying
from mpap_cli.logs.remote.paths import RemotePath
from mpap_cli.outputs.results_reader import describe_input
from tests.conftest import WriteLog

ROWS = [(topic, 10 * n, f"{topic} {n}") for n in range(1, 90) for topic in ("/scan", "/bump")]


@pytest.fixture
def memory() -> Iterator[Any]:
    """Return an empty store in memory."""
    store = fsspec.filesystem("memory")
    yield store
    store.store.clear()
    store.pseudo_dirs[:] = [""]


def stamps_of(path: LogPath) -> list[tuple[str, int]]:
    """Return name and stamp of every message."""
    with open_log(path) as reader:
        names = {topic.name for topic in reader.topics}
        return [(message.topic.name, message.stamp_ns) for message in reader.messages(names)]


def test_gives_the_messages_of_the_local_log(
    write_log: WriteLog, log_kind: str, memory: Any
) -> None:
    """Every container gives the same messages from a store."""
    log = write_log(log_kind, ROWS)
    memory.put(str(log), f"/day1/{log.name}", recursive=True)

    (path,) = expand_paths([f"memory://day1/{log.name}"])

    assert stamps_of(path) == stamps_of(log)


def test_finds_folders_and_files_by_patterns(write_log: WriteLog, memory: Any) -> None:
    """Patterns reach through folders; a metadata.yaml stands for its folder."""
    log = write_log("folder-mcap", ROWS)
    memory.put(str(log), "/a/log", recursive=True)
    memory.put(str(next(log.glob("*.mcap"))), "/b/c/other.mcap")

    folders = expand_paths(["memory://*/log"])
    named = expand_paths(["memory://a/log/metadata.yaml"])
    files = expand_paths(["memory://**/*.mcap", "memory://b/c/other.mca?"])

    assert [str(path) for path in folders] == ["memory://a/log"]
    assert stamps_of(folders[0]) == stamps_of(named[0]) == stamps_of(log)
    assert [path.name for path in files] == ["log.mcap", "other.mcap"]


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("memory://none.bag", "none.bag: cannot be read (not found)"),
        ("memory://a/x.bag", "x.bag: neither a ROS bag, a rosbag2"),
        ("abc://a/x.bag", "abc://a/x.bag: not a URL that can be read; use https://"),
        ("s3://a/*.bag", "s3://a/*.bag: cannot be listed (no credentials; set AWS_PROFILE"),
        ("s3://*/x.bag", "s3://*/x.bag: cannot be listed (the store cannot look that up)"),
        ("gs://a/x.bag", "gs://a/x.bag: what reads gs:// is not installed; install the"),
    ],
)
def test_says_what_cannot_be_read(
    word: str, text: str, memory: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line tells what was found and what to do."""
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", "/nowhere")
    monkeypatch.setitem(sys.modules, "gcsfs", None)
    memory.pipe("/a/x.bag", b"no log")

    with pytest.raises(LogError, match="^" + re.escape(text)):
        open_log(expand_paths([word])[0])


@pytest.mark.parametrize(
    ("word", "missing"),
    [
        ("memory://a/x.bag", ("upath", "fsspec", "aiohttp", "s3fs")),
        ("https://host/x.bag", ("upath", "fsspec", "aiohttp", "s3fs")),
        ("https://host/x.bag", ("aiohttp",)),
        ("s3://a/*.bag", ("upath", "fsspec", "aiohttp", "s3fs")),
    ],
)
def test_names_the_extra_that_is_missing(
    word: str, missing: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the extra a URL leads to what to install."""
    for module in missing:
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.delitem(sys.modules, "mpap_cli.logs.remote.http_store", raising=False)

    with pytest.raises(LogError, match=re.escape('pip install "mpap[remote]"')):
        open_log(expand_paths([word])[0])


def test_reads_local_logs_without_the_extra(
    write_log: WriteLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Logs on this machine need nothing of it, by path or by URL."""
    log = write_log("mcap-zstd", ROWS)
    log = log.rename(log.with_name("day 1.mcap"))
    for module in ("upath", "fsspec", "aiohttp", "s3fs"):
        monkeypatch.setitem(sys.modules, module, None)

    found = expand_paths([log.as_uri(), str(log), f"file://{log.parent}/*.mcap"])

    assert found == [log]
    assert stamps_of(found[0])


def test_a_store_that_gives_too_little_is_not_believed(
    write_log: WriteLog, memory: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Fewer bytes than the store says it has are an error, no shorter log."""
    log = write_log("mcap-none", ROWS)
    memory.put(str(log), "/log.mcap")
    whole = memory.info("/log.mcap")
    monkeypatch.setattr(type(memory), "info", lambda *_: whole | {"size": whole["size"] + 9})

    with pytest.raises(LogError, match="does not give the bytes that it says it has"):
        open_log(RemotePath("memory://log.mcap"))


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (PermissionError("https://secret"), "access refused; check the rights"),
        (ConnectionError("https://secret"), "the connection broke off, 2 attempts"),
        (OSError(5, "https://secret"), "input/output error"),
        (OSError("https://secret"), "the store reports an error"),
    ],
)
def test_says_why_a_store_refuses(
    error: OSError, text: str, memory: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the store writes in its errors may be secret and is left out."""

    def refuse(*_places: object) -> NoReturn:
        raise error

    monkeypatch.setattr(type(memory), "info", refuse)

    with pytest.raises(LogError, match=f"^log.mcap: cannot be read \\({text}\\)$"):
        open_log(RemotePath("memory://log.mcap"))


def test_a_file_without_a_size_is_copied(
    write_log: WriteLog, memory: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a store tells no size, the whole file is taken."""
    log = write_log("mcap-none", ROWS)
    memory.put(str(log), "/log.mcap")
    monkeypatch.setattr(type(memory), "info", lambda *_: {"type": "file", "size": None})

    found = stamps_of(RemotePath("memory://log.mcap"))

    assert found == stamps_of(log)


def test_a_folder_is_known_again_by_what_was_opened_in_it(write_log: WriteLog, memory: Any) -> None:
    """Size and digest are those of the files that were read; another content has others."""
    log = write_log("folder-mcap", ROWS)
    memory.put(str(log), "/log", recursive=True)
    memory.pipe("/log/notes.txt", b"not read")
    first, again, other = (RemotePath("memory://log") for _ in range(3))

    stamps_of(first)
    stamps_of(again)
    memory.put(str(log / "metadata.yaml"), "/log/metadata.yaml")
    stamps_of(other)

    described = [describe_input(path) for path in (first, again, other)]
    assert described[0] == described[1]
    assert described[0].size == sum(file.stat().st_size for file in log.iterdir())
    assert described[2].size == described[0].size
    assert described[2].sha256 != described[0].sha256


def test_tells_how_far_a_copy_is(
    write_log: WriteLog,
    memory: Any,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """A copy that takes long says now and then how much is done."""
    database = next(write_log("sqlite3", ROWS).glob("*.db3"))
    memory.put(str(database), "/log.db3")
    monkeypatch.setattr(copying, "TELL_EVERY_S", -1.0)
    caplog.set_level("INFO", "mpap_cli")

    stamps_of(RemotePath("memory://log.db3"))

    assert "log.db3: 0 MB copied (100%)" in caplog.messages


def test_says_where_there_is_no_room_for_a_copy(
    write_log: WriteLog, memory: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A full disk leads to the variable that names another folder."""
    database = next(write_log("sqlite3", ROWS).glob("*.db3"))
    memory.put(str(database), "/log.db3")

    def full(*_places: object) -> NoReturn:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(copying, "_copy", full)

    with pytest.raises(LogError, match=r"left on device.; name a folder with room in TMPDIR$"):
        open_log(RemotePath("memory://log.db3"))


def test_goes_to_other_processes_with_its_secrets() -> None:
    """A pickled path is the same; its text holds no user, password or query."""
    path = RemotePath("https://me:word@host/day%201/a.mcap?key=abc")

    copy = pickle.loads(pickle.dumps(path))  # noqa: S301  # made here

    assert copy == path
    assert copy.url == path.url
    assert (str(copy), copy.name) == ("https://host/day%201/a.mcap", "a.mcap")
    assert str(copy.parent / "b.mcap") == "https://host/day%201/b.mcap"
    assert (copy.parent / "b.mcap").url == "https://me:word@host/day%201/b.mcap?key=abc"


def test_local_urls_are_paths(tmp_path: Path) -> None:
    """What file:// names is read as any file of this machine."""
    with pytest.raises(LogError, match=r"none.bag: no such file or folder"):
        expand_paths([(tmp_path / "none.bag").as_uri()])
