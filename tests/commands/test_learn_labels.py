"""``mpap learn``: where presses come from."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.commands.running import (
    BAG,
    FIXTURES,
    MCAP,
    counts_of,
    done,
    record_of,
    rows_of,
    total,
)

Made = Callable[..., Path]


def test_without_labels_the_clusters_are_the_same(made: Made) -> None:
    """Labels never influence the clustering; without them probabilities are empty."""
    with_labels = rows_of(made("learn", BAG) / "learn" / "clusters.csv")

    without = rows_of(made("learn", BAG, "--bump-from", "none") / "learn" / "clusters.csv")

    same = ("cluster", "observations", "meta_points", "exemplar_stamp_ns", "visits")
    assert [[row[name] for name in same] for row in without] == [
        [row[name] for name in same] for row in with_labels
    ]
    assert {(row["collisions"], row["non_collisions"]) for row in without} == {("0", "0")}
    assert {(row["p_collision"], row["p_low"], row["p_high"]) for row in without} == {("", "", "")}


@pytest.mark.slow
def test_presses_written_by_hand_count_like_the_bumper(made: Made, tmp_path: Path) -> None:
    """The presses.csv of evaluate, given as --bump-from, gives the same counts."""
    presses = made("evaluate", BAG, MCAP, "--protocol", "in-sample") / "evaluate" / "presses.csv"

    done("learn", BAG, MCAP, "--bump-from", presses, "-o", tmp_path / "out")

    by_hand = counts_of(tmp_path / "out", "presses", "visits")
    assert by_hand == counts_of(made("learn", BAG, MCAP), "presses", "visits")
    assert record_of(tmp_path / "out" / "learn")["settings"]["bump-from"] == "presses.csv"


def test_near_scans_can_stand_for_a_bumper(made: Made, tmp_path: Path) -> None:
    """With --bump-from scan a greater distance gives more collisions."""
    done("learn", BAG, "--bump-from", "scan", "--bump-distance", "0.5", "-o", tmp_path / "out")

    near = rows_of(made("learn", BAG, "--bump-from", "scan") / "learn" / "clusters.csv")
    far = rows_of(tmp_path / "out" / "learn" / "clusters.csv")
    assert total(far, "collisions") > total(near, "collisions")


@pytest.mark.parametrize(
    ("name", "n_scans", "n_presses"),
    [
        ("indoor-b", 800, 6),
        ("indoor-json.mcap", 1100, 5),
        ("outdoor.mcap", 1000, 6),
        ("outdoor-gz", 1100, 5),
        ("outdoor-ros1.mcap", 1050, 5),
        ("outdoor-int8.bag", 840, 4),
    ],
)
def test_every_fixture_log_can_be_learnt(
    made: Made, name: str, n_scans: int, n_presses: int
) -> None:
    """Each container and bumper type gives its scans and presses."""
    out = made("learn", FIXTURES / name)

    with np.load(out / "learn" / "model.npz") as model:
        header = json.loads(bytes(model["header"]))["header"]["collision"]
    log = header["logs"][0]
    assert (log["name"], log["n_observations"], log["n_presses"]) == (name, n_scans, n_presses)
    rows = rows_of(out / "learn" / "clusters.csv")
    assert total(rows, "collisions") > 0
