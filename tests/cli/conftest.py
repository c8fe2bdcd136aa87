"""The command line run in this process, and small logs to run it on."""

import os
import subprocess
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.cli.main import main
from mpap_cli.logs.writing.writer import LogWriter

SCAN = "sensor_msgs/msg/LaserScan"
BOOL = "std_msgs/msg/Bool"
STEP_NS = 200_000_000


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a command ended."""

    code: int
    out: str
    err: str


Run = Callable[..., Outcome]
WriteScans = Callable[..., Path]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Return a function that runs ``mpap`` with words."""

    def call(*words: object) -> Outcome:
        capsys.readouterr()
        with pytest.raises(SystemExit) as left:
            main([str(word) for word in words])
        said = capsys.readouterr()
        return Outcome(int(left.value.code or 0), said.out, said.err)

    return call


@pytest.fixture
def mount(tmp_path: Path) -> Iterator[Callable[[str], Path]]:
    """Return a function that mounts a disk in memory, or once more with other options."""
    place = tmp_path / "disk"
    place.mkdir()

    def call(options: str) -> Path:
        line = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(place)]
        done = subprocess.run(line, capture_output=True, check=False)  # noqa: S603
        if done.returncode:
            pytest.skip("disks cannot be mounted here")
        return place

    yield call
    if os.path.ismount(place):
        # lazy: the error that a test looks at may still hold a file
        subprocess.run(["umount", "--lazy", str(place)], check=True)  # noqa: S603, S607


def scan_message(distance_m: float, n_beams: int, range_max: float = 5.0) -> dict[str, Any]:
    """Return a scan of a wall ahead, open to the sides."""
    middle = n_beams // 2
    ranges = [
        distance_m if abs(beam - middle) < n_beams // 6 else 3.0 + beam / n_beams
        for beam in range(n_beams)
    ]
    return {
        "header": {"frame_id": "laser"},
        "angle_min": -1.57,
        "angle_increment": 3.14 / n_beams,
        "range_min": 0.05,
        "range_max": range_max,
        "ranges": ranges,
    }


@pytest.fixture
def write_scans(tmp_path: Path) -> WriteScans:
    """Return a function that writes a log of approaches; pressed where it is near."""

    def write(  # noqa: PLR0913  # what a log can differ in
        name: str = "log.bag",
        *,
        n_scans: int = 240,
        n_beams: Sequence[int] = (180,),
        topics: Sequence[str] = ("/scan",),
        pressed: str = "near",
        container: str = "bag",
        range_max: float = 5.0,
    ) -> Path:
        path = tmp_path / name
        with LogWriter(path, container) as writer:
            for index in range(n_scans):
                stamp_ns = 10**18 + index * STEP_NS
                distance_m = 2.2 - 0.05 * (index % 40)
                states = {
                    "near": distance_m < 0.4,
                    "from-start": index < 20 or distance_m < 0.4,
                    "always": True,
                    "never": False,
                    "once": 30 <= index < 36,
                    "held": index >= 200,
                }
                if pressed in states:
                    writer.write("/bump", BOOL, stamp_ns - 1000, {"data": states[pressed]})
                for topic in topics:
                    beams = n_beams[index % len(n_beams)]
                    writer.write(topic, SCAN, stamp_ns, scan_message(distance_m, beams, range_max))
        return path

    return write
