"""``learn`` on logs with a camera: the appearance model beside the collision model."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.commands.camera_runs import CAMERA_A, CAMERA_B, SMALL
from tests.commands.conftest import Made
from tests.commands.running import BAG, CLUSTER_COLUMNS, bytes_of, done, header_of, mpap, rows_of

BOTH = {
    "clusters.csv",
    "model.npz",
    "recording.npz",
    "exemplars.png",
    "exemplars-patches.png",
    "exemplars.npz",
    "members.png",
    "settings.json",
}


def test_both_models_are_learnt(made: Made) -> None:
    """A log with scans and images gives clusters of both, in one table and one model."""
    out = made("learn", CAMERA_A, *SMALL) / "learn"

    assert {path.name for path in out.iterdir()} == BOTH
    assert header_of(out / "clusters.csv") == CLUSTER_COLUMNS
    rows = rows_of(out / "clusters.csv")
    assert {row["sensor"] for row in rows} == {"scan", "image"}
    assert {row["feature"] for row in rows if row["sensor"] == "image"} == {"hsv+lbp"}
    with np.load(out / "model.npz") as model:
        header = json.loads(bytes(model["header"]))["header"]
    assert set(header) == {"collision", "appearance"}


def test_images_alone_leave_no_recording(made: Made) -> None:
    """--sensor image learns patches only; there is nothing for evaluate."""
    out = made("learn", CAMERA_A, "--sensor", "image", *SMALL)

    assert {path.name for path in (out / "learn").iterdir()} == {
        *BOTH - {"recording.npz", "exemplars-patches.png"}
    }
    assert {row["sensor"] for row in rows_of(out / "learn" / "clusters.csv")} == {"image"}
    outcome = mpap("evaluate", "-o", out)
    assert outcome.code == 2
    assert "name the logs" in outcome.err


def test_scans_alone_are_those_of_both(made: Made) -> None:
    """Images change nothing of what is learnt from scans."""
    scans = rows_of(made("learn", CAMERA_A, "--sensor", "scan") / "learn" / "clusters.csv")
    both = rows_of(made("learn", CAMERA_A, *SMALL) / "learn" / "clusters.csv")

    assert scans == [row for row in both if row["sensor"] == "scan"]


@pytest.mark.parametrize("jobs", [1, 3, 8])
def test_threads_do_not_matter(made: Made, tmp_path: Path, jobs: int) -> None:
    """The same bytes, whatever --jobs."""
    done("learn", CAMERA_A, *SMALL, "--jobs", jobs, "-o", tmp_path / "out")

    assert bytes_of(tmp_path / "out" / "learn") == bytes_of(
        made("learn", CAMERA_A, *SMALL) / "learn"
    )


def test_a_log_without_free_floor_is_named(tmp_path: Path) -> None:
    """Where the robot never gets ahead far enough only obstacles have labels."""
    far = ("--sensor", "image", "--set", "driven-min-m=100")

    outcome = done("learn", CAMERA_A, *SMALL, *far, "-o", tmp_path / "out")

    assert f"{CAMERA_A.name}: " in outcome.err
    assert "of obstacles, none of free floor" in outcome.err
    assert "--set driven-min-m=0" in outcome.err


def test_a_model_goes_on_with_its_sensors(made: Made, tmp_path: Path) -> None:
    """--model learns the next log with what the model has, and counts both logs."""
    older = made("learn", CAMERA_A, "--sensor", "image", *SMALL)

    done("learn", CAMERA_B, "--model", older, "-o", tmp_path / "out")

    facts = json.loads(done("info", tmp_path / "out", "--format", "json").out)[0]
    assert [log["name"] for log in facts["logs"]] == [CAMERA_A.name, CAMERA_B.name]
    assert {log["scans"] for log in facts["logs"]} == {None}
    before = json.loads(done("info", older, "--format", "json").out)[0]
    assert facts["exemplars"] > before["exemplars"]


def test_a_sensor_that_is_missing_is_named(tmp_path: Path) -> None:
    """--sensor image on a log without a camera ends with exit code 2."""
    outcome = mpap("learn", BAG, "--sensor", "image", "-o", tmp_path / "out")

    assert outcome.code == 2
    assert "no image topic" in outcome.err
    assert not (tmp_path / "out").exists()


def test_evaluate_needs_scans(made: Made, tmp_path: Path) -> None:
    """A model of images only cannot be scored; the message says what to do."""
    model = made("learn", CAMERA_A, "--sensor", "image", *SMALL)

    outcome = mpap("evaluate", BAG, "--model", model, "-o", tmp_path / "out")

    assert outcome.code == 1
    assert "learnt from images only" in outcome.err


def test_merge_joins_laser_models(made: Made, tmp_path: Path) -> None:
    """What was learnt of images is left out, and that is said."""
    outcome = mpap(
        "merge", made("learn", CAMERA_A, *SMALL), made("learn", BAG, *SMALL), "-o", tmp_path / "out"
    )

    assert outcome.code == 0
    assert "what was learnt of images is left out" in outcome.err
    assert {row["sensor"] for row in rows_of(tmp_path / "out" / "merge" / "clusters.csv")} == {
        "scan"
    }
