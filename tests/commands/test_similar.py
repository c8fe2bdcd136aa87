"""``mpap similar``: the earlier moments that look most like one of a log."""

import json
from pathlib import Path

import pytest

from tests.commands.conftest import Made
from tests.commands.running import BAG, FIXTURES, MCAP, done, header_of, mpap, rows_of

CAMERA = FIXTURES / "camera-a.mcap"


@pytest.fixture
def model(made: Made) -> Path:
    """Return what was learnt of a log with scans and images."""
    return made("learn", CAMERA)


def test_scan_of_another_log(made: Made, tmp_path: Path) -> None:
    """Moments of the logs learnt, by distance, in the table and in the file."""
    known = made("learn", BAG, MCAP)

    outcome = done("similar", known, "--at", f"{BAG}@30", "-o", tmp_path, "--format", "json")
    rows = rows_of(tmp_path / "similar" / "similar.csv")

    assert header_of(tmp_path / "similar" / "similar.csv") == (
        "log time_s stamp_ns cluster distance"
    )
    distances = [float(row["distance"]) for row in rows]
    assert distances == sorted(distances)
    assert {row["log"] for row in rows} == {BAG.name, MCAP.name}
    assert all(float(row["time_s"]) < 30 for row in rows if row["log"] == BAG.name)
    assert [row["distance"] for row in json.loads(outcome.out)] == distances


def test_exemplar_is_most_like_itself(model: Path, tmp_path: Path) -> None:
    """A copy of the log under another name holds the exemplar's moment at distance 0."""
    (row, *_) = rows_of(model / "learn" / "clusters.csv")
    copy = tmp_path / "copy.mcap"
    copy.write_bytes(CAMERA.read_bytes())

    done("similar", model, "--at", f"{copy}@{row['exemplar_time_s']}", "-o", tmp_path)
    (first, *_) = rows_of(tmp_path / "similar" / "similar.csv")

    assert first["stamp_ns"] == row["exemplar_stamp_ns"]
    assert first["cluster"] == row["cluster"]


def test_image(model: Path, tmp_path: Path) -> None:
    """With --sensor image the patches are looked at; --count limits."""
    words = ("--sensor", "image", "--count", 2, "--apart", 1)
    done("similar", model, "--at", f"{CAMERA}@20", *words, "-o", tmp_path)

    rows = rows_of(tmp_path / "similar" / "similar.csv")
    assert len(rows) == 2
    assert all(float(row["time_s"]) < 20 for row in rows)


@pytest.mark.parametrize(
    ("at", "sensor", "said"),
    [
        (str(CAMERA), "auto", "no moment; write LOG@TIME"),
        (f"{CAMERA}@soon", "auto", "time soon: expected seconds"),
        (f"{CAMERA}@9999", "auto", "the log is 30.0 s long; look inside it"),
        (f"{FIXTURES}/indoor-a*@3", "auto", "logs; name one"),
        (f"{BAG}@3", "image", "the model knows nothing of images"),
    ],
)
def test_moments_that_are_none(made: Made, tmp_path: Path, at: str, sensor: str, said: str) -> None:
    """Each is one line, exit code 2."""
    known = made("learn", BAG, MCAP)

    outcome = mpap("similar", known, "--at", at, "--sensor", sensor, "-o", tmp_path)

    assert outcome.code == 2
    assert said in outcome.err
