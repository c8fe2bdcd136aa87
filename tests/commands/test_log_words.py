"""What is said of logs counts in every command, and settings.json names what was read."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.commands.running import (
    BAG,
    MCAP,
    bytes_of,
    digest_of,
    done,
    header_of,
    mpap,
    record_of,
    rows_of,
)

Made = Callable[..., Path]


def facts_of(*words: object) -> dict[str, Any]:
    """Return what ``info`` prints of a log."""
    facts: list[dict[str, Any]] = json.loads(done("info", *words, "--format", "json").out)
    return facts[0]


@pytest.fixture
def presses(tmp_path: Path) -> Path:
    """Return a file with two presses of the log."""
    file = tmp_path / "hits.csv"
    file.write_text(f"log,start_s,end_s\n{BAG.name},10,11\n{BAG.name},30,32\n", encoding="utf-8")
    return file


def test_forward_is_said_of_the_log(made: Made, tmp_path: Path) -> None:
    """Every command turns the log beside a model, and settings.json says so."""
    model = made("learn", BAG)
    plain = bytes_of(made("predict", model, MCAP) / "predict")["timeline.csv"]

    done("predict", model, MCAP, "--forward", "90", "-o", tmp_path)
    done("learn", MCAP, "--model", model, "--forward", "90", "-o", tmp_path)
    done("evaluate", MCAP, "--model", model, "--forward", "90", "-o", tmp_path)

    for command in ("predict", "learn", "evaluate"):
        assert record_of(tmp_path / command)["settings"]["forward"] == "90"
    turned = bytes_of(tmp_path / "predict")["timeline.csv"]
    assert turned != plain
    assert bytes_of(tmp_path / "evaluate")["timeline.csv"] == turned
    assert facts_of(MCAP, "--forward", "90")["scan"]["forward_deg"] == 90


def test_a_model_remembers_forward(tmp_path: Path) -> None:
    """What was said of the logs learnt holds for later ones, unless said otherwise."""
    done("learn", BAG, "--forward", "90", "-o", tmp_path)

    done("predict", tmp_path, MCAP, "-o", tmp_path)
    remembered = record_of(tmp_path / "predict")["settings"]["forward"]
    done("predict", tmp_path, MCAP, "--forward", "tf", "-o", tmp_path)

    assert remembered == "90"
    assert record_of(tmp_path / "predict")["settings"]["forward"] == "tf"


def test_a_recording_keeps_its_forward(tmp_path: Path) -> None:
    """Scored without LOG, settings.json tells the direction that was learnt with."""
    done("learn", BAG, "--forward", "90", "-o", tmp_path)

    done("evaluate", "--profile", "paper", "--protocol", "in-sample", "-o", tmp_path)

    assert record_of(tmp_path / "evaluate")["settings"]["forward"] == "90"


def test_inputs_are_all_files_read(made: Made, tmp_path: Path, presses: Path) -> None:
    """Logs, the file of presses and the older model, in this order."""
    model = made("learn", BAG)

    done("learn", BAG, "--model", model, "--bump-from", presses, "-o", tmp_path)
    done("predict", model, BAG, "--bump-from", presses, "-o", tmp_path)

    files = [BAG, presses, model / "learn" / "model.npz"]
    for command in ("learn", "predict"):
        inputs = record_of(tmp_path / command)["inputs"]
        assert [one["sha256"] for one in inputs] == [digest_of(file) for file in files]


def test_info_takes_presses_from_a_file(presses: Path) -> None:
    """--bump-from FILE.csv: its presses are counted, and no bump topic is named."""
    facts = facts_of(BAG, "--bump-from", presses)

    bump = facts["bump"]
    assert (bump["topic"], bump["semantics"], bump["presses"]) == (None, "file", 2)
    assert (bump["scans_pressed"], bump["pressed_s"]) == (30, 3)
    assert "bump: file hits.csv: 2 presses" in done("info", BAG, "--bump-from", presses).out


def test_info_refuses_a_file_of_other_logs(presses: Path) -> None:
    """As learn does: a press of a log that was not given is a mistake."""
    outcome = mpap("info", MCAP, "--bump-from", presses)

    assert outcome.code == 2
    assert BAG.name in outcome.err


def test_info_takes_presses_from_near_scans(tmp_path: Path) -> None:
    """--bump-from scan: as many presses as learn finds, more where the distance is larger."""
    words = ("--bump-from", "scan", "--bump-distance")

    near, far = (facts_of(BAG, *words, distance) for distance in ("0.25", "0.4"))

    learnt = done("learn", BAG, *words, "0.4", "-o", tmp_path).out
    assert f"{far['bump']['presses']} presses" in learnt
    assert far["bump"]["pressed_s"] > near["bump"]["pressed_s"]
    assert far["bump"]["semantics"] == "scan"
    assert "held-out AUC: not from presses that are made of the scans" in far["can_learn"]


def test_a_cut_beside_the_log_says_nothing_of_presses() -> None:
    """No scan was read: that the bumper was never pressed is not known."""
    facts = facts_of(BAG, "--start", "1000")

    assert facts["scan"]["scans"] == 0
    assert "no scan was read" in facts["can_learn"]
    assert "never pressed" not in facts["can_learn"]


@pytest.mark.parametrize("again", [BAG, BAG.parent / ".." / BAG.parent.name / BAG.name])
def test_a_log_given_twice_is_read_once(made: Made, tmp_path: Path, again: Path) -> None:
    """However it is spelt; one warning says so."""
    outcome = done("learn", BAG, again, "-o", tmp_path)

    assert outcome.err.count("indoor-a.bag: given twice; read once") == 1
    assert "indoor-a.bag: given twice; read once" in record_of(tmp_path / "learn")["warnings"]
    found, expected = bytes_of(tmp_path / "learn"), bytes_of(made("learn", BAG) / "learn")
    del found["settings.json"], expected["settings.json"]  # which keeps the warning
    assert found == expected


def test_a_model_given_twice_is_refused(made: Made, tmp_path: Path) -> None:
    """Its scans would count twice; both names are told, no results are left."""
    model = made("learn", BAG)
    file = model / "learn" / "model.npz"

    outcome = mpap("merge", model, file, "-o", tmp_path / "out")

    assert outcome.code == 2
    assert f"merge: {model} and {file} are the same model; name it once" in outcome.err
    assert not (tmp_path / "out" / "merge").exists()


def test_models_as_csv(made: Made, tmp_path: Path) -> None:
    """One row for each log that a model has learnt, with what the model is."""
    model = made("learn", BAG, MCAP)
    table = tmp_path / "models.csv"

    table.write_text(done("info", model, "--format", "csv").out, encoding="utf-8")

    rows = rows_of(table)
    columns = (
        "path profile feature bins clusters meta_points image_clusters exemplars "
        "log scans images presses"
    )
    assert header_of(table) == columns
    clusters = str(len(rows_of(model / "learn" / "clusters.csv")))
    assert [
        (row["profile"], row["clusters"], row["log"], row["scans"], row["presses"]) for row in rows
    ] == [
        ("robust", clusters, BAG.name, "800", "5"),
        ("robust", clusters, MCAP.name, "800", "6"),
    ]


def test_logs_and_models_do_not_share_a_csv(made: Made) -> None:
    """Their columns differ; one kind at a time, or json."""
    outcome = mpap("info", BAG, made("learn", BAG), "--format", "csv")

    assert (outcome.code, outcome.out) == (2, "")
    assert "--format csv" in outcome.err


def test_odd_names_are_quoted(tmp_path: Path) -> None:
    """A comma in the name of a log does not make a column."""
    log = tmp_path / "a,b.bag"
    log.write_bytes(BAG.read_bytes())
    table = tmp_path / "topics.csv"

    table.write_text(done("info", log, "--format", "csv").out, encoding="utf-8")

    assert {row["name"] for row in rows_of(table)} == {"a,b.bag"}
