"""``mpap predict``: what a model says of new logs, the same as evaluate says of it."""

import csv
import io
import json
import shutil
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from mpap_cli.logs.writing.event_log import EVENTS_TOPIC
from tests.commands.running import (
    BAG,
    COLUMNS,
    MCAP,
    PAPER,
    bytes_of,
    digest_of,
    done,
    header_of,
    mpap,
    record_of,
    rows_of,
    total,
)

Made = Callable[..., Path]
FACTS = [
    "logs",
    "scans",
    "predicted",
    "novel",
    "presses_judged",
    "presses_announced",
    "median_lead_s",
    "false_alarms_per_min",
    "images",
    "patches",
    "obstacle_patches",
    "unknown_patches",
    "straight",
    "rotate_left",
    "rotate_right",
    "stop",
    "contacts",
    "contacts_foreseen",
    "stopping_distance_m",
    "stopping_distance_sd_m",
    "stops_measured",
]


def test_predict_writes_its_files(made: Made) -> None:
    """Timeline, presses, plot and settings appear, the tables with their columns."""
    out = made("predict", made("learn", BAG), MCAP)

    expected = {"timeline.csv", "presses.csv", "timeline.png", "timeline.svg", "settings.json"}
    assert {path.name for path in (out / "predict").iterdir()} == expected
    for name in ("timeline.csv", "presses.csv"):
        assert header_of(out / "predict" / name) == COLUMNS[name]


@pytest.mark.slow
@pytest.mark.parametrize("words", [(), PAPER])
def test_predict_agrees_with_evaluate(made: Made, words: tuple[str, ...]) -> None:
    """The same model on the same log: the same timeline and presses, byte by byte."""
    model = made("learn", BAG, *words)

    predicted = bytes_of(made("predict", model, MCAP) / "predict")

    evaluated = bytes_of(made("evaluate", MCAP, "--model", model) / "evaluate")
    assert predicted["timeline.csv"] == evaluated["timeline.csv"]
    assert predicted["presses.csv"] == evaluated["presses.csv"]


def test_every_scan_has_a_probability(made: Made) -> None:
    """Each scan of the log has a cluster of the model, a probability and a decision."""
    model = made("learn", BAG)

    rows = rows_of(made("predict", model, MCAP) / "predict" / "timeline.csv")

    clusters = {row["cluster"] for row in rows_of(model / "learn" / "clusters.csv")}
    assert len(rows) == 800
    assert {row["cluster"] for row in rows} <= clusters
    assert all(0 <= float(row["p_collision"]) <= 1 for row in rows)
    assert all(float(row["distance"]) >= 0 for row in rows)


def test_a_log_that_was_learnt_is_less_novel(made: Made) -> None:
    """What was learnt is known; another log holds more that is not."""
    model = made("learn", BAG)

    known = rows_of(made("predict", model, BAG) / "predict" / "timeline.csv")
    new = rows_of(made("predict", model, MCAP) / "predict" / "timeline.csv")

    assert total(known, "novel") < total(new, "novel")


def test_presses_in_the_log_do_not_change_the_prediction(made: Made, tmp_path: Path) -> None:
    """Without the bumper the probabilities are the same; truth is empty."""
    model = made("learn", BAG)
    before = rows_of(made("predict", model, MCAP) / "predict" / "timeline.csv")

    done("predict", model, MCAP, "--bump-from", "none", "-o", tmp_path / "out")

    rows = rows_of(tmp_path / "out" / "predict" / "timeline.csv")
    assert [row["p_collision"] for row in rows] == [row["p_collision"] for row in before]
    assert {row["truth"] for row in rows} == {""}
    assert rows_of(tmp_path / "out" / "predict" / "presses.csv") == []


def test_settings_are_those_of_the_model(made: Made) -> None:
    """settings.json names the log and the model that were read, and the model's settings."""
    model = made("learn", BAG, *PAPER)

    record = record_of(made("predict", model, MCAP) / "predict")

    assert record["settings"]["feature"] == "global-diff"
    assert record["settings"]["profile"] == "paper"
    files = (MCAP, model / "learn" / "model.npz")
    assert [one["sha256"] for one in record["inputs"]] == [digest_of(file) for file in files]


def test_a_model_file_does_as_well_as_its_folder(made: Made, tmp_path: Path) -> None:
    """The model alone predicts the same; nothing beside it is needed."""
    model = made("learn", BAG)
    alone = tmp_path / "alone.npz"
    shutil.copy(model / "learn" / "model.npz", alone)

    done("predict", alone, MCAP, "-o", tmp_path / "out")

    found = bytes_of(tmp_path / "out" / "predict")["timeline.csv"]
    assert found == bytes_of(made("predict", model, MCAP) / "predict")["timeline.csv"]


@pytest.mark.parametrize("shape", ["json", "csv"])
def test_what_is_printed_can_be_read(made: Made, tmp_path: Path, shape: str) -> None:
    """--format json and csv hold the same facts in the same order."""
    outcome = done("predict", made("learn", BAG), MCAP, "-o", tmp_path / "out", "--format", shape)

    if shape == "json":
        facts: dict[str, Any] = json.loads(outcome.out)
        assert list(facts) == FACTS
        assert (facts["logs"], facts["scans"], facts["presses_judged"]) == (1, 800, 6)
    else:
        rows = list(csv.DictReader(io.StringIO(outcome.out)))
        assert list(rows[0]) == FACTS
        assert (rows[0]["logs"], rows[0]["scans"]) == ("1", "800")


def test_a_folder_without_a_model_is_named(tmp_path: Path) -> None:
    """A folder in which nothing was learnt ends with exit code 1."""
    (tmp_path / "empty").mkdir()

    outcome = mpap("predict", tmp_path / "empty", MCAP, "-o", tmp_path / "out")

    assert outcome.code == 1
    assert "run mpap learn first" in outcome.err
    assert not (tmp_path / "out").exists()


def test_alarms_are_events_of_the_log_of_predictions(made: Made, tmp_path: Path) -> None:
    """As many as there are runs of alarms in the timeline."""
    out = tmp_path / "out"
    done("predict", made("learn", BAG), MCAP, "--to-mcap", "--out", out)
    rows = rows_of(out / "predict" / "timeline.csv")
    alarms = [row["alarm"] == "1" for row in rows]
    begun = sum(now and not before for before, now in pairwise([False, *alarms]))

    (path,) = (out / "predict").glob("*.mcap")
    with path.open("rb") as file:
        messages = [json.loads(m.data) for _, _, m in make_reader(file).iter_messages(EVENTS_TOPIC)]

    kinds = [entry["value"] for one in messages for entry in one["metadata"]]
    assert kinds.count("alarm") == begun > 0
