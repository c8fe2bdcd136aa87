"""Logs without one of the classes, pressed from the start, or of robots unlike each other."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]
WriteScans = Callable[..., Path]


def table(out: Path, name: str) -> list[dict[str, str]]:
    """Read a table of the evaluation."""
    with (out / "evaluate" / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def column(rows: list[dict[str, str]], name: str) -> set[str]:
    """Return the different cells of a column."""
    return {row[name] for row in rows}


@pytest.mark.parametrize(
    ("pressed", "reason", "visible"),
    [
        ("none", "no negative scan", []),
        ("never", "no positive scan", []),
        ("always", "no negative scan", [""]),
    ],
)
def test_one_class_has_neither_areas_nor_differences(
    tmp_path: Path, run: Run, write_scans: WriteScans, pressed: str, reason: str, visible: list[str]
) -> None:
    """Every cell that needs both classes is empty, and the print-out says why."""
    outcome = run("evaluate", write_scans(pressed=pressed), "-o", tmp_path / "out")

    assert outcome.code == 0
    assert "held-out AUC empty" in outcome.out
    assert reason in outcome.out or pressed == "none"
    auc, differences = table(tmp_path / "out", "auc"), table(tmp_path / "out", "differences")
    for name in ("auc", "auc_per_log", "auc_visible", "auc_visible_per_log", "calibration_slope"):
        assert column(auc, name) == {""}
    assert column(differences, "logs") == {"0"}
    assert column(differences, "diff") == column(differences, "diff_per_log") == {""}
    assert table(tmp_path / "out", "operating") == []
    assert [row["visible"] for row in table(tmp_path / "out", "presses")] == visible


@pytest.mark.slow
@pytest.mark.parametrize("target", ["contact", "onset", "early:1"])
def test_a_press_from_the_start_is_never_an_onset(
    tmp_path: Path, run: Run, write_scans: WriteScans, target: str
) -> None:
    """It is scored as contact only, and neither visible nor to be announced."""
    log = write_scans(pressed="from-start", n_scans=400)

    outcome = run("evaluate", log, "--target", target, "-o", tmp_path / "out")

    assert outcome.code == 0
    presses, first = table(tmp_path / "out", "presses"), table(tmp_path / "out", "auc")[0]
    assert [presses[0][name] for name in ("predicted", "lead_s", "visible")] == ["", "", ""]
    assert {row["visible"] for row in presses[1:]} == {"1"}
    assert int(first["presses"]) == len(presses) - (target != "contact")
    assert int(first["visible_presses"]) == len(presses) - 1
    assert first["auc"] != ""
    assert column(table(tmp_path / "out", "operating"), "presses") == {str(len(presses) - 1)}


@pytest.mark.slow
def test_one_log_pressed_from_start_to_end_spoils_no_other(
    tmp_path: Path, run: Run, write_scans: WriteScans
) -> None:
    """It has one class, so it has no area of its own, and the others keep theirs."""
    good = [write_scans(f"{name}.bag", n_scans=120) for name in ("a", "b", "c")]
    held = write_scans("held.bag", pressed="always", n_scans=40)

    run("evaluate", *good, "-o", tmp_path / "without")
    outcome = run("evaluate", *good, held, "--target", "onset", "-o", tmp_path / "out")

    assert outcome.code == 0
    assert "mean AUC of 3 logs" in outcome.out
    first = table(tmp_path / "out", "auc")[0]
    assert (first["logs"], first["visible_presses"]) == ("4", first["presses"])
    assert column(table(tmp_path / "out", "differences"), "logs") == {"3"}


def test_robots_with_other_scanners_are_learnt_and_scored_together(
    tmp_path: Path, run: Run, write_scans: WriteScans
) -> None:
    """Beams and ranges may differ from log to log; bins go by angle and metres."""
    logs = [
        write_scans("few.bag", n_beams=(90,), range_max=3.5),
        write_scans("many.bag", n_beams=(720,), range_max=30.0),
        write_scans("varies.bag", n_beams=(180, 181)),
    ]

    learnt = run("learn", *logs, "-o", tmp_path / "out")
    outcome = run("evaluate", "-o", tmp_path / "out")

    assert (learnt.code, outcome.code) == (0, 0)
    assert learnt.out.startswith("720 scans of 3 logs")
    first = table(tmp_path / "out", "auc")[0]
    assert (first["protocol"], first["folds_scored"]) == ("leave-one-log-out", "3")
    assert float(first["auc_per_log"]) > 0.9
    assert column(table(tmp_path / "out", "presses"), "visible") == {"1"}


@pytest.mark.slow
def test_a_scanner_with_too_few_beams_leaves_the_others(
    tmp_path: Path, run: Run, write_scans: WriteScans
) -> None:
    """Its scans are skipped and counted; the other logs are scored."""
    logs = [write_scans(f"{name}.bag", n_scans=120) for name in ("a", "b", "c")]
    coarse = write_scans("coarse.bag", n_beams=(10,), n_scans=120)

    outcome = run(
        "evaluate", *logs, coarse, "--feature", "min-value", "--bins", "12", "-o", tmp_path / "out"
    )

    assert outcome.code == 0
    assert "coarse.bag: 120 scans skipped: bin with fewer than 2 beams" in outcome.err
    first = table(tmp_path / "out", "auc")[0]
    assert (first["logs"], first["negatives"], first["folds_scored"]) == ("4", "333", "3")


@pytest.mark.slow
def test_a_range_that_no_message_tells_is_taken_from_the_scans(
    tmp_path: Path, run: Run, write_scans: WriteScans
) -> None:
    """One robot without range_max is scored beside one with, and stderr says by what."""
    logs = [write_scans("a.bag"), write_scans("b.bag", range_max=0.0)]

    outcome = run("evaluate", *logs, "-o", tmp_path / "out")

    assert outcome.code == 0
    assert "b.bag: the scans give no usable range_max (0); 3.99 m" in outcome.err
    assert column(table(tmp_path / "out", "presses"), "visible") == {"1"}
    assert float(table(tmp_path / "out", "auc")[0]["auc"]) > 0.9
