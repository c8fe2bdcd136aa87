"""Disks that are full or read-only, and odd places for results: one line, nothing lost."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import read_results
from tests.cli.disks import small_disk, tree
from tests.commands.patch_sets import arrays, write_npz

LOG = Path(__file__).parents[2] / "fixtures" / "indoor-a.bag"
OTHER = LOG.with_name("indoor-a2.mcap")
COMMANDS = (
    "learn",
    "evaluate",
    "predict",
    "novelty",
    "merge",
    "compare",
    "similar",
    "extract",
    "cluster",
)

Run = Callable[..., Any]


def words(command: str, model: Path) -> list[str]:
    """Return a short run of a command."""
    log = [str(LOG), "--end", "40"]
    return {
        "learn": ["learn", *log],
        "evaluate": ["evaluate", *log],
        "predict": ["predict", str(model), *log, "--to-mcap"],
        "novelty": ["novelty", *log],
        "merge": ["merge", str(model)],
        "compare": ["compare", *log, str(OTHER)],
        "similar": ["similar", str(model), "--at", f"{LOG}@12.5"],
        "extract": ["extract", *log, "--presses"],
        "cluster": ["cluster", str(model.with_name("patches.npz")), "--method", "mpap"],
    }[command]


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with an OUT that holds the results of every command, and their model."""
    from mpap_cli.cli.main import main  # noqa: PLC0415  # once for all tests

    folder = tmp_path_factory.mktemp("filled")
    write_npz(folder / "patches.npz", **arrays(6))
    for command in COMMANDS:
        with pytest.raises(SystemExit, match="0"):
            main([*words(command, folder / "model.npz"), "-o", str(folder / "out"), "-q"])
        if command == "learn":
            shutil.copy(folder / "out" / "learn" / "model.npz", folder)
    return folder


@pytest.mark.parametrize("n_bytes", [200, 2500])
@pytest.mark.parametrize("command", COMMANDS)
def test_a_disk_that_fills_up_loses_nothing(
    tmp_path: Path, run: Run, filled: Path, command: str, n_bytes: int
) -> None:
    """Wherever a file cannot grow any more: one line, older results as they were, no leftovers."""
    out = tmp_path / "out"
    shutil.copytree(filled / "out", out)
    before = tree(out)

    with small_disk(n_bytes):
        outcome = run(*words(command, filled / "model.npz"), "-o", out)

    assert outcome.code == 1
    assert "cannot be written (file too large)" in outcome.err.splitlines()[-1]
    assert "Traceback" not in outcome.err
    assert tree(out) == before


@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_disk_is_left_as_it_was(
    run: Run, mount: Callable[[str], Path], filled: Path, command: str
) -> None:
    """No space left is one line with the folder, and what was written goes."""
    disk = mount("size=8k")

    outcome = run(*words(command, filled / "model.npz"), "-o", disk / "out")

    assert outcome.code == 1
    assert f"{disk}/out/" in outcome.err.splitlines()[-1]
    assert "cannot be written (no space left on device)" in outcome.err.splitlines()[-1]
    assert not list(disk.iterdir())


@pytest.mark.parametrize("command", COMMANDS)
def test_read_only_results_can_be_read(
    tmp_path: Path, run: Run, mount: Callable[[str], Path], filled: Path, command: str
) -> None:
    """A results folder on a read-only disk cannot be written but serves as input."""
    disk = mount("size=4m")
    shutil.copytree(filled / "out", disk / "out")
    mount("remount,ro")

    refused = run(*words(command, filled / "model.npz"), "-o", disk / "out")
    read = run("merge", disk / "out", "-o", tmp_path / "elsewhere")

    assert refused.code == 1
    assert f"{disk}/out/{command}: cannot be written (read-only" in refused.err.splitlines()[-1]
    assert read_results(disk / "out" / command).command == command
    assert read.code == 0


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_in_place_of_out_is_named(
    tmp_path: Path, run: Run, filled: Path, command: str
) -> None:
    """OUT that is a file ends with 1, and the file stays."""
    out = tmp_path / "out"
    out.write_text("mine", encoding="utf-8")

    outcome = run(*words(command, filled / "model.npz"), "-o", out)

    assert outcome.code == 1
    assert outcome.err.splitlines()[-1].startswith(f"mpap: {out}/{command}: cannot be written")
    assert out.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("command", COMMANDS)
def test_a_second_run_into_one_folder_is_refused(
    tmp_path: Path, run: Run, filled: Path, command: str
) -> None:
    """While one run writes, another of the command is told who does, and ends with 1."""
    out = tmp_path / "out"
    shutil.copytree(filled / "out", out)
    before = tree(out)

    with ResultsFolder(out, command):
        outcome = run(*words(command, filled / "model.npz"), "-o", out)

    assert outcome.code == 1
    assert f"another run of mpap writes there (process {os.getpid()}" in outcome.err
    assert tree(out) == before


@pytest.mark.parametrize(
    "name",
    [
        "with blanks, 'quotes' and $(words)",
        "n\u00e4me \u2603 \U0001f916",
        "--looks-like-an-option",
        "red\x1b[31m\nmpap: not said by mpap",
        "no text \udcff",
        "long" * 60,
        "a/" * 200 + "deep",
    ],
)
def test_odd_places_for_results_do(tmp_path: Path, run: Run, filled: Path, name: str) -> None:
    """Whatever a folder may be called holds results; what is printed of it is harmless."""
    out = tmp_path / name

    made = run("merge", filled / "model.npz", f"--out={out}")
    told = run("info", out)

    assert made.code == told.code == 0
    assert read_results(out / "merge").outputs.keys() == {"clusters.csv", "model.npz"}
    said = made.out + made.err + told.out + told.err
    assert all(sign.isprintable() for sign in said.replace("\n", ""))
    assert not any(line.startswith("mpap: not") for line in said.splitlines())


@pytest.mark.parametrize("name", ["long" * 80, "a/" * 3000])
def test_impossible_places_are_one_line(tmp_path: Path, run: Run, filled: Path, name: str) -> None:
    """A name that no file system takes ends with 1 or 2, and no traceback."""
    outcome = run("merge", filled / "model.npz", f"--out={tmp_path / name}")

    assert outcome.code in {1, 2}
    assert "Traceback" not in outcome.err
