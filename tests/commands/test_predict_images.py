"""``predict`` on images: patches, decisions, pictures and the log for viewers."""

import csv
import json
from collections import Counter
from pathlib import Path

import pytest
from mcap.reader import make_reader

from tests.commands.camera_runs import (
    CAMERA_A,
    CAMERA_B,
    DECISION_COLUMNS,
    PATCH_COLUMNS,
    SMALL,
)
from tests.commands.conftest import Made
from tests.commands.running import done, header_of, mpap, rows_of

ACTIONS = {"straight", "rotate-left", "rotate-right", "stop"}


@pytest.fixture
def predicted(made: Made) -> Path:
    """Return the results of predicting the images that were learnt."""
    model = made("learn", CAMERA_A, "--sensor", "image", *SMALL)
    return made("predict", model, CAMERA_A, "--to-mcap") / "predict"


def test_every_patch_of_every_image_has_a_row(predicted: Path) -> None:
    """36 patches an image, each with a probability, unknown or not."""
    patches = rows_of(predicted / "patches.csv")
    decisions = rows_of(predicted / "decisions.csv")

    assert header_of(predicted / "patches.csv") == PATCH_COLUMNS
    assert header_of(predicted / "decisions.csv") == DECISION_COLUMNS
    assert len(patches) == 36 * len(decisions) > 0
    assert all(0 <= float(row["p_obstacle"]) <= 1 for row in patches)
    assert {(int(row["row"]), int(row["column"])) for row in patches} == {
        (row, column) for row in range(6) for column in range(6)
    }
    assert {row["action"] for row in decisions} <= ACTIONS


def test_decisions_count_their_patches(predicted: Path) -> None:
    """Known patches at or above the threshold are obstacles, unknown ones are counted apart."""
    obstacle, unknown = Counter[str](), Counter[str]()
    for row in rows_of(predicted / "patches.csv"):
        unknown[row["stamp_ns"]] += int(row["unknown"])
        is_obstacle = float(row["p_obstacle"]) >= 0.5 and row["unknown"] == "0"
        obstacle[row["stamp_ns"]] += is_obstacle

    for row in rows_of(predicted / "decisions.csv"):
        found = int(row["obstacle_patches"]), int(row["unknown_patches"])
        assert found == (obstacle[row["stamp_ns"]], unknown[row["stamp_ns"]])


def test_pictures_are_drawn(predicted: Path) -> None:
    """Annotated images and the map lie beside the tables."""
    found = {path.name for path in predicted.iterdir()}

    assert {"annotated.png", "map.png", "0-camera-a.mcap.mcap"} <= found


def test_the_log_of_predictions_opens_beside_the_original(predicted: Path) -> None:
    """An annotated image and a decision at the stamp of every image, presses as events."""
    topics: Counter[str] = Counter()
    stamps: set[str] = set()
    with (predicted / "0-camera-a.mcap.mcap").open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages():
            topics[channel.topic] += 1
            if channel.topic == "/mpap/annotated":
                stamps.add(str(message.log_time))

    decisions = rows_of(predicted / "decisions.csv")
    assert stamps == {row["stamp_ns"] for row in decisions}
    assert topics["/mpap/decision"] == len(decisions)
    assert topics["/mpap/events"] > 0


def test_scans_and_images_are_predicted_together(made: Made) -> None:
    """A model of both writes the tables of both."""
    out = made("predict", made("learn", CAMERA_A, *SMALL), CAMERA_A)

    found = {path.name for path in (out / "predict").iterdir()}

    assert {"timeline.csv", "presses.csv", "decisions.csv", "patches.csv"} <= found


def test_a_higher_threshold_finds_fewer_obstacles(made: Made, tmp_path: Path) -> None:
    """--patch-threshold counts instead of what was learnt."""
    model = made("learn", CAMERA_A, "--sensor", "image", *SMALL)

    low, high = (
        json.loads(
            done(
                "predict", model, CAMERA_A, "--patch-threshold", share, "--format", "json",
                "-o", tmp_path / share,
            ).out
        )
        for share in ("0.1", "0.9")
    )  # fmt: skip

    assert low["obstacle_patches"] > high["obstacle_patches"]
    assert low["images"] == high["images"]


def test_another_world_is_unknown(made: Made, tmp_path: Path) -> None:
    """Surfaces of other kinds are marked unknown; each still has a probability."""
    model = made("learn", CAMERA_A, "--sensor", "image", *SMALL)

    outcome = mpap("predict", model, CAMERA_B, "-o", tmp_path / "out")

    with (tmp_path / "out" / "predict" / "patches.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert outcome.code == 0
    assert sum(int(row["unknown"]) for row in rows) >= 0.9 * len(rows)
    assert all(row["p_obstacle"] for row in rows)
