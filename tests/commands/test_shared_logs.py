"""Recorded logs of real and simulated robots: what info, learn and evaluate must find."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.commands.running import (
    COLUMNS,
    EVALUATE_FILES,
    LEARN_FILES,
    PAPER,
    done,
    evaluated,
    header_of,
    rows_of,
    total,
)

pytestmark = pytest.mark.shared
NEATO1, NEATO2 = "neato_node/msg/Bump", "neato2_interfaces/msg/Bump"
INT8 = "std_msgs/msg/Int8MultiArray"
END = None
Spans = tuple[tuple[float, float | None], ...]


class Known(NamedTuple):
    """What an independent count found in a log."""

    path: str
    container: str
    seconds: float
    scans: int
    beams: int
    no_return: float
    bump_type: str | None
    presses: int
    pressed: int
    images: int = 0
    forward_deg: float = 180


REAL = [
    Known("real/neato-2018-a1.bag", "bag", 31.7, 157, 361, 0.73, NEATO1, 6, 45),
    Known("real/neato-2018-a2.bag", "bag", 28.4, 139, 361, 0.72, NEATO1, 2, 11),
    Known("real/neato-2018-a3.bag", "bag", 29.3, 145, 361, 0.66, NEATO1, 2, 2),
    Known("real/neato-2018-a4.bag", "bag", 5.2, 26, 361, 0.78, NEATO1, 1, 26),
    Known("real/neato-2018-b1.bag", "bag", 43.0, 158, 361, 0.87, NEATO1, 1, 41),
    Known("real/neato-2018-c1.bag", "bag", 65.2, 147, 361, 0.73, NEATO1, 1, 39),
    Known("real/neato-2023-d1", "rosbag2/sqlite3", 44.0, 220, 361, 0.48, NEATO2, 1, 11),
    Known("real/neato-2023-d2", "rosbag2/sqlite3", 71.1, 300, 361, 0.66, NEATO2, 1, 1),
    Known("real/neato-2024-e1", "rosbag2/sqlite3", 63.3, 280, 361, 0.74, NEATO2, 2, 3),
    Known("real/neato-2024-e2", "rosbag2/sqlite3", 56.8, 243, 361, 0.66, NEATO2, 1, 7),
    Known("real/neato-2024-e3", "rosbag2/sqlite3", 41.3, 185, 361, 0.65, NEATO2, 0, 0),
    Known("real/neato-2024-e4", "rosbag2/sqlite3", 32.4, 153, 361, 0.94, NEATO2, 0, 0),
    Known("real/neato-2024-e5", "rosbag2/sqlite3", 36.4, 181, 361, 0.71, NEATO2, 0, 0),
]
GAZEBO = [
    Known("gazebo/gazebo-f1", "rosbag2/sqlite3", 37.4, 187, 361, 0.92, NEATO2, 1, 12),
    Known("gazebo/gazebo-f2", "rosbag2/sqlite3", 32.4, 162, 361, 1.0, NEATO2, 0, 0),
    Known("gazebo/gazebo-f3", "rosbag2/sqlite3", 32.6, 163, 361, 1.0, NEATO2, 0, 0),
    Known("gazebo/gazebo-g1.bag", "bag", 29.4, 146, 361, 0.87, INT8, 4, 23),
    Known("gazebo/gazebo-g2.bag", "bag", 73.8, 368, 361, 0.90, INT8, 2, 2),
    Known("gazebo/gazebo-h1", "rosbag2/sqlite3", 26.4, 128, 361, 0.0, NEATO2, 4, 20),
    Known("gazebo/turtlebot3-scan-only.bag", "bag", 134.3, 538, 128, 0.14, None, 0, 0, 0, 0),
]
OTHERS = [
    Known("camera/neato-2017-i1.bag", "bag", 23.3, 161, 361, 0.70, NEATO1, 0, 0, 123),
    Known("camera/neato-2017-i2.bag", "bag", 18.3, 117, 361, 0.68, NEATO1, 0, 0, 97),
    Known("converted/neato-2024-e1-mcap", "rosbag2/mcap", 63.3, 280, 361, 0.74, NEATO2, 2, 3),
    Known("converted/neato-2024-e1.mcap", "mcap", 63.3, 280, 361, 0.74, NEATO2, 2, 3),
    Known("converted/neato-2017-i1-camera.mcap", "mcap", 23.3, 161, 361, 0.7, NEATO1, 0, 0, 123),
    Known("converted/neato-2018-a1-ros1profile.mcap", "mcap", 31.4, 157, 361, 0.73, NEATO1, 6, 45),
    Known("converted/neato-2018-a2-json.mcap", "mcap", 28.2, 139, 361, 0.72, "Bumper", 2, 11, 0, 0),
]
PRESSES: dict[str, Spans] = {
    "real/neato-2018-a1.bag": (
        (11.1, 11.3),
        (11.8, 14.6),
        (16.4, 16.6),
        (17.4, 17.5),
        (17.8, 18.1),
        (26.4, END),
    ),
    "real/neato-2018-a2.bag": ((25.5, 27.2), (27.5, 27.9)),
    "real/neato-2018-a3.bag": ((28.8, 28.9), (29.1, END)),
    "real/neato-2018-a4.bag": ((0.3, END),),
    "real/neato-2018-b1.bag": ((23.0, 31.7),),
    "real/neato-2018-c1.bag": ((53.4, END),),
    "real/neato-2023-d1": ((42.1, END),),
    "real/neato-2023-d2": ((54.3, 54.5),),
    "real/neato-2024-e1": ((59.4, 59.8), (60.6, 61.0)),
    "real/neato-2024-e2": ((29.7, 31.2),),
    "gazebo/gazebo-f1": ((35.0, END),),
    "gazebo/gazebo-g1.bag": ((8.2, 8.4), (8.6, 8.8), (25.2, 25.7), (25.8, END)),
    "gazebo/gazebo-g2.bag": ((14.4, 14.6), (36.8, 37.1)),
    "gazebo/gazebo-h1": ((10.2, 12.3), (15.3, 16.4), (17.0, 17.3), (20.5, 21.8)),
}
# two presses apart from each other, so that a model of the one can be scored by the other
SCORED = {
    "real/neato-2018-a1.bag",
    "real/neato-2018-a2.bag",
    "real/neato-2024-e1",
    "gazebo/gazebo-g1.bag",
    "gazebo/gazebo-g2.bag",
    "gazebo/gazebo-h1",
}
SAME = [
    ("real/neato-2024-e1", "converted/neato-2024-e1-mcap"),
    ("real/neato-2024-e1", "converted/neato-2024-e1.mcap"),
    ("camera/neato-2017-i1.bag", "converted/neato-2017-i1-camera.mcap"),
    ("real/neato-2018-a1.bag", "converted/neato-2018-a1-ros1profile.mcap"),
]


def facts_of(path: Path) -> dict[str, Any]:
    """Return what ``info --format json`` prints of one log."""
    facts: list[dict[str, Any]] = json.loads(done("info", path, "--format", "json").out)
    return facts[0]


@pytest.mark.parametrize("known", [*REAL, *GAZEBO, *OTHERS], ids=lambda known: known.path)
def test_info_finds_what_is_there(shared_logs: Path, known: Known) -> None:
    """Scans, beams, presses, scans pressed, and the topics that would be used."""
    facts = facts_of(shared_logs / known.path)

    scan, bump, image = facts["scan"], facts["bump"], facts["image"]
    assert facts["container"] == known.container
    assert facts["duration_s"] == pytest.approx(known.seconds, abs=0.06)
    assert (scan["topic"], scan["scans"], scan["beams"]) == ("/scan", known.scans, known.beams)
    assert scan["no_return_share"] == pytest.approx(known.no_return, abs=0.035)
    assert abs(scan["forward_deg"]) == pytest.approx(known.forward_deg)
    assert facts["damage"] == []
    if known.bump_type is None:
        assert bump is None
    else:
        assert (bump["topic"], bump["type"], bump["semantics"]) == (
            "/bump",
            known.bump_type,
            "level",
        )
        assert (bump["presses"], bump["scans_pressed"]) == (known.presses, known.pressed)
    if known.images:
        assert image["topic"] == "/camera/image_raw/compressed"
        assert (image["images"], image["width"], image["height"]) == (known.images, 640, 480)
    else:
        assert image is None


@pytest.mark.slow
@pytest.mark.parametrize("known", [*REAL, *GAZEBO], ids=lambda known: known.path)
def test_learn_and_evaluate_go_through(shared_logs: Path, tmp_path: Path, known: Known) -> None:
    """The main job on each log: exit code 0, every file, the scans and presses counted."""
    learnt = done("learn", shared_logs / known.path, "-o", tmp_path)

    scored = done("evaluate", *PAPER, "-o", tmp_path)

    assert "Traceback" not in learnt.err + scored.err
    assert {path.name for path in (tmp_path / "learn").iterdir()} == LEARN_FILES
    assert {path.name for path in (tmp_path / "evaluate").iterdir()} == EVALUATE_FILES
    assert all(header_of(tmp_path / "evaluate" / name) == COLUMNS[name] for name in COLUMNS)
    clusters = rows_of(tmp_path / "learn" / "clusters.csv")
    assert 0 < total(clusters, "observations") <= known.scans
    first = evaluated(tmp_path, "auc")[0]
    assert (first["feature"], first["bins"], first["profile"]) == ("global-diff", "6", "paper")
    assert [row["truth"] for row in evaluated(tmp_path, "timeline")].count("1") == known.pressed
    assert int(first["positives"]) <= known.pressed
    assert int(first["presses"]) == known.presses
    assert (first["auc"] != "") is (known.path in SCORED)
    assert known.path in SCORED or "held-out AUC empty" in scored.out
    spans = PRESSES.get(known.path, ())
    found = evaluated(tmp_path, "presses")
    assert len(found) == len(spans)
    for row, (start_s, end_s) in zip(found, spans, strict=True):
        assert float(row["start_s"]) == pytest.approx(start_s, abs=0.06)
        last_s = known.seconds if end_s is END else end_s
        assert float(row["end_s"]) == pytest.approx(last_s, abs=0.06)


@pytest.mark.parametrize(("name", "converted"), SAME)
def test_a_converted_log_teaches_the_same(
    shared_logs: Path, tmp_path: Path, name: str, converted: str
) -> None:
    """The container makes no difference to what is counted."""
    found = []

    for number, path in enumerate((name, converted)):
        done("learn", shared_logs / path, "--no-recording", "-o", tmp_path / str(number))
        rows = rows_of(tmp_path / str(number) / "learn" / "clusters.csv")
        counted = ("observations", "collisions", "non_collisions", "presses", "exemplar_stamp_ns")
        found.append([[row[column] for column in counted] for row in rows])

    assert found[0] == found[1]


def test_a_scan_in_json_needs_the_direction(shared_logs: Path, tmp_path: Path) -> None:
    """Without tf angle 0 is ahead, which is said; --forward 180 teaches what the bag does."""
    bag, converted = "real/neato-2018-a2.bag", "converted/neato-2018-a2-json.mcap"
    assumed = done("learn", shared_logs / converted, "-o", tmp_path / "assumed")

    words = ("--forward", "180", "--no-recording")
    done("learn", shared_logs / converted, *words, "-o", tmp_path / "json")
    done("learn", shared_logs / bag, "--no-recording", "-o", tmp_path / "bag")

    assert "--forward DEG" in assumed.err
    found = [rows_of(tmp_path / name / "learn" / "clusters.csv") for name in ("json", "bag")]
    columns = ("observations", "collisions", "presses")
    assert [[row[name] for name in columns] for row in found[0]] == [
        [row[name] for name in columns] for row in found[1]
    ]


@pytest.mark.slow
def test_the_robots_are_groups(shared_logs: Path, tmp_path: Path) -> None:
    """All real logs, each group of robots scored by a model of the others."""
    logs = [shared_logs / known.path for known in REAL]

    done(
        "evaluate", *logs, "--groups", r"neato-\d+-([a-z])", "--feature", "all", "--bins", "6,12",
        "-o", tmp_path,
    )  # fmt: skip

    rows = evaluated(tmp_path, "auc")
    assert {row["protocol"] for row in rows} == {"leave-one-group-out"}
    assert {(row["logs"], row["presses"], row["positives"]) for row in rows} == {
        ("13", "18", str(sum(known.pressed for known in REAL)))
    }
    assert len([row for row in rows if row["profile"] == "paper"]) == 10
    assert all(0 <= float(row["auc"]) <= 1 for row in rows)
