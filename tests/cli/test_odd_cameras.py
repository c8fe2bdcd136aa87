"""Cameras as they are in the field: what is broken is left out and told once, the rest is used."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mpap_cli.logs.writing.writer import LogWriter

N_IMAGES = 40
COMPRESSED, RAW = "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/Image"
Message = tuple[int, dict[str, Any]]


def picture(index: int, size: tuple[int, int] = (120, 160)) -> NDArray[np.uint8]:
    """Return a noisy image whose color changes slowly."""
    rng = np.random.default_rng(index)
    noise = rng.integers(0, 90, (*size, 3))
    return np.asarray(noise + np.array((100, 60, 20 + index % 7)), dtype=np.uint8)


def jpeg(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return an image as JPEG bytes."""
    return np.asarray(cv2.imencode(".jpg", image)[1], dtype=np.uint8).ravel()


def images(odd: dict[int, NDArray[np.uint8]]) -> Iterator[Message]:
    """Yield compressed images five times a second; some are replaced."""
    for index in range(N_IMAGES):
        data = odd.get(index, jpeg(picture(index)))
        yield 10**18 + index * 200_000_000, {"format": "jpeg", "data": data}


def write(path: Path, messages: Iterator[Message], msgtype: str = COMPRESSED) -> Path:
    """Write images and a bumper that is pressed for a second."""
    with LogWriter(path, "mcap") as writer:
        for index, (stamp_ns, fields) in enumerate(messages):
            pressed = {"data": 25 <= index < 30}
            writer.write("/bumper", "std_msgs/msg/Bool", stamp_ns, pressed)
            writer.write("/camera", msgtype, stamp_ns + 1, fields)
    return path


@pytest.mark.parametrize(
    ("odd", "said", "n_used"),
    [
        ({7: jpeg(picture(7))[:900], 9: jpeg(picture(9))[:500]}, "2 images left out", 38),
        ({3: jpeg(np.zeros((120, 160, 3), np.uint8))}, "1 image left out: black", 39),
    ],
)
def test_what_cannot_be_seen_is_left_out(
    tmp_path: Path,
    run: Callable[..., Any],
    odd: dict[int, NDArray[np.uint8]],
    said: str,
    n_used: int,
) -> None:
    """Images cut off in the middle of a log, or black ones: one line, exit code 3."""
    path = write(tmp_path / "log.mcap", images(odd))

    outcome = run("learn", path, "-o", tmp_path / "out")

    assert outcome.code == 3
    assert sum(said in line for line in outcome.err.splitlines()) == 1
    assert f"{n_used} images ({n_used * 36:,} patches)" in outcome.out


def test_a_size_that_changes_is_told_and_used(tmp_path: Path, run: Callable[..., Any]) -> None:
    """Every image is brought to one size, so nothing is lost."""
    odd = {index: jpeg(picture(index, (240, 320))) for index in range(20, N_IMAGES)}
    path = write(tmp_path / "log.mcap", images(odd))

    outcome = run("learn", path, "-o", tmp_path / "out")

    assert outcome.code == 0
    assert "log.mcap: size changes, 1 time; all images are used" in outcome.err
    assert "40 images" in outcome.out


def test_an_encoding_that_changes_is_told_and_used(tmp_path: Path, run: Callable[..., Any]) -> None:
    """Color and gray in one topic: both are read."""

    def raw() -> Iterator[Message]:
        for index in range(N_IMAGES):
            image = picture(index)
            is_gray = index >= 30
            data = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if is_gray else image
            yield (
                10**18 + index * 200_000_000,
                {
                    "height": 120,
                    "width": 160,
                    "encoding": "mono8" if is_gray else "bgr8",
                    "step": 160 if is_gray else 480,
                    "data": np.asarray(data, np.uint8).ravel(),
                },
            )

    path = write(tmp_path / "log.mcap", raw(), RAW)

    outcome = run("learn", path, "-o", tmp_path / "out")

    assert outcome.code == 0
    assert "log.mcap: encoding changes, 1 time; all images are used" in outcome.err
    assert "40 images" in outcome.out


def test_images_without_bumps_give_no_probabilities(
    tmp_path: Path, run: Callable[..., Any]
) -> None:
    """Clusters are learnt; that labels are missing, and what would give some, is said."""
    path = tmp_path / "log.mcap"
    with LogWriter(path, "mcap") as writer:
        for stamp_ns, fields in images({}):
            writer.write("/camera", COMPRESSED, stamp_ns, fields)

    outcome = run("learn", path, "-o", tmp_path / "out")

    assert outcome.code == 0
    assert "clusters get no probability" in outcome.err
    assert "no bumper" in outcome.out


def test_a_clock_that_jumps_is_used(tmp_path: Path, run: Callable[..., Any]) -> None:
    """Log time that goes back by a minute loses no image, and novelty counts them all."""
    stamps = [10**18 + index * 200_000_000 for index in range(N_IMAGES)]
    jumped = [stamp - 60 * 10**9 * (index >= 20) for index, stamp in enumerate(stamps)]
    shots = [fields for _, fields in images({})]
    path = write(tmp_path / "log.mcap", iter(zip(jumped, shots, strict=True)))

    learnt = run("learn", path, "-o", tmp_path / "out")
    novel = run("novelty", path, "-o", tmp_path / "out")

    assert (learnt.code, novel.code) == (0, 0)
    assert "40 images" in learnt.out
    assert "1,440 patches" in novel.out
