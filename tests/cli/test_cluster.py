"""``mpap cluster``: what is printed, and how it ends."""

import json
from pathlib import Path

import pytest

from mpap_cli.cli.cluster import METHODS
from mpap_cli.evaluation.clusterers.methods import CLUSTERERS
from tests.cli.conftest import Run
from tests.commands.patch_sets import CLASSES, arrays, write_folder, write_npz


def test_the_methods_offered_are_those_there_are() -> None:
    """The choices of --method name every method once, in the order of the table."""
    assert tuple(dict.fromkeys(method for method, _ in CLUSTERERS)) == METHODS


def test_the_table_has_means_the_paper_and_findings(run: Run, tmp_path: Path) -> None:
    """Mean and spread of mpap beside the paper's .88, and what stands out in words."""
    path = write_npz(tmp_path / "patches.npz")

    outcome = run("cluster", path, "-o", tmp_path / "out", "--orders", 2)

    lines = outcome.out.splitlines()
    mpap = next(line for line in lines if line.startswith("mpap  "))
    assert outcome.code == 0
    assert lines[0] == f"90 patches of 3 classes: {', '.join(CLASSES)}"
    assert "+-" in mpap
    assert "0.88" in mpap
    assert any("affinity propagation over all points" in line for line in lines)
    assert any("k-means is told that there are 3 classes" in line for line in lines)
    assert lines[-1] == f"results: {tmp_path / 'out' / 'cluster'}"
    assert "mpap default: 2 runs" in outcome.err


@pytest.mark.parametrize("shape", ["csv", "json"])
def test_every_run_can_be_printed(run: Run, tmp_path: Path, shape: str) -> None:
    """CSV is cluster.csv itself, JSON has the same keys."""
    path = write_npz(tmp_path / "patches.npz")

    words = ("--orders", 2, "--method", "mpap", "--format", shape)
    outcome = run("cluster", path, "-o", tmp_path / "out", *words)

    table = (tmp_path / "out" / "cluster" / "cluster.csv").read_text()
    if shape == "csv":
        assert outcome.out == table
    else:
        assert ",".join(json.loads(outcome.out)[0]) == table.splitlines()[0]


def test_one_class_is_told(run: Run, tmp_path: Path) -> None:
    """Scores are dashes, and why is said."""
    path = write_npz(tmp_path / "one.npz", **arrays(30, 1))

    outcome = run("cluster", path, "-o", tmp_path / "out", "--method", "mpap")

    assert outcome.code == 0
    assert "one class: V-measure and its kin mean nothing" in outcome.out
    assert "nan" not in outcome.out


def test_damaged_images_end_with_code_3(run: Run, tmp_path: Path) -> None:
    """They are counted on stderr."""
    folder = write_folder(tmp_path / "set", n_images=1)
    (folder / CLASSES[0] / "cut.jpg").write_bytes(b"\xff\xd8\xff")

    outcome = run("cluster", folder, "-o", tmp_path / "out", "--method", "mpap")

    assert outcome.code == 3
    assert "1 image left out: cannot be read" in outcome.err


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("nowhere",), 1, "nowhere: there is no such file or folder"),
        (("patches.npz", "--set", "theta=-1"), 2, "setting theta: found -1.0"),
        (("patches.npz", "--set", "tetha=1"), 2, "setting tetha: no such setting"),
        (("patches.npz", "--method", "dbscan"), 2, "Invalid value for '--method'"),
        (("patches.npz", "--orders", "0"), 2, "Invalid value for '--orders'"),
    ],
)
def test_what_is_wrong_is_one_line(
    run: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: tuple[str, ...],
    code: int,
    said: str,
) -> None:
    """Paths and settings that do not exist: no traceback, no results."""
    write_npz(tmp_path / "patches.npz")
    monkeypatch.chdir(tmp_path)

    outcome = run("cluster", *words)

    assert outcome.code == code
    assert said in outcome.err
    assert not (tmp_path / "mpap-out").exists()
