"""``mpap evaluate``: its tables agree with each other, with the logs, and with what was asked."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sklearn.metrics import auc, roc_auc_score

from tests.commands.running import (
    BAG,
    COLUMNS,
    EVALUATE_FILES,
    MCAP,
    PAPER,
    done,
    evaluated,
    header_of,
    record_of,
    total,
)

Made = Callable[..., Path]
UNFITTED = ["nearest-range", "nearest-range-1s"]
BASELINES = [*UNFITTED, "logistic-regression", "random-forest", "knn-scans", "k-means"]
IN_SAMPLE = ("--protocol", "in-sample")


def test_evaluate_writes_its_files(made: Made) -> None:
    """Seven tables, three plots and the settings appear; the scans that were read go."""
    out = made("evaluate", BAG, *IN_SAMPLE)

    assert {path.name for path in (out / "evaluate").iterdir()} == EVALUATE_FILES


@pytest.mark.parametrize("name", COLUMNS)
def test_tables_have_the_columns_of_the_contract(made: Made, name: str) -> None:
    """The columns stand in their order."""
    out = made("evaluate", BAG, *IN_SAMPLE)

    assert header_of(out / "evaluate" / name) == COLUMNS[name]


def test_mpap_stands_first_and_the_baselines_last(made: Made) -> None:
    """First as asked, then what one should be better than; nothing was learnt here."""
    by_default = made("evaluate", BAG, *IN_SAMPLE)
    as_asked = made("evaluate", BAG, *IN_SAMPLE, *PAPER)

    assert [row["method"] for row in evaluated(by_default, "auc")] == ["mpap", *BASELINES]
    assert [row["method"] for row in evaluated(as_asked, "auc")] == ["mpap", *BASELINES]


def test_the_timeline_has_one_row_a_scan(made: Made) -> None:
    """Positives, negatives and presses of auc.csv are those of timeline.csv and presses.csv."""
    out = made("evaluate", BAG, *IN_SAMPLE)

    timeline, first = evaluated(out, "timeline"), evaluated(out, "auc")[0]
    truth = [row["truth"] for row in timeline]
    assert len(timeline) == 800
    assert (truth.count("1"), truth.count("0")) == (
        int(first["positives"]),
        int(first["negatives"]),
    )
    assert len(evaluated(out, "presses")) == int(first["presses"]) == 5
    assert {(row["log"], row["log_index"]) for row in timeline} == {("indoor-a.bag", "0")}


def test_truth_is_one_within_presses(made: Made) -> None:
    """The target contact marks the scans between start and end of a press, no others."""
    out = made("evaluate", BAG, *IN_SAMPLE)

    presses = [(float(row["start_s"]), float(row["end_s"])) for row in evaluated(out, "presses")]
    for row in evaluated(out, "timeline"):
        pressed = any(start <= float(row["time_s"]) < end for start, end in presses)
        assert row["truth"] == str(int(pressed))


def test_the_area_is_that_of_the_timeline(made: Made) -> None:
    """In-sample, one model scores all: scikit-learn finds the same area in timeline.csv."""
    out = made("evaluate", BAG, *IN_SAMPLE)

    timeline = evaluated(out, "timeline")
    truth = [int(row["truth"]) for row in timeline]
    scores = [float(row["p_cluster"]) for row in timeline]
    expected = roc_auc_score(truth, [float(row["p_collision"]) for row in timeline])
    assert float(evaluated(out, "auc")[0]["auc"]) == pytest.approx(expected)
    assert roc_auc_score(truth, scores) > 0.5


def test_curves_enclose_their_areas(made: Made) -> None:
    """Each method's roc.csv rises from 0, 0 to 1, 1 and encloses the area of auc.csv."""
    out = made("evaluate", BAG, *IN_SAMPLE, *PAPER)

    roc = evaluated(out, "roc")
    for row in evaluated(out, "auc"):
        key = [row[name] for name in ("method", "feature", "bins")]
        curve = [one for one in roc if [one[name] for name in ("method", "feature", "bins")] == key]
        fpr = np.array([float(one["fpr"]) for one in curve])
        tpr = np.array([float(one["tpr"]) for one in curve])
        assert (fpr[0], tpr[0], fpr[-1], tpr[-1]) == (0, 0, 1, 1)
        assert (np.diff(fpr) >= 0).all()
        assert auc(fpr, tpr) == pytest.approx(float(row["auc"]))


@pytest.mark.slow
def test_predicted_goes_by_the_threshold(made: Made) -> None:
    """A scan is predicted from the threshold up; fewer are from a higher one."""
    high = evaluated(made("evaluate", BAG, *IN_SAMPLE), "timeline")
    low = evaluated(made("evaluate", BAG, *IN_SAMPLE, "--threshold", "0.1"), "timeline")

    assert all((row["predicted"] == "1") == (float(row["p_collision"]) >= 0.2) for row in high)
    assert all((row["predicted"] == "1") == (float(row["p_collision"]) >= 0.1) for row in low)
    assert 0 < total(high, "predicted") < total(low, "predicted")


def test_what_was_learnt_last_is_scored_like_its_logs(made: Made, tmp_path: Path) -> None:
    """Without LOG the recording gives the same bytes as reading the logs again."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    done("evaluate", *IN_SAMPLE, "-o", out)

    logs = made("evaluate", BAG, *IN_SAMPLE)
    for name in COLUMNS:
        assert (out / "evaluate" / name).read_bytes() == (logs / "evaluate" / name).read_bytes()
    learnt = (out / "learn" / "clusters.csv").read_bytes()
    assert (out / "evaluate" / "clusters.csv").read_bytes() == learnt
    assert record_of(out / "evaluate")["inputs"] == record_of(out / "learn")["inputs"]


def test_settings_name_the_profile_that_is_scored(made: Made, tmp_path: Path) -> None:
    """What is scored may be of another profile than what was learnt."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    done("evaluate", *IN_SAMPLE, *PAPER, "-o", out)

    assert record_of(out / "learn")["settings"]["profile"] == "robust"
    settings = record_of(out / "evaluate")["settings"]
    asked = ("profile", "feature", "bins", "protocol", "target", "threshold")
    assert [settings[name] for name in asked] == [
        "paper",
        "global-diff",
        "6",
        "in-sample",
        "contact",
        0.2,
    ]
    assert settings["methods"] == ["mpap", "mpap as learnt"]


def test_a_given_model_is_scored_as_it_is(made: Made) -> None:
    """--model: one model, all its scores, baselines fitted on the recording beside it."""
    model = made("learn", BAG)

    out = made("evaluate", MCAP, "--model", model)

    rows = evaluated(out, "auc")
    assert {row["protocol"] for row in rows} == {"given-model"}
    assert [row["method"] for row in rows] == ["mpap", *BASELINES]
    timeline = evaluated(out, "timeline")
    expected = roc_auc_score(
        [int(row["truth"]) for row in timeline], [float(row["p_collision"]) for row in timeline]
    )
    assert float(rows[0]["auc"]) == pytest.approx(expected)
    learnt = (model / "learn" / "clusters.csv").read_bytes()
    assert (out / "evaluate" / "clusters.csv").read_bytes() == learnt


@pytest.mark.slow
def test_without_a_recording_beside_the_model_nothing_is_fitted(made: Made, tmp_path: Path) -> None:
    """A model alone has nothing to fit the baselines on."""
    model = tmp_path / "model.npz"
    shutil.copy(made("learn", BAG) / "learn" / "model.npz", model)

    done("evaluate", MCAP, "--model", model, "-o", tmp_path / "out")

    assert [row["method"] for row in evaluated(tmp_path / "out", "auc")] == ["mpap", *UNFITTED]


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["json", "csv"])
def test_what_is_printed_is_the_table(made: Made, tmp_path: Path, shape: str) -> None:
    """--format csv prints auc.csv, json the same cells by their names."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    outcome = done("evaluate", *IN_SAMPLE, "-o", out, "--format", shape)

    expected = (out / "evaluate" / "auc.csv").read_text(encoding="utf-8")
    if shape == "csv":
        assert outcome.out == expected
    else:
        found: list[dict[str, Any]] = json.loads(outcome.out)
        assert " ".join(found[0]) == COLUMNS["auc.csv"]
        assert [row["method"] for row in found] == [row["method"] for row in evaluated(out, "auc")]


@pytest.mark.slow
def test_the_print_out_has_the_lines_of_the_contract(made: Made, tmp_path: Path) -> None:
    """What was scored, the table, the comparison, how it was held out, the lead times."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    lines = done("evaluate", *PAPER, "-o", out).out.splitlines()

    assert lines[0].startswith("global-diff, 6 bins, profile paper (because --feature was given).")
    assert lines[0].endswith("1 log, 800 scans, 91 in contact, 5 presses; truth: bumper")
    columns = (
        "method profile held-out AUC [95 %] in-sample AUC paper's Table 4 clusters meta-points"
    )
    assert " ".join(lines[1].split()) == columns
    assert lines[2].startswith("mpap global-diff/6  paper")
    assert ".90 in / .90 out" in lines[2]
    assert lines[3].startswith("for comparison: mpap as learnt (robust) ")
    assert "nearest range ahead" in lines[3]
    assert "(blocked, 5 folds, 1.1 to 2.8 s guard)" in lines[4]
    assert lines[5].startswith("at p >= 0.2: ")
    assert lines[5].endswith("false alarms a minute")


def test_scans_outside_start_and_end_are_not_scored(tmp_path: Path) -> None:
    """--start and --end cut scans and presses."""
    words = ("--start", "20", "--end", "60", *IN_SAMPLE)

    done("evaluate", BAG, *words, "-o", tmp_path / "out")

    times = [float(row["time_s"]) for row in evaluated(tmp_path / "out", "timeline")]
    assert (len(times), min(times) >= 20, max(times) < 60) == (400, True, True)
    starts = [float(row["start_s"]) for row in evaluated(tmp_path / "out", "presses")]
    assert all(20 <= start < 60 for start in starts)
    assert len(starts) == 4
