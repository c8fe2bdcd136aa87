"""Results appear whole or not at all."""

import errno
import hashlib
import json
import logging
import os
from pathlib import Path

import pytest

from mpap_cli.errors import OutputError
from mpap_cli.outputs import publishing, results_folder
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, read_results


def save(out: Path, texts: dict[str, str], settings: dict[str, str] | None = None) -> Path:
    """Run a command that writes these texts."""
    with ResultsFolder(out, "learn") as results:
        for name, text in texts.items():
            results.path(name).write_text(text)
        results.commit(settings or {}, [InputFile("day1.bag", 3, "ab")], seed=7)
    return results.folder


def tree(folder: Path) -> dict[str, str]:
    """Return every file below a folder with its content."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_text() for path in files}


def test_commit_leaves_outputs_and_settings_only(tmp_path: Path) -> None:
    """After a commit OUT holds the outputs and settings.json, nothing hidden."""
    out = tmp_path / "new" / "out"

    save(out, {"clusters.csv": "a\n", "images/1.txt": "x"})

    assert set(tree(out)) == {
        "learn/clusters.csv",
        "learn/images/1.txt",
        "learn/settings.json",
    }


def test_settings_tell_what_was_read_and_written(tmp_path: Path) -> None:
    """settings.json holds version, seed, settings, inputs and the hash of each output."""
    folder = save(tmp_path, {"clusters.csv": "a\n"}, {"theta": "0.1", "bins": "6"})

    record = json.loads((folder / "settings.json").read_text())

    assert list(record) == [
        "mpap",
        "command",
        "seed",
        "settings",
        "inputs",
        "warnings",
        "outputs",
    ]
    assert record["seed"] == 7
    assert list(record["settings"]) == ["bins", "theta"]
    assert record["inputs"] == [{"name": "day1.bag", "size": 3, "sha256": "ab"}]
    assert record["outputs"] == {"clusters.csv": hashlib.sha256(b"a\n").hexdigest()}


def test_settings_keep_what_was_warned_of(tmp_path: Path) -> None:
    """Each warning of the run once, whatever was said before it or is not a warning."""
    logger = logging.getLogger("mpap_cli.logs")
    logger.warning("before")
    with ResultsFolder(tmp_path, "learn") as results:
        for text in ("b.bag is cut", "a.bag is cut", "b.bag is cut"):
            logger.warning(text)
        logger.info("not worth keeping")
        results.commit({}, [])
    logger.warning("after")

    kept = read_results(tmp_path / "learn").warnings

    assert kept == ("a.bag is cut", "b.bag is cut")
    assert logging.getLogger("mpap_cli").handlers == []


def test_same_results_give_the_same_bytes(tmp_path: Path) -> None:
    """Nothing of time or place enters settings.json."""
    first = save(tmp_path / "a", {"clusters.csv": "a\n"})
    second = save(tmp_path / "b" / "c", {"clusters.csv": "a\n"})

    assert tree(first) == tree(second)


def test_files_of_the_older_run_go(tmp_path: Path) -> None:
    """What an older run wrote and the new one does not is removed, with its empty folders."""
    folder = save(tmp_path, {"clusters.csv": "old", "images/a/1.txt": "old", "roc.png": "old"})
    (folder / "notes.txt").write_text("mine")

    save(tmp_path, {"clusters.csv": "new"})

    assert set(tree(folder)) == {"clusters.csv", "settings.json", "notes.txt"}
    assert not (folder / "images").exists()
    assert read_results(folder).path("clusters.csv").read_text() == "new"


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_failure_keeps_the_older_results(tmp_path: Path, error: type[BaseException]) -> None:
    """A run that fails or is interrupted changes nothing and leaves nothing."""
    save(tmp_path, {"clusters.csv": "old"})
    before = tree(tmp_path)

    def fail() -> None:
        with ResultsFolder(tmp_path, "learn") as results:
            results.path("clusters.csv").write_text("new")
            raise error

    with pytest.raises(error):
        fail()

    assert tree(tmp_path) == before


def test_first_failure_leaves_no_folder(tmp_path: Path) -> None:
    """A first run that fails does not even leave OUT."""
    out = tmp_path / "out"

    with pytest.raises(ValueError, match="no"), ResultsFolder(out, "learn"):
        raise ValueError("no")  # noqa: EM101

    assert not out.exists()


def test_interrupt_during_the_commit_finishes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C between two renames still leaves one whole set."""
    folder = save(tmp_path, {"a.csv": "old", "b.csv": "old", "c.csv": "old"})
    calls = 0
    move = publishing._move

    def interrupted(staging: Path, folder: Path, name: str) -> None:
        nonlocal calls
        calls += 1
        if calls == 2:
            raise KeyboardInterrupt
        move(staging, folder, name)

    monkeypatch.setattr(publishing, "_move", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save(tmp_path, {"a.csv": "new", "b.csv": "new"})

    assert tree(folder).keys() == {"a.csv", "b.csv", "settings.json"}
    assert read_results(folder).path("b.csv").read_text() == "new"


@pytest.mark.parametrize("blocked", ["out", "out/learn", "out/.learn.unfinished"])
def test_file_in_the_way_is_named(tmp_path: Path, blocked: str) -> None:
    """A file where a folder must be is one line, and it stays."""
    place = tmp_path / blocked
    place.parent.mkdir(exist_ok=True)
    place.write_text("mine")

    with pytest.raises(OutputError, match=r"learn: cannot be written .*choose another --out"):
        save(tmp_path / "out", {"clusters.csv": "a"})

    assert place.read_text() == "mine"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_read_only_folder_is_named(tmp_path: Path) -> None:
    """A folder without the right to write is one line."""
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(OutputError, match="permission denied"):
            save(tmp_path, {"clusters.csv": "a"})
    finally:
        tmp_path.chmod(0o700)


def test_read_only_older_results_are_found_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That the results cannot be replaced is told at the start."""
    save(tmp_path, {"clusters.csv": "a"})
    monkeypatch.setattr(os, "access", lambda *_: False)

    with pytest.raises(OutputError, match="permission denied"), ResultsFolder(tmp_path, "learn"):
        pass


def test_full_disk_is_one_line(tmp_path: Path) -> None:
    """A disk that fills up while outputs are written is told like an unwritable OUT."""
    full = OSError(errno.ENOSPC, "No space left on device")

    with (
        pytest.raises(OutputError, match="no space left on device"),
        ResultsFolder(tmp_path, "learn"),
    ):
        raise full

    assert tree(tmp_path) == {}


@pytest.mark.parametrize("failing", ["sha256_of", "publish"])
def test_failure_of_the_commit_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    """An error of the file system during the commit is an OutputError."""

    def fail(*_: object) -> None:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(results_folder, failing, fail)

    with pytest.raises(OutputError, match="input/output error"):
        save(tmp_path, {"clusters.csv": "a"})


@pytest.mark.parametrize("name", ["../a.csv", "/a.csv", "settings.json", "", ".", "a//b", "a\\b"])
def test_outputs_stay_in_their_folder(tmp_path: Path, name: str) -> None:
    """A name that leads elsewhere, or is the one of the settings, is refused."""
    with pytest.raises(ValueError, match="no name"), ResultsFolder(tmp_path, "learn") as results:
        results.path(name)


def test_folder_of_an_output_in_the_way_is_one_line(tmp_path: Path) -> None:
    """An output cannot lie below another one."""
    with ResultsFolder(tmp_path, "learn") as results:
        results.path("a").write_text("file")

        with pytest.raises(OutputError, match="cannot be written"):
            results.path("a/b")
