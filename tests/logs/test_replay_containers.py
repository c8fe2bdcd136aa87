"""Images and odometry out of logs of several containers."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpap_cli.logs.fields import TimeSource
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.topics import choose_roles
from mpap_cli.logs.writing.writer import LogWriter
from mpap_cli.observations import NS_PER_S, Batch, Frame
from mpap_cli.params import BumperParams

RAW, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
START_S, N_IMAGES = 1000, 20
CONTENT = bytes(range(2 * 10))
RAW_FORM = {"width": 3, "height": 2, "encoding": "bgr8", "step": 10}


def ns(seconds: float) -> int:
    """Return the stamp of a moment of the log."""
    return round((START_S + seconds) * NS_PER_S)


def path_of(folder: Path, container: str) -> Path:
    """Return where a log of a container goes."""
    if container.startswith("rosbag2"):
        return folder / "log"
    return folder / ("log.bag" if container == "bag" else "log.mcap")


def image(container: str, seconds: float, form: dict[str, Any]) -> tuple[str, int, dict[str, Any]]:
    """Return type, stamp and fields of an image, compressed if it has no form."""
    inside_s = int(seconds) + 50
    if container == "mcap-json":
        content = base64.b64encode(CONTENT).decode()
        fields = {"timestamp": {"sec": inside_s, "nsec": 0}, "data": content, **form}
        return "foxglove.RawImage" if form else "foxglove.CompressedImage", ns(seconds), fields
    header = {"stamp": {"sec": inside_s}, "frame_id": "camera"}
    fields = {"header": header, "data": np.frombuffer(CONTENT, np.uint8), **form}
    return RAW if form else COMPRESSED, ns(seconds), fields


def play(path: Path, *sensors: str, time_source: TimeSource = "log") -> tuple[list[Batch], Replay]:
    """Play back some sensors of a log."""
    with open_log(path) as reader:
        options = ReplayOptions(sensors=frozenset(sensors), time_source=time_source)
        replay = Replay(reader, choose_roles(reader), BumperParams(), options)
        return list(replay), replay


@pytest.mark.parametrize("time_source", ["log", "header"])
@pytest.mark.parametrize("container", ["mcap", "mcap-ros1", "bag", "mcap-json", "rosbag2-sqlite3"])
@pytest.mark.parametrize("form", [{}, RAW_FORM], ids=["compressed", "raw"])
def test_images_are_the_same_in_every_container(
    tmp_path: Path, form: dict[str, Any], container: str, time_source: TimeSource
) -> None:
    """Rows with padding come as they are; CDR, ROS 1 and JSON give the same."""
    path = path_of(tmp_path, container)
    with LogWriter(path, container) as writer:
        for i in range(N_IMAGES):
            writer.write("/camera", *image(container, i, form))

    batches, replay = play(path, "image", time_source=time_source)

    inside_ns = [(i + 50) * NS_PER_S for i in range(N_IMAGES)]
    stamps_ns = inside_ns if time_source == "header" else [ns(i) for i in range(N_IMAGES)]
    known = ("bgr8", 3, 2, 10) if form else ("compressed", 0, 0, 0)
    frames = [frame for batch in batches for frame in batch.frames]
    assert frames == [Frame(stamp_ns, *known, CONTENT) for stamp_ns in stamps_ns]
    assert (replay.skipped, replay.start_ns) == ({}, stamps_ns[0])


@pytest.mark.parametrize("container", ["mcap", "mcap-ros1", "bag", "rosbag2-mcap"])
def test_odometry_is_the_same_in_every_container(tmp_path: Path, container: str) -> None:
    """CDR and ROS 1 give the same poses, beside images and bumps."""
    path = path_of(tmp_path, container)
    turned = {"z": 0.5**0.5, "w": 0.5**0.5}
    with LogWriter(path, container) as writer:
        for i in range(300):
            where = {"position": {"x": 0.01 * i, "y": -0.01 * i}, "orientation": turned}
            fields = {"child_frame_id": "base_link", "pose": {"pose": where}}
            writer.write("/odom", "nav_msgs/msg/Odometry", ns(0.1 * i), fields)
            if i % 10 == 0:
                writer.write("/camera", *image(container, 0.1 * i + 0.05, {}))
                writer.write("/bump", "std_msgs/msg/Bool", ns(0.1 * i + 0.06), {"data": True})

    (batch,), _ = play(path, "image", "odometry")

    assert batch.poses is not None
    assert batch.poses.stamps_ns.tolist() == [ns(0.1 * i) for i in range(300)]
    x = 0.01 * np.arange(300)
    expected = np.column_stack([x, -x, np.full(300, np.pi / 2)])
    np.testing.assert_allclose(batch.poses.poses, expected)
    assert (len(batch.frames), len(batch.bumps)) == (30, 1)
