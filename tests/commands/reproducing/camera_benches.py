"""Benches for the camera experiments, and what they found."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.request import ReproduceRequest
from mpap_cli.evaluation.reproduced import ITEMS
from tests.commands.camera_runs import CAMERA_A, CAMERA_B

A, B = str(CAMERA_A), str(CAMERA_B)


def short_bench(folder: Path, *only: str, **named: Any) -> Bench:
    """Return a bench at which everything is small, for some items or all."""
    scratch = folder / "scratch"
    scratch.mkdir()
    request = ReproduceRequest(out=folder, short=True, **named)
    return Bench("test", request, frozenset(only or ITEMS), folder, scratch)


def ours(bench: Bench, item: str, row: str, quantity: str) -> float | None:
    """Return the one number in a cell of a table; of durations the seconds."""
    key = (item, row, quantity)
    (found,) = [one for one in bench.found.rows if (one.item, one.row, one.quantity) == key]
    return found.ours if found.seconds is None else found.seconds


def files(bench: Bench) -> list[str]:
    """Return the pictures that were listed, in their order."""
    return [picture.file for picture in bench.found.pictures]


def picture(bench: Bench, name: str) -> NDArray[np.uint8]:
    """Return a picture that was drawn."""
    image = cv2.imread(str(bench.request.out / name))
    assert image is not None
    return np.asarray(image, np.uint8)


def share_of(image: NDArray[np.uint8], color: tuple[int, int, int], tolerance: int = 0) -> float:
    """Return which share of the pixels has a color, blue first, or nearly so."""
    gap = np.abs(image.astype(np.int16) - np.array(color, np.int16)).max(axis=2)
    return float((gap <= tolerance).mean())
