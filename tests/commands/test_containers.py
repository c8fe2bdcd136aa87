"""One run of a simulated robot in every container, compression and bumper type."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.commands.simulate import simulate
from mpap_cli.logs.writing.storages import CONTAINERS
from mpap_cli.outputs.recording import read_recording
from mpap_cli.simulation.bumper_messages import BUMPER_TYPES
from tests.commands.running import digest_of, done, rows_of, total

SEED, DURATION_S = 28, 40.0
WRITTEN = [(name, packed) for name, choices in CONTAINERS.items() for packed in choices]
SUFFIXES = {"bag": ".bag", "rosbag2-sqlite3": "", "rosbag2-mcap": ""}
# a level topic tells of a press at its next message, up to a tenth of a second late
LEVEL_LATE_S = 0.101
# a touching robot tells every twentieth of a second; a quarter second later it is free
PULSE_HOLD_S = 0.25 + 0.051
FROM_START = ("exemplar_time_s", "first_seen_s", "last_seen_s")
Write = Callable[..., Path]


@pytest.fixture(scope="session")
def write(tmp_path_factory: pytest.TempPathFactory) -> Write:
    """Return a function that writes the same run into a container, once for all tests."""
    written: dict[tuple[tuple[str, str], ...], Path] = {}

    def call(**params: str) -> Path:
        key = tuple(sorted(params.items()))
        if key not in written:
            suffix = SUFFIXES.get(params["container"], ".mcap")
            path = tmp_path_factory.mktemp("log") / f"run{suffix}"
            settings = {"duration_s": DURATION_S, "seed": SEED, "no_return": "zero", **params}
            simulate(path, None, **settings)
            written[key] = path
        return written[key]

    return call


def learnt(path: Path, out: Path) -> list[dict[str, str]]:
    """Learn a log and return its clusters, without the name of the log."""
    done("learn", "--no-recording", path, "-o", out)
    rows = rows_of(out / "learn" / "clusters.csv")
    return [{**row, "exemplar_log": ""} for row in rows]


def without(row: dict[str, str], columns: tuple[str, ...]) -> dict[str, str]:
    """Return a row without some columns."""
    return {name: cell for name, cell in row.items() if name not in columns}


def presses_of(path: Path, out: Path) -> list[tuple[float, float]]:
    """Return start and end of the presses of a log."""
    done("learn", path, "-o", out)
    log = read_recording(out / "learn" / "recording.npz")[0]
    return [
        ((press.start_ns - log.start_ns) * 1e-9, (press.end_ns - log.start_ns) * 1e-9)
        for press in log.presses or ()
    ]


def bump_of(path: Path) -> dict[str, Any]:
    """Return what info says of the bumper."""
    facts: list[dict[str, Any]] = json.loads(done("info", path, "--format", "json").out)
    bump: dict[str, Any] = facts[0]["bump"]
    return bump


@pytest.mark.slow
@pytest.mark.parametrize(("container", "compression"), WRITTEN)
def test_every_container_teaches_the_same(
    write: Write, tmp_path: Path, container: str, compression: str
) -> None:
    """The same stamps, ranges and bumper states give the same clusters.csv."""
    level = {"bumper": "pressed" if container == "mcap-json" else "bool"}
    first = learnt(write(container="bag", compression="lz4", bumper="bool"), tmp_path / "first")

    path = write(container=container, compression=compression, **level)
    found = learnt(path, tmp_path / "found")

    # in JSON there is no transform, so that the log begins with its first scan
    left_out = FROM_START if container == "mcap-json" else ()
    assert [without(row, left_out) for row in found] == [without(row, left_out) for row in first]
    assert total(found, "observations") > 0
    assert total(found, "collisions") > 0


@pytest.mark.slow
@pytest.mark.parametrize("bumper", [name for name in BUMPER_TYPES if name != "pressed"])
@pytest.mark.parametrize("container", ["bag", "rosbag2-sqlite3", "mcap-ros1"])
def test_every_bumper_type_tells_the_same_presses(
    write: Write, tmp_path: Path, container: str, bumper: str
) -> None:
    """Edge, level and pulse bumpers differ by how late their messages come, no more."""
    exact = presses_of(write(container="mcap", bumper="kobuki"), tmp_path / "exact")

    path = write(container=container, bumper=bumper)
    presses = presses_of(path, tmp_path / "presses")

    assert bump_of(path)["semantics"] == BUMPER_TYPES[bumper].kind
    late_s = 0.0 if BUMPER_TYPES[bumper].kind == "edge" else LEVEL_LATE_S
    hold_s = PULSE_HOLD_S if BUMPER_TYPES[bumper].kind == "pulse" else late_s
    assert len(presses) == len(exact) > 1
    for (start_s, end_s), (exact_start_s, exact_end_s) in zip(presses, exact, strict=True):
        assert exact_start_s <= start_s + 1e-9
        assert start_s <= exact_start_s + late_s + 1e-9
        assert exact_end_s <= end_s + 1e-9
        assert end_s <= exact_end_s + hold_s + 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("bumper", ["bool", "gazebo", "int8"])
def test_level_bumpers_give_the_same_clusters(write: Write, tmp_path: Path, bumper: str) -> None:
    """What the state is packed in does not matter to what is learnt."""
    first = learnt(write(container="mcap", bumper="neato"), tmp_path / "first")

    found = learnt(write(container="mcap", bumper=bumper), tmp_path / "found")

    assert found == first


def test_the_same_seed_writes_the_same_log(write: Write, tmp_path: Path) -> None:
    """A simulated log is known by its settings: the same bytes again."""
    first = write(container="mcap", bumper="bool")

    again = tmp_path / "run.mcap"
    words = ("--duration", DURATION_S, "--seed", SEED, "--bumper", "bool", "--no-return", "zero")
    done("simulate", again, *words)

    assert digest_of(again) == digest_of(first)
    truth = "run.mcap.truth.csv"
    assert digest_of(tmp_path / truth) == digest_of(first.with_name(truth))
