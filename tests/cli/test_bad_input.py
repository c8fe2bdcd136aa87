"""Every mistake that a user can mend ends in one line on stderr and its exit code."""

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest


def one_line(err: str) -> str:
    """Return the last line; there must be no traceback."""
    assert "Traceback" not in err
    return err.strip().splitlines()[-1]


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("missing.bag", None, "missing.bag"),
        ("empty.bag", b"", "the file is empty"),
        ("text.mcap", b"hello, this is no log at all", "neither a ROS bag"),
        ("pointer.bag", b"version https://git-lfs.github.com/spec/v1\n", "git lfs pull"),
    ],
)
@pytest.mark.parametrize("command", ["info", "learn", "evaluate"])
def test_a_file_that_is_no_log_is_named(
    tmp_path: Path,
    run: Callable[..., Any],
    command: str,
    name: str,
    content: bytes | None,
    expected: str,
) -> None:
    """A missing, empty or foreign file ends with exit code 1 and its name."""
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)

    outcome = run(command, path, *(() if command == "info" else ("-o", tmp_path / "out")))

    assert outcome.code == 1
    assert expected in one_line(outcome.err)
    assert name in one_line(outcome.err)
    assert not (tmp_path / "out").exists()


def test_a_folder_without_logs_is_named(tmp_path: Path, run: Callable[..., Any]) -> None:
    """A folder that holds no log ends with exit code 1."""
    folder = tmp_path / "photos"
    folder.mkdir()

    outcome = run("learn", folder, "-o", tmp_path / "out")

    assert outcome.code == 1
    assert "photos" in one_line(outcome.err)


def test_of_several_logs_an_unreadable_one_is_left_out(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """The others are learnt and the exit code is 3; with --strict it is 1."""
    good, bad = write_scans(), tmp_path / "bad.bag"
    bad.write_bytes(b"")

    outcome = run("learn", good, bad, "-o", tmp_path / "out")
    strict = run("learn", good, bad, "-o", tmp_path / "out2", "--strict")

    assert outcome.code == 3
    assert "bad.bag" in outcome.err
    assert (tmp_path / "out" / "learn" / "model.npz").is_file()
    assert strict.code == 1
    assert not (tmp_path / "out2").exists()


def test_a_log_without_scans_lists_its_topics(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Without a scan topic learn ends with exit code 2, info with 0."""
    path = write_scans(topics=())

    outcome = run("learn", path, "-o", tmp_path / "out")
    info = run("info", path)

    assert outcome.code == 2
    assert "/bump" in one_line(outcome.err)
    assert info.code == 0
    assert "no scans" in info.out


def test_two_scan_topics_are_ready_to_paste(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Two equal scan topics end with exit code 2; naming one goes on."""
    path = write_scans(topics=("/front", "/rear"))

    outcome = run("learn", path, "-o", tmp_path / "out")
    chosen = run("learn", path, "-o", tmp_path / "out", "--scan-topic", "/rear")

    assert outcome.code == 2
    assert "--scan-topic /front" in one_line(outcome.err)
    assert chosen.code == 0


def test_a_topic_that_is_not_there_is_refused(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """A topic asked for by name must exist."""
    outcome = run("learn", write_scans(), "-o", tmp_path / "out", "--scan-topic", "/nose")

    assert outcome.code == 2
    assert "/nose" in one_line(outcome.err)


@pytest.mark.parametrize(
    ("pressed", "expected"),
    [
        ("none", "no bump topic"),
        ("never", "never fired"),
        ("always", "no scan without collision"),
    ],
)
def test_missing_labels_are_one_warning(
    tmp_path: Path,
    run: Callable[..., Any],
    write_scans: Callable[..., Path],
    pressed: str,
    expected: str,
) -> None:
    """Without labels learn clusters only, evaluate leaves the area empty, both exit 0."""
    path = write_scans(pressed=pressed)

    learnt = run("learn", path, "-o", tmp_path / "out")
    evaluated = run("evaluate", "-o", tmp_path / "out")

    assert (learnt.code, evaluated.code) == (0, 0)
    assert expected in learnt.err
    assert "held-out AUC empty" in evaluated.out
    with (tmp_path / "out" / "evaluate" / "auc.csv").open(encoding="utf-8") as file:
        assert next(csv.DictReader(file))["auc"] == ""


def test_a_press_that_is_never_released_is_learnt(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """A press up to the end of the log is one press."""
    outcome = run("learn", write_scans(pressed="held"), "-o", tmp_path / "out")

    assert outcome.code == 0
    assert "1 press" in outcome.out


def test_scans_with_too_few_beams_are_counted(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """A bin with fewer than two beams leaves out the scan; without any scan there is no model."""
    path = write_scans(n_beams=(10,))

    outcome = run("learn", path, "-o", tmp_path / "out", "--feature", "min-value", "--bins", "12")

    assert outcome.code == 2
    assert "240 scans skipped" in outcome.err
    assert "no scan could be used" in one_line(outcome.err)
    assert not (tmp_path / "out").exists()


def test_beam_counts_may_change(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Bins go by angle, so that the number of beams may vary."""
    outcome = run("learn", write_scans(n_beams=(180, 181, 179)), "-o", tmp_path / "out")

    assert outcome.code == 0
    assert outcome.out.startswith("240 scans of 1 log")


def test_evaluate_comes_after_learn(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Without anything learnt, or without its recording, evaluate asks for logs."""
    before = run("evaluate", "-o", tmp_path / "out")
    learnt = run("learn", write_scans(), "-o", tmp_path / "out", "--no-recording")
    after = run("evaluate", "-o", tmp_path / "out")

    assert (before.code, learnt.code, after.code) == (2, 0, 2)
    assert "run mpap learn" in one_line(before.err)
    assert "--no-recording" in one_line(after.err)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--profile", "robust", "--feature", "min-value"), "--profile robust"),
        (("--set", "theta=0"), "theta"),
        (("--set", "thera=1"), "no such setting"),
        (("--feature", "min-value", "--bins", "six"), "bins"),
        (("--fov", "wide"), "fov"),
        (("--forward", "left"), "forward"),
        (("--start", "yesterday"), "yesterday"),
        (("--bump-topic", "/bump:data=="), "data=="),
        (("--bump-topic", "/none"), "/none"),
    ],
)
def test_wrong_words_are_usage_errors(
    tmp_path: Path,
    run: Callable[..., Any],
    write_scans: Callable[..., Path],
    words: tuple[str, ...],
    expected: str,
) -> None:
    """What was typed wrongly is named, with exit code 2 and no results."""
    outcome = run("learn", write_scans(), "-o", tmp_path / "out", *words)

    assert outcome.code == 2
    assert expected in one_line(outcome.err)
    assert not (tmp_path / "out" / "learn").exists()


def test_a_failed_run_leaves_older_results_as_they_were(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Nothing of an older result is lost where a new run fails."""
    out = tmp_path / "out"
    run("learn", write_scans(), "-o", out)
    before = {path.name: path.read_bytes() for path in (out / "learn").iterdir()}

    outcome = run("learn", write_scans("two.bag", topics=("/a", "/b")), "-o", out)

    assert outcome.code == 2
    assert {path.name: path.read_bytes() for path in (out / "learn").iterdir()} == before
    assert sorted(path.name for path in out.iterdir()) == ["learn", "report.html"]


def test_an_output_that_is_a_file_is_refused(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """OUT must be a folder that can be written."""
    out = tmp_path / "out"
    out.write_text("mine", encoding="utf-8")

    outcome = run("learn", write_scans(), "-o", out)

    assert outcome.code == 1
    assert "out" in one_line(outcome.err)
    assert out.read_text(encoding="utf-8") == "mine"


def test_a_garbled_model_is_named(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """A file that is no model ends with exit code 1."""
    model = tmp_path / "model.npz"
    model.write_bytes(b"PK\x03\x04 nothing")

    outcome = run("predict", model, write_scans(), "-o", tmp_path / "out")

    assert outcome.code == 1
    assert "model.npz" in one_line(outcome.err)


def test_an_edited_result_is_named(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Results that do not belong together are not scored."""
    run("learn", write_scans(), "-o", tmp_path / "out")
    (tmp_path / "out" / "learn" / "clusters.csv").write_text("mine\n", encoding="utf-8")

    outcome = run("evaluate", "-o", tmp_path / "out")

    assert outcome.code == 1
    assert "clusters.csv" in one_line(outcome.err)


def test_models_of_other_settings_are_not_merged(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Models to merge must have the same settings; the one that differs is named."""
    path = write_scans()
    run("learn", path, "-o", tmp_path / "a")
    run("learn", path, "-o", tmp_path / "b", "--set", "theta=0.2")

    outcome = run("merge", tmp_path / "a", tmp_path / "b", "-o", tmp_path / "c")

    assert outcome.code == 2
    assert "theta" in one_line(outcome.err)


def test_scans_as_their_own_bumper_leave_the_area_empty(
    tmp_path: Path, run: Callable[..., Any], write_scans: Callable[..., Path]
) -> None:
    """Labels made from the scan itself cannot score a model of scans."""
    run("learn", write_scans(pressed="none"), "-o", tmp_path / "out", "--bump-from", "scan")

    outcome = run("evaluate", "-o", tmp_path / "out", "--format", "json")

    assert outcome.code == 0
    assert json.loads(outcome.out)[0]["auc"] is None
