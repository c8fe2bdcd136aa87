"""``mpap learn``: the files it leaves, and that they say what the logs hold."""

import csv
import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.commands.golden import assert_golden
from tests.commands.running import (
    BAG,
    CLUSTER_COLUMNS,
    LEARN_FILES,
    MCAP,
    PAPER,
    bytes_of,
    counts_of,
    digest_of,
    done,
    header_of,
    mpap,
    record_of,
    rows_of,
    total,
)

Made = Callable[..., Path]


def test_learn_writes_its_files(made: Made) -> None:
    """Model, recording, table, pictures and settings appear; beside them only the report."""
    out = made("learn", BAG, MCAP)

    assert {path.name for path in (out / "learn").iterdir()} == LEARN_FILES
    assert {path.name for path in out.iterdir()} == {"learn", "report.html"}


@pytest.mark.parametrize("words", [(), PAPER, ("--bump-from", "none")])
def test_clusters_have_the_columns_of_the_contract(made: Made, words: tuple[str, ...]) -> None:
    """The columns stand in their order, whatever the profile and the labels."""
    out = made("learn", BAG, *words)

    assert header_of(out / "learn" / "clusters.csv") == CLUSTER_COLUMNS


@pytest.mark.parametrize("words", [(), PAPER])
def test_observations_are_those_of_the_cluster_points(made: Made, words: tuple[str, ...]) -> None:
    """The clusters hold every scan that a cluster-point holds, once."""
    out = made("learn", BAG, MCAP, *words)

    rows = rows_of(out / "learn" / "clusters.csv")
    with np.load(out / "learn" / "model.npz") as model:
        count = model["collision.meta_points.point_count"]
        kept = model["collision.meta_points.is_cluster_point"]
    assert total(rows, "observations") == count[kept].sum()
    assert total(rows, "meta_points") == kept.sum()
    assert count.sum() == 1600


def test_collisions_never_exceed_observations(made: Made) -> None:
    """Every counted label belongs to an observation, every press to a visit."""
    out = made("learn", BAG, MCAP)

    for row in rows_of(out / "learn" / "clusters.csv"):
        labelled = int(row["collisions"]) + int(row["non_collisions"])
        assert labelled <= int(row["observations"])
        assert int(row["presses"]) <= int(row["collisions"])
        assert 0 <= float(row["p_low"]) <= float(row["p_high"]) <= 1


def test_profile_paper_shows_the_share_of_collisions(made: Made) -> None:
    """Equation (8): collisions by collisions and non-collisions."""
    out = made("learn", BAG, MCAP, *PAPER)

    for row in rows_of(out / "learn" / "clusters.csv"):
        collisions, others = int(row["collisions"]), int(row["non_collisions"])
        assert float(row["p_collision"]) == pytest.approx(collisions / (collisions + others))
        assert row["profile"] == "paper"
        assert (row["feature"], row["bins"]) == ("global-diff", "6")


def test_profile_robust_shows_the_posterior_mean(made: Made) -> None:
    """Half a collision and half a non-collision are added before the share is taken."""
    out = made("learn", BAG, MCAP)

    for row in rows_of(out / "learn" / "clusters.csv"):
        collisions, others = int(row["collisions"]), int(row["non_collisions"])
        expected = (collisions + 0.5) / (collisions + others + 1)
        assert float(row["p_collision"]) == pytest.approx(expected)
        assert row["profile"] == "robust"


def test_settings_name_what_was_read_and_written(made: Made) -> None:
    """Inputs by base name, size and SHA-256; outputs by SHA-256."""
    out = made("learn", BAG, MCAP)

    record = record_of(out / "learn")
    assert record["inputs"] == [
        {"name": log.name, "size": log.stat().st_size, "sha256": digest_of(log)}
        for log in (BAG, MCAP)
    ]
    assert record["outputs"] == {
        name: digest_of(out / "learn" / name) for name in LEARN_FILES - {"settings.json"}
    }


def test_settings_hold_no_paths_jobs_or_dates(made: Made) -> None:
    """What cannot change results is left out; what can is there."""
    out = made("learn", BAG, MCAP)

    text = (out / "learn" / "settings.json").read_text(encoding="utf-8")
    settings = record_of(out / "learn")["settings"]
    assert str(BAG.parent) not in text
    assert str(out) not in text
    assert not {"jobs", "out", "date", "time", "path"} & set(settings)
    assert {"theta", "seed", "profile", "start", "bump-from", "time-source"} <= set(settings)


@pytest.mark.parametrize(("name", "words"), [("robust", ()), ("paper", PAPER)])
def test_clusters_are_as_they_were(made: Made, name: str, words: tuple[str, ...]) -> None:
    """What two logs teach does not change unnoticed."""
    out = made("learn", BAG, MCAP, *words)

    assert_golden(out / "learn" / "clusters.csv", f"learn-{name}-clusters.csv")


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_the_same_run_gives_the_same_bytes(made: Made, tmp_path: Path, jobs: int) -> None:
    """Neither the day nor the number of threads can be seen in the results."""
    before = bytes_of(made("learn", BAG, MCAP) / "learn")

    done("learn", BAG, MCAP, "-o", tmp_path / "again", "--jobs", jobs)

    assert bytes_of(tmp_path / "again" / "learn") == before


@pytest.mark.parametrize("words", [(), PAPER])
def test_learning_on_is_learning_both(made: Made, tmp_path: Path, words: tuple[str, ...]) -> None:
    """One log, then another with --model, counts as both in one go."""
    both = made("learn", BAG, MCAP, *words)

    done("learn", MCAP, "--model", made("learn", BAG, *words), "-o", tmp_path / "out")

    assert counts_of(tmp_path / "out") == counts_of(both)


def test_a_model_keeps_its_own_settings(made: Made, tmp_path: Path) -> None:
    """Settings beside --model are refused, with exit code 2 and no results."""
    outcome = mpap(
        "learn", MCAP, "--model", made("learn", BAG), "--bins", "6", "-o", tmp_path / "out"
    )

    assert outcome.code == 2
    assert "--model" in outcome.err
    assert not (tmp_path / "out").exists()


def test_no_recording_leaves_only_the_recording_out(made: Made, tmp_path: Path) -> None:
    """Clusters and model are the same bytes; an older recording goes."""
    out = tmp_path / "out"
    shutil.copytree(made("learn", BAG), out)

    done("learn", BAG, "-o", out, "--no-recording")

    found, before = bytes_of(out / "learn"), bytes_of(made("learn", BAG) / "learn")
    assert set(found) == LEARN_FILES - {"recording.npz"}
    assert all(found[name] == before[name] for name in ("clusters.csv", "model.npz"))


def test_start_and_end_cut_each_log(tmp_path: Path) -> None:
    """Only scans between them are learnt, times still count from the first message."""
    done("learn", BAG, MCAP, "--start", "0:20", "--end", "50.0", "-o", tmp_path / "out")

    rows = rows_of(tmp_path / "out" / "learn" / "clusters.csv")
    assert min(float(row["first_seen_s"]) for row in rows) >= 20
    assert max(float(row["last_seen_s"]) for row in rows) <= 50
    with np.load(tmp_path / "out" / "learn" / "model.npz") as model:
        header = json.loads(bytes(model["header"]))["header"]["collision"]
    assert [log["n_observations"] for log in header["logs"]] == [300, 300]


@pytest.mark.parametrize("shape", ["json", "csv"])
def test_what_is_printed_is_the_table(made: Made, tmp_path: Path, shape: str) -> None:
    """--format csv prints clusters.csv, json the same cells by their names."""
    outcome = done("learn", BAG, "-o", tmp_path / "out", "--format", shape)

    expected = (made("learn", BAG) / "learn" / "clusters.csv").read_text(encoding="utf-8")
    if shape == "csv":
        assert outcome.out == expected
    else:
        found: list[dict[str, Any]] = json.loads(outcome.out)
        assert list(found[0]) == CLUSTER_COLUMNS.split()
        listed = csv.DictReader(io.StringIO(expected))
        assert [str(row["observations"]) for row in found] == [
            row["observations"] for row in listed
        ]
