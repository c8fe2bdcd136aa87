"""``mpap merge``: one model of several, whatever their order."""

from collections.abc import Callable
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest

from tests.commands.golden import assert_golden
from tests.commands.running import (
    BAG,
    CLUSTER_COLUMNS,
    FIXTURES,
    MCAP,
    PAPER,
    bytes_of,
    digest_of,
    done,
    header_of,
    record_of,
    rows_of,
    total,
)

Made = Callable[..., Path]
LOGS = (BAG, MCAP, FIXTURES / "indoor-b")


def test_merge_writes_its_files(made: Made) -> None:
    """Model, table and settings appear, the table with its columns."""
    out = made("merge", made("learn", BAG), made("learn", MCAP))

    assert {path.name for path in (out / "merge").iterdir()} == {
        "clusters.csv",
        "model.npz",
        "settings.json",
    }
    assert header_of(out / "merge" / "clusters.csv") == CLUSTER_COLUMNS


@pytest.mark.parametrize("words", [(), PAPER])
def test_the_order_of_the_models_does_not_matter(
    made: Made, tmp_path: Path, words: tuple[str, ...]
) -> None:
    """Every order of three models gives the same bytes."""
    models = [made("learn", log, *words) for log in LOGS]
    expected = bytes_of(made("merge", *models) / "merge")

    for number, order in enumerate(permutations(models)):
        done("merge", *order, "-o", tmp_path / str(number))

        assert bytes_of(tmp_path / str(number) / "merge") == expected


def counted(model: Path, command: str) -> list[int]:
    """Return scans, and labels of every kind, over all meta-points of a model."""
    with np.load(model / command / "model.npz") as arrays:
        labels = arrays["collision.meta_points.label_counts"].sum(axis=0)
        return [int(arrays["collision.meta_points.point_count"].sum()), *labels.ravel().tolist()]


@pytest.mark.parametrize("logs", [(BAG,), (BAG, MCAP), LOGS])
def test_counts_add_up(made: Made, logs: tuple[Path, ...]) -> None:
    """No scan, label or visit is lost or counted twice."""
    models = [made("learn", log) for log in logs]

    merged = made("merge", *models)

    leaves = [counted(model, "learn") for model in models]
    assert counted(merged, "merge") == [sum(column) for column in zip(*leaves, strict=True)]
    rows = rows_of(merged / "merge" / "clusters.csv")
    parts = [row for model in models for row in rows_of(model / "learn" / "clusters.csv")]
    assert total(rows, "visits") == total(parts, "visits")
    assert total(rows, "observations") >= total(parts, "observations")


@pytest.mark.parametrize("words", [(), PAPER])
def test_presses_go_with_the_collisions(made: Made, words: tuple[str, ...]) -> None:
    """The cluster with the most collisions knows of their presses and has an interval."""
    models = [made("learn", log, *words) for log in (BAG, MCAP)]

    rows = rows_of(made("merge", *models) / "merge" / "clusters.csv")

    worst = max(rows, key=lambda row: int(row["collisions"]))
    assert int(worst["presses"]) >= 2
    assert float(worst["p_low"]) < float(worst["p_high"])


def test_inputs_are_the_model_files(made: Made) -> None:
    """settings.json names every model by SHA-256."""
    models = [made("learn", BAG), made("learn", MCAP)]

    record = record_of(made("merge", *models) / "merge")

    digests = sorted(digest_of(model / "learn" / "model.npz") for model in models)
    assert [one["sha256"] for one in record["inputs"]] == digests


def test_a_merged_model_predicts(made: Made) -> None:
    """Predict takes the folder of merge, and knows both logs."""
    merged = made("merge", made("learn", BAG), made("learn", MCAP))

    out = made("predict", merged, FIXTURES / "indoor-b")

    rows = rows_of(out / "predict" / "timeline.csv")
    clusters = {row["cluster"] for row in rows_of(merged / "merge" / "clusters.csv")}
    assert len(rows) == 800
    assert {row["cluster"] for row in rows} <= clusters


def test_clusters_are_as_they_were(made: Made) -> None:
    """What two models give together does not change unnoticed."""
    out = made("merge", made("learn", BAG), made("learn", MCAP))

    assert_golden(out / "merge" / "clusters.csv", "merge-robust-clusters.csv")
