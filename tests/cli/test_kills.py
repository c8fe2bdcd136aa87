"""A run that is killed at any moment loses nothing and stands in nobody's way."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from benchmarks.robustness.kills import MERGED, kill_often
from mpap_cli.errors import OutputError
from mpap_cli.outputs.publishing import lock_of
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import read_results
from tests.cli.conftest import Run
from tests.commands.fleet.logs import MPAP, wait_until

OLDER = {"a.csv": "1", "b.csv": "1", "deep/gone.png": "1"}
NEWER = {"a.csv": "2", "b.csv": "1", "deep/new.png": "2", "z.csv": "2"}
MOST_STEPS = 30

# writes results as a command does, and kills itself after its n-th change of the folders
KILLED = """
import os, signal, sys
from pathlib import Path
from mpap_cli.outputs.results_folder import ResultsFolder

left = int(sys.argv[2])

def deadly(change):
    def call(*words, **more):
        global left
        done = change(*words, **more)
        left -= 1
        if left == 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return done
    return call

for name in ("replace", "rename", "unlink", "mkdir", "rmdir"):
    setattr(os, name, deadly(getattr(os, name)))
with ResultsFolder(Path(sys.argv[1]), "learn") as results:
    for word in sys.argv[3:]:
        name, _, text = word.partition("=")
        results.path(name).write_text(text)
    results.commit({}, inputs=[])
"""


def write(out: Path, contents: dict[str, str]) -> None:
    """Write results undisturbed."""
    with ResultsFolder(out, "learn") as results:
        for name, text in contents.items():
            results.path(name).write_text(text, encoding="utf-8")
        results.commit({}, inputs=[])


def found_in(out: Path) -> dict[str, str]:
    """Return the results of a folder, which must be whole."""
    results = read_results(out / "learn")
    return {name: results.path(name).read_text(encoding="utf-8") for name in results.outputs}


def killed_after(n_steps: int, out: Path) -> bool:
    """Write the newer results in a process that dies after so many steps; false if it lived."""
    words = [f"{name}={text}" for name, text in NEWER.items()]
    line = [sys.executable, "-c", KILLED, str(out), str(n_steps), *words]
    ended = subprocess.run(line, check=False)  # noqa: S603  # the script above
    assert ended.returncode in {0, -signal.SIGKILL}
    return ended.returncode != 0


def is_mixed(out: Path) -> bool:
    """Whether who cannot mend the results is told that they are mixed, or finds them whole."""
    lock = lock_of(out / "learn")
    lock.acquire()
    try:
        assert found_in(out) in (OLDER, NEWER)
    except OutputError as error:
        return "run mpap learn again" in str(error)
    finally:
        lock.release()
    return False


def test_a_kill_between_any_two_steps_loses_nothing(tmp_path: Path) -> None:
    """After each change of a folder: older or newer results, named if mixed, and room for more."""
    seen, n_mixed, n_steps = [], 0, 1
    while n_steps < MOST_STEPS:
        out = tmp_path / str(n_steps)
        write(out, OLDER)
        if not killed_after(n_steps, out):
            break
        n_mixed += is_mixed(out)
        seen.append(found_in(out))
        write(out, NEWER)
        assert found_in(out) == NEWER
        assert [path.name for path in out.iterdir()] == ["learn"]
        assert not (out / "learn" / "deep" / "gone.png").exists()
        n_steps += 1

    assert 10 < n_steps < MOST_STEPS
    assert n_mixed > 3
    assert seen == [OLDER] * seen.count(OLDER) + [NEWER] * seen.count(NEWER)
    assert set(map(len, seen)) == {3, 4}


def kill_when(holds: Callable[[], object], words: Sequence[object], place: Path) -> None:
    """Start a command with a place for temporary files, and kill it as soon as that holds."""
    null, environment = subprocess.DEVNULL, {**os.environ, "TMPDIR": str(place)}
    line = [MPAP, *map(str, words)]
    with subprocess.Popen(line, env=environment, stdout=null, stderr=null) as run:  # noqa: S603
        try:
            wait_until(lambda: bool(holds()) or run.poll() is not None)
            assert run.poll() is None
        finally:
            run.kill()


@pytest.mark.parametrize("name", ["a.bag", "folder"])
def test_the_next_simulate_removes_what_a_killed_one_left(
    tmp_path: Path, run: Run, name: str
) -> None:
    """Of the log and of the truth; the same name is free."""
    log = tmp_path / name
    words = ("simulate", log, "--camera", "--image-size", "64x64", "--duration")
    kill_when(lambda: len(list(tmp_path.glob(".mpap-*/*.csv"))) > 1, (*words, 3000), tmp_path)
    left = {path.name for path in tmp_path.iterdir()}

    outcome = run(*words, 2)

    assert outcome.code == 0
    assert left
    assert all(one.startswith(".mpap-") for one in left)
    tables = {f"{name}.{kind}.csv" for kind in ("truth", "patches", "images")}
    assert {path.name for path in tmp_path.iterdir()} == {name, *tables}


def test_the_next_reproduce_removes_what_a_killed_one_left(tmp_path: Path) -> None:
    """The folder of its experiments, which lies where temporary files do."""
    words = ("reproduce", "--only", "table-2", "--jobs", 1, "-o", tmp_path / "out")
    place = tmp_path / "temporary"
    place.mkdir()

    def folders() -> set[Path]:
        return set(place.glob("mpap-reproduce-*"))

    kill_when(lambda: list(place.glob("mpap-reproduce-*/*")), words, place)
    left = folders()

    kill_when(lambda: folders() - left and not left & folders(), words, place)

    assert len(left) == 1
    assert len(folders()) == 1
    assert not left & folders()


@pytest.mark.slow
def test_results_are_whole_after_every_kill(tmp_path: Path) -> None:
    """Each folder holds older or new results, never mixed, and the next run works."""
    kills = list(kill_often(tmp_path, ("learn", MERGED, "predict"), n_kills=6, seed=1))

    assert [kill.complaints for kill in kills] == [()] * 6
    assert {kill.results for kill in kills} <= {"older", "new"}
