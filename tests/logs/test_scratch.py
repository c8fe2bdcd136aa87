"""Folders for what is thrown away outlive neither a run nor its successor."""

import fcntl
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from mpap_cli.logs.scratch import ScratchFolder

MAKE = """
import sys
from pathlib import Path
from mpap_cli.logs.scratch import ScratchFolder
folder = ScratchFolder("left-", Path(sys.argv[1]))
(folder.path / "deep").mkdir()
(folder.path / "deep" / "large.bin").write_bytes(bytes(1000))
print(folder.path, flush=True)
sys.stdin.read()
"""


def start(place: Path) -> tuple["subprocess.Popen[str]", Path]:
    """Start a process that makes a folder and waits; return both."""
    pipe = subprocess.PIPE
    line = [sys.executable, "-c", MAKE, str(place)]
    process = subprocess.Popen(line, stdin=pipe, stdout=pipe, text=True)  # noqa: S603
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


@pytest.fixture
def left(tmp_path: Path) -> Path:
    """Return the folder of a process that was killed."""
    process, folder = start(tmp_path)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert (folder / "deep" / "large.bin").exists()
    return folder


def test_a_folder_goes_when_it_is_removed_or_forgotten(tmp_path: Path) -> None:
    """Neither needs the other; a second removal does nothing."""
    removed, forgotten = ScratchFolder("a-", tmp_path), ScratchFolder("a-", tmp_path)
    assert removed.path != forgotten.path

    removed.remove()
    removed.remove()
    del forgotten

    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_process_left_goes_with_the_next_folder(tmp_path: Path, left: Path) -> None:
    """Of another prefix, or in another place, it stays."""
    (tmp_path / "elsewhere").mkdir()

    ScratchFolder("right-", tmp_path).remove()
    ScratchFolder("left-", tmp_path / "elsewhere").remove()
    stayed = left.exists()
    ScratchFolder("left-", tmp_path).remove()

    assert stayed
    assert not left.exists()


def test_what_a_living_process_uses_stays(tmp_path: Path) -> None:
    """A run beside it takes nothing away, and it removes its own at its end."""
    process, used = start(tmp_path)

    ScratchFolder("left-", tmp_path).remove()
    stayed = (used / "deep" / "large.bin").exists()
    process.communicate("")

    assert stayed
    assert process.returncode == 0
    assert not used.exists()


def test_a_copy_of_the_process_removes_nothing(tmp_path: Path) -> None:
    """A fork that ends leaves the folder to its parent."""
    folder = ScratchFolder("left-", tmp_path)

    child = os.fork()
    if child == 0:
        folder.remove()
        os._exit(0)
    os.waitpid(child, 0)

    assert folder.path.exists()
    folder.remove()


@pytest.mark.parametrize("kind", ["no mark", "link", "other machine", "empty mark", "file", "pipe"])
def test_what_is_not_provably_ours_and_dead_stays(tmp_path: Path, left: Path, kind: str) -> None:
    """Folders of the same name that somebody made, links, and those of other machines."""
    odd = tmp_path / "left-odd"
    mark = next(left.glob(".mpap-*"))
    if kind == "link":
        (tmp_path / "mine").mkdir()
        shutil.copy(mark, tmp_path / "mine")
        odd.symlink_to(tmp_path / "mine")
    elif kind == "file":
        odd.write_text("mine", encoding="utf-8")
    else:
        odd.mkdir()
        texts = {"other machine": f"not {socket.gethostname()}\n", "empty mark": ""}
        if kind == "pipe":
            os.mkfifo(odd / mark.name)
        elif kind in texts:
            (odd / mark.name).write_text(texts[kind], encoding="utf-8")

    ScratchFolder("left-", tmp_path).remove()

    assert odd.exists()
    assert not left.exists()


def test_without_locks_nothing_is_removed(
    tmp_path: Path, left: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where files cannot be locked folders still serve."""

    def refuse(*_: object) -> None:
        raise OSError

    monkeypatch.setattr(fcntl, "flock", refuse)

    folder = ScratchFolder("left-", tmp_path)
    (folder.path / "a").write_text("a", encoding="utf-8")
    folder.remove()

    assert [path.name for path in tmp_path.iterdir()] == [left.name]


def test_no_place_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A missing place for temporary files is told by who asked."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))

    with pytest.raises(FileNotFoundError):
        ScratchFolder("left-")
