"""A log with a camera holds its images, and the truth about them lies beside it."""

import csv
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from mpap_cli.errors import OutputError, SettingError
from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation import sources
from mpap_cli.simulation.camera_messages import ENCODINGS, image_message
from mpap_cli.simulation.scenario import SimulatedLog, simulate
from mpap_cli.simulation.settings import CameraParams, SimulationParams

TOPIC = "/camera/image_raw/compressed"


def make_log(path: Path, duration_s: float = 4, seed: int = 3, **camera: Any) -> SimulatedLog:
    """Write a log with small images."""
    lens = CameraParams(**{"size": "96x72", **camera})
    return simulate(path, SimulationParams(duration_s=duration_s, seed=seed, camera=lens))


def read(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Return stamps and messages by topic, read with rosbags."""
    found: dict[str, list[tuple[int, Any]]] = {}
    with AnyReader([path]) as reader:
        for connection, stamp, payload in reader.messages():
            message = reader.deserialize(payload, connection.msgtype)
            found.setdefault(connection.topic, []).append((stamp, message))
    return found


def header_ns(message: Any) -> int:
    """Return the stamp in a header."""
    return int(message.header.stamp.sec * NS_PER_S + message.header.stamp.nanosec)


def rows_of(path: Path, ending: str) -> list[dict[str, str]]:
    """Return the rows of a table beside a log."""
    with path.with_name(path.name + ending).open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("hz", [5.0, 7.0, 30.0])
def test_images_come_at_their_rate_in_time_order(tmp_path: Path, hz: float) -> None:
    """Headers tell even moments; messages arrive 50 to 80 ms later, in order."""
    log = make_log(tmp_path / "log.mcap", hz=hz)

    found = read(log.path)
    start_ns = SimulationParams().start_stamp_ns
    taken = [header_ns(message) - start_ns for _, message in found[TOPIC]]
    assert taken == [round(i * NS_PER_S / hz) for i in range(len(taken))]
    assert log.n_images == len(taken)
    assert 4 * hz - 2 <= len(taken) <= 4 * hz
    late = [stamp - header_ns(message) for stamp, message in found[TOPIC]]
    assert min(late) >= 50_000_000
    assert max(late) < 80_000_000
    with AnyReader([log.path]) as reader:
        stamps = [stamp for _, stamp, _ in reader.messages()]
    assert stamps == sorted(stamps)


def test_lens_is_told_with_every_image(tmp_path: Path) -> None:
    """CameraInfo has size and focal length: 62 degrees across."""
    log = make_log(tmp_path / "log.mcap")

    found = read(log.path)
    infos, images = found["/camera/camera_info"], found[TOPIC]
    assert [header_ns(m) for _, m in infos] == [header_ns(m) for _, m in images]
    info = infos[0][1]
    assert (info.width, info.height) == (96, 72)
    assert 2 * np.degrees(np.arctan(48 / info.k[0])) == pytest.approx(62)
    assert info.p[0] == info.k[4] == info.k[0]


def test_truth_has_the_stamps_of_the_messages(tmp_path: Path) -> None:
    """There are 36 rows per image; what is near is obstacle, wall or floor, all of it."""
    log = make_log(tmp_path / "log.mcap")

    patches, images = (rows_of(log.path, end) for end in (".patches.csv", ".images.csv"))

    stamps = [stamp for stamp, _ in read(log.path)[TOPIC]]
    assert [int(row["stamp_ns"]) for row in images] == stamps
    assert [int(row["stamp_ns"]) for row in patches] == np.repeat(stamps, 36).tolist()
    assert {row["log"] for row in patches + images} == {"log.mcap"}
    kinds = [[float(row[kind]) for kind in ("floor", "wall", "obstacle")] for row in patches]
    np.testing.assert_allclose(np.sum(kinds, axis=1), 1, atol=2e-4)
    assert all(float(row["free_ahead_m"]) >= 0 for row in images)


def test_way_ahead_is_free_until_the_contact(tmp_path: Path) -> None:
    """It shrinks before a contact; in contact it is shorter than the robot is wide."""
    log = make_log(tmp_path / "log.mcap", duration_s=60)

    rows = rows_of(log.path, ".images.csv")
    stamps = np.array([int(row["stamp_ns"]) for row in rows])
    free_m = np.array([float(row["free_ahead_m"]) for row in rows])
    contacts = [c for c in log.contacts if c.end_ns - c.start_ns > NS_PER_S and c.cause != "foot"]
    assert len(contacts) >= 2
    for contact in contacts:
        during = (stamps > contact.start_ns + 100_000_000) & (stamps < contact.end_ns)
        assert free_m[during].max() < 0.2 or contact.cause.endswith("leg")
    assert free_m.max() > 1


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_encodings_hold_the_same_image(encoding: str) -> None:
    """Each encoding decodes to the image, up to its loss."""
    rng = np.random.default_rng(1)
    image = cv2.resize(rng.integers(0, 256, (6, 8, 3)).astype(np.uint8), (64, 48))
    codes = {"rgb8": cv2.COLOR_RGB2BGR, "mono8": cv2.COLOR_GRAY2BGR}

    fields = image_message(5, np.asarray(image, np.uint8), encoding, 95)

    data = np.asarray(fields["data"], np.uint8)
    if "format" in fields:
        decoded = cv2.imdecode(data, cv2.IMREAD_COLOR)
    else:
        assert (fields["height"], fields["width"]) == (48, 64)
        assert fields["step"] * 48 == len(data)
        decoded = data.reshape(48, 64, -1)
        if encoding == "bayer_rggb8":
            decoded = cv2.cvtColor(decoded, cv2.COLOR_BayerRGGB2BGR)
        elif encoding != "bgr8":
            decoded = cv2.cvtColor(decoded, codes[encoding])
    expected = image
    if encoding == "mono8":
        expected = cv2.cvtColor(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
    loss = np.abs(np.asarray(decoded, int) - np.asarray(expected, int))
    assert loss.mean() < (6 if encoding in ("jpeg", "bayer_rggb8") else 1e-9)


def test_raw_images_are_on_the_raw_topic(tmp_path: Path) -> None:
    """A raw encoding is a sensor_msgs/Image, whose rows are not padded."""
    params = SimulationParams(
        duration_s=2, container="bag", camera=CameraParams(size="96x72", encoding="bgr8")
    )

    log = simulate(tmp_path / "log.bag", params)

    image = read(log.path)["/camera/image_raw"][0][1]

    assert (image.encoding, image.width, image.height, image.step) == ("bgr8", 96, 72, 288)
    assert len(image.data) == 288 * 72


def test_blocks_and_repeats_change_no_byte(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same settings give the same log and truth, whatever the size of a block."""
    logs: list[SimulatedLog] = []

    for i, steps in enumerate((40, 40, 17)):
        monkeypatch.setattr(sources, "_CAMERA_BLOCK_STEPS", steps)
        (tmp_path / str(i)).mkdir()
        logs.append(make_log(tmp_path / str(i) / "log.mcap", duration_s=8, hz=7))

    for ending in ("", ".patches.csv", ".images.csv", ".truth.csv"):
        found = [log.path.with_name("log.mcap" + ending).read_bytes() for log in logs]
        assert found[0] == found[1] == found[2]


def test_camera_is_off_unless_asked_for(tmp_path: Path) -> None:
    """Without a camera there are no images, no tables, and the robot is not bolder."""
    log = simulate(tmp_path / "log.mcap", SimulationParams(duration_s=2))

    assert log.n_images == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["log.mcap", "log.mcap.truth.csv"]


@pytest.mark.parametrize("ending", [".patches.csv", ".images.csv"])
def test_older_truth_is_not_overwritten(tmp_path: Path, ending: str) -> None:
    """Where a table lies already, nothing is written."""
    older = tmp_path / f"log.mcap{ending}"
    older.write_text("mine")

    with pytest.raises(OutputError, match="exists; choose another name"):
        make_log(tmp_path / "log.mcap")

    assert [path.name for path in tmp_path.iterdir()] == [older.name]
    assert older.read_text() == "mine"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"hz": 0.0}, "camera-hz: found 0.0, expected 0.1 to 30"),
        ({"hz": float("nan")}, "camera-hz: found nan"),
        ({"encoding": "gif"}, "image-encoding: found gif, expected one of jpeg, png"),
        ({"size": "640"}, "image-size: found 640, expected even numbers"),
        ({"size": "641x480"}, "image-size: found 641x480"),
        ({"size": "64x4096"}, "image-size: found 64x4096"),
        ({"textures": "z"}, "textures: found z, expected one of a, b, c"),
        ({"light": "night"}, "light: found night, expected one of day, evening, dusk"),
    ],
)
def test_wrong_settings_are_told(words: dict[str, Any], message: str) -> None:
    """A setting that does not exist is named with what was found and expected."""
    with pytest.raises(SettingError, match=message):
        CameraParams(**words)


def test_json_has_no_images() -> None:
    """A camera in a JSON log is refused."""
    with pytest.raises(SettingError, match="camera: not written in JSON"):
        SimulationParams(container="mcap-json", camera=CameraParams())
