"""Commands go through logs that were recorded as protobuf."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpap_cli.logs.frames import read_frame
from mpap_cli.logs.reader import open_log
from mpap_cli.observations import Frame
from tests.commands.camera_runs import CAMERA_A
from tests.commands.running import FIXTURES, done, mpap, rows_of
from tests.protobufs import write_protobuf

JSON_LOG = FIXTURES / "indoor-json.mcap"
CAMERA = "/camera/image_raw/compressed"
TYPES = {"/scan": "foxglove.LaserScan", "/bump": "robot.Bumper"}


@pytest.fixture(scope="module")
def protobuf_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the JSON fixture, recorded as protobuf."""
    rows: list[tuple[str, str, int, dict[str, Any]]] = []
    with open_log(JSON_LOG) as reader:
        for message in reader.messages(TYPES):
            fields = json.loads(message.payload)
            names = ("start_angle", "end_angle", "ranges", "frame_id", "pressed")
            kept = {name: fields[name] for name in names if name in fields}
            rows.append((message.topic.name, TYPES[message.topic.name], message.stamp_ns, kept))
    # as its neighbor bears it, so that the tables are the same
    return write_protobuf(tmp_path_factory.mktemp("protobuf") / JSON_LOG.name, rows)


def facts_of(path: Path) -> dict[str, Any]:
    """Return what info says of a log."""
    facts: list[dict[str, Any]] = json.loads(done("info", path, "--format", "json").out)
    return facts[0]


def test_info_finds_the_same_as_in_json(protobuf_log: Path) -> None:
    """Scans, presses and what could be learnt; the types are those of the log."""
    found, same = facts_of(protobuf_log), facts_of(JSON_LOG)

    assert [topic["type"] for topic in found["topics"]] == [TYPES["/bump"], TYPES["/scan"]]
    assert {**found["bump"], "type": ""} == {**same["bump"], "type": ""}
    for key in ("scan", "damage", "warnings", "can_learn", "messages", "duration_s"):
        assert found[key] == same[key]


def test_learn_gives_the_same_clusters_as_in_json(protobuf_log: Path, tmp_path: Path) -> None:
    """What the numbers are packed in does not matter."""
    for name, path in (("json", JSON_LOG), ("protobuf", protobuf_log)):
        done("learn", path, "--no-recording", "-o", tmp_path / name)

    json_rows, protobuf_rows = (
        rows_of(tmp_path / name / "learn" / "clusters.csv") for name in ("json", "protobuf")
    )
    assert protobuf_rows == json_rows


def camera_frames() -> list[Frame]:
    """Return images of a camera log."""
    with open_log(CAMERA_A) as reader:
        return [read_frame(reader, message) for message in reader.messages({CAMERA})][:12]


@pytest.mark.parametrize("msgtype", ["foxglove.CompressedImage", "foxglove.RawImage"])
def test_images_are_read(tmp_path: Path, msgtype: str) -> None:
    """Novelty of a log that holds nothing but a camera."""
    pixels = np.arange(160 * 120 * 3, dtype=np.uint32).astype(np.uint8).tobytes()
    form: dict[str, Any] = {"width": 160, "height": 120, "step": 480, "encoding": "bgr8"}
    rows: list[tuple[str, str, int, dict[str, Any]]] = []
    for frame in camera_frames():
        fields = {"data": frame.payload, "format": "png"}
        if msgtype == "foxglove.RawImage":
            fields = {**form, "data": pixels}
        rows.append(("/camera", msgtype, frame.stamp_ns, fields))
    path = write_protobuf(tmp_path / "day.mcap", rows)

    image = facts_of(path)["image"]
    done("novelty", path, "-o", tmp_path / "out")

    assert (image["topic"], image["images"]) == ("/camera", 12)
    assert image["width"] > 0
    assert rows_of(tmp_path / "out" / "novelty" / "novelty.csv")[0]["observations"] != "0"


def test_without_the_extra_the_line_to_paste_is_named(
    protobuf_log: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`info` lists the log; learn ends with the line."""
    monkeypatch.setattr("mpap_cli.logs.protobuf.find_spec", lambda _: None)
    line = 'it is protobuf; pip install "mpap[protobuf]" to read it'

    facts = facts_of(protobuf_log)
    learnt = mpap("learn", protobuf_log, "--scan-topic", "/scan", "-o", tmp_path / "out")

    assert (facts["scan"], facts["bump"], facts["messages"]) == (None, None, 2200)
    assert facts["warnings"] == [
        f"/scan (foxglove.LaserScan) is not used: {line}",
        f"/bump (robot.Bumper) is not used: {line}",
    ]
    assert learnt.code == 2
    assert learnt.err == (
        f"mpap: indoor-json.mcap: --scan-topic /scan: foxglove.LaserScan is not read: {line}\n"
    )
