"""One run at a time writes into a results folder."""

import errno
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mpap_cli.errors import OutputError
from mpap_cli.outputs.folder_lock import FolderLock
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import read_results

HOLDER = """
import sys
from pathlib import Path
from mpap_cli.outputs.results_folder import ResultsFolder
with ResultsFolder(Path(sys.argv[1]), "learn") as results:
    results.path("clusters.csv").write_text("half")
    print("holding", flush=True)
    sys.stdin.read()
"""


def save(out: Path, text: str) -> None:
    """Run a command that writes this text."""
    with ResultsFolder(out, "learn") as results:
        results.path("clusters.csv").write_text(text)
        results.commit({}, [])


def files(folder: Path) -> set[str]:
    """Return the names of all files below a folder."""
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix() for path in paths}


def hold(out: Path) -> "subprocess.Popen[str]":
    """Start a run that stays in the middle of its work."""
    process = subprocess.Popen(  # noqa: S603  # this interpreter, this text
        [sys.executable, "-c", HOLDER, str(out)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "holding\n"
    return process


def test_second_run_is_named(tmp_path: Path) -> None:
    """While one run writes, another is told its process; other commands may run."""
    process = hold(tmp_path)
    try:
        with pytest.raises(OutputError, match=rf"another run .*process {process.pid} on .*--out"):
            save(tmp_path, "a")
        with ResultsFolder(tmp_path, "evaluate"):
            pass
    finally:
        process.communicate("")


def test_killed_run_locks_nobody_out(tmp_path: Path) -> None:
    """The lock and the half-written files of a killed run are gone with the next run."""
    save(tmp_path, "old")
    process = hold(tmp_path)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert len(files(tmp_path)) == 4
    assert read_results(tmp_path / "learn").path("clusters.csv").read_text() == "old"

    save(tmp_path, "new")

    assert files(tmp_path) == {"learn/clusters.csv", "learn/settings.json"}


def test_lock_of_a_finished_run_is_not_mistaken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A lock file removed between opening and locking is not taken for the current one."""
    real_flock, calls = FolderLock._is_current, 0

    def removed_once(self: FolderLock, descriptor: int) -> bool:
        nonlocal calls
        calls += 1
        if calls == 1:
            (tmp_path / ".learn.lock").unlink()
        return real_flock(self, descriptor)

    monkeypatch.setattr(FolderLock, "_is_current", removed_once)
    save(tmp_path, "a")

    assert calls == 2


def test_place_without_locks_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file system that cannot lock is told like one that cannot be written."""

    def fail(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("fcntl.flock", fail)

    with pytest.raises(OutputError, match=r"cannot be written .no locks available"):
        save(tmp_path, "a")


def test_lock_is_given_back_once(tmp_path: Path) -> None:
    """Giving back what was not taken does nothing."""
    lock = FolderLock(tmp_path / "lock")

    lock.release()
    lock.acquire()
    lock.release()
    lock.release()

    assert files(tmp_path) == set()
