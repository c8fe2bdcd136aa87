"""A camera whose images are broken spoils neither what is learnt nor what is told."""

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from mpap_cli.logs.writing.writer import LogWriter
from tests.cli.conftest import SCAN, STEP_NS, scan_message

IMAGE = "sensor_msgs/msg/CompressedImage"
JPEG = cv2.imencode(".jpg", np.full((30, 40, 3), 90, np.uint8))[1].tobytes()
NO_JPEG = b"no image at all"


def write_camera(path: Path, payload: bytes) -> Path:
    """Write scans with an image each, all of one payload."""
    with LogWriter(path, "bag", "none") as writer:
        for index in range(60):
            stamp_ns = 10**18 + index * STEP_NS
            writer.write("/scan", SCAN, stamp_ns, scan_message(2.2 - 0.05 * (index % 40), 180))
            image = {"format": "jpeg", "data": np.frombuffer(payload, np.uint8)}
            writer.write("/camera/compressed", IMAGE, stamp_ns + 1, image)
    return path


def lengthen_images(path: Path, payload: bytes) -> Path:
    """Let every image claim more bytes than its message has."""
    stated = struct.pack("<I", len(payload)) + payload
    path.write_bytes(path.read_bytes().replace(stated, struct.pack("<I", 2**31) + payload))
    return path


@pytest.fixture(params=["undecodable", "malformed"])
def broken(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Return a log whose images cannot be decoded, or whose messages cannot be read."""
    path = write_camera(tmp_path / "camera.bag", NO_JPEG)
    return path if request.param == "undecodable" else lengthen_images(path, NO_JPEG)


def test_learn_leaves_out_pictures_that_are_broken(
    tmp_path: Path, run: Callable[..., Any], broken: Path
) -> None:
    """One warning with a count; the scans are learnt without, and the exit code tells."""
    outcome = run("learn", broken, "-o", tmp_path / "out")

    assert outcome.code == 3
    told = [line for line in outcome.err.splitlines() if "60 images" in line]
    assert len(told) == 1
    assert told[0].startswith("mpap: camera.bag: ")
    assert (tmp_path / "out" / "learn" / "exemplars.png").is_file()


def test_info_tells_of_a_broken_image(run: Callable[..., Any], broken: Path) -> None:
    """The camera has no size, and a warning says why."""
    page = run("info", broken)
    facts = json.loads(run("info", broken, "--format", "json").out)[0]

    assert page.code == 0
    assert "size unknown" in page.out
    assert "note: the first image could not be decoded" in page.out
    assert (facts["image"]["images"], facts["image"]["width"], facts["image"]["height"]) == (
        60,
        None,
        None,
    )
    assert "the first image could not be decoded" in facts["warnings"]


def test_whole_images_are_not_warned_of(tmp_path: Path, run: Callable[..., Any]) -> None:
    """A good camera is told with its size; learn has nothing to say of it."""
    path = write_camera(tmp_path / "camera.bag", JPEG)

    page = run("info", path)
    learnt = run("learn", path, "-o", tmp_path / "out")

    assert "60 images, 40 x 30, compressed" in page.out
    assert "decoded" not in page.out + learnt.err
