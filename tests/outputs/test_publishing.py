"""A kill at any moment of a commit can be mended."""

import shutil
from pathlib import Path

import pytest

from mpap_cli.errors import OutputError
from mpap_cli.outputs import publishing
from mpap_cli.outputs.publishing import lock_of, staging_of
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import has_results, read_results

OLD = {"a.csv": "old", "b.csv": "old", "images/c.png": "old"}
NEW = {"a.csv": "new", "b.csv": "new", "d.csv": "new"}


class KilledError(BaseException):
    """Stands for a kill: nobody cleans up."""


def save(out: Path, texts: dict[str, str]) -> Path:
    """Run a command that writes these texts."""
    with ResultsFolder(out, "learn") as results:
        for name, text in texts.items():
            results.path(name).write_text(text)
        results.commit({}, [])
    return results.folder


def kill_commit(out: Path, after: int, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Run a command that is killed after so many renames."""
    move, calls, folder = publishing._move, 0, out / "learn"
    kept = out.parent / "kept"

    def killed(staging: Path, folder: Path, name: str) -> None:
        nonlocal calls
        if calls == after:
            shutil.copytree(staging, kept)
            raise KilledError
        calls += 1
        move(staging, folder, name)

    with monkeypatch.context() as patch:
        patch.setattr(publishing, "_move", killed)
        with pytest.raises(KilledError):
            save(out, NEW)
    shutil.move(kept, staging_of(folder))
    return folder


def texts_of(folder: Path) -> dict[str, str]:
    """Return every output in a folder."""
    files = (path for path in folder.rglob("*") if path.is_file())
    texts = {path.relative_to(folder).as_posix(): path.read_text() for path in files}
    texts.pop("settings.json", None)
    return texts


@pytest.mark.parametrize("after", [0, 1, 2, 3])
@pytest.mark.parametrize("first", [True, False])
def test_reader_finishes_a_killed_commit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int, first: bool
) -> None:
    """Killed between any two renames, the new results are whole for the next reader."""
    out = tmp_path / "out"
    if not first:
        save(out, OLD)
    folder = kill_commit(out, after, monkeypatch)

    assert has_results(folder)
    read_results(folder)

    assert texts_of(folder) == NEW
    assert {path.name for path in out.iterdir()} == {"learn"}


def test_next_run_finishes_a_killed_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A next run that fails leaves the committed results whole."""
    out = tmp_path / "out"
    save(out, OLD)
    folder = kill_commit(out, 1, monkeypatch)

    with pytest.raises(KilledError), ResultsFolder(out, "learn"):
        raise KilledError

    read_results(folder)
    assert texts_of(folder) == NEW


@pytest.mark.parametrize("spoiled", ["a.csv", "settings.json"])
def test_unwhole_commit_is_a_leftover(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, spoiled: str
) -> None:
    """Staged files that the staged settings do not describe are removed, the old ones stay."""
    out = tmp_path / "out"
    save(out, OLD)
    folder = kill_commit(out, 0, monkeypatch)
    (staging_of(folder) / spoiled).write_text("half")

    read_results(folder)

    assert texts_of(folder) == OLD
    assert not staging_of(folder).exists()


def test_commit_of_a_living_run_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While the run that commits lives, a reader only says that the set is mixed."""
    out = tmp_path / "out"
    save(out, OLD)
    folder = kill_commit(out, 1, monkeypatch)
    lock = lock_of(folder)
    lock.acquire()

    with pytest.raises(OutputError, match=r"a.csv is not the file that settings.json names"):
        read_results(folder)

    lock.release()
    assert staging_of(folder).exists()


def test_missing_staged_file_is_no_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A staged file that is gone cannot be finished."""
    out = tmp_path / "out"
    save(out, OLD)
    folder = kill_commit(out, 0, monkeypatch)
    (staging_of(folder) / "d.csv").unlink()

    read_results(folder)

    assert texts_of(folder) == OLD
