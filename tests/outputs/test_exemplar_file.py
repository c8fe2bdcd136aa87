"""exemplars.npz comes back as it was written."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.errors import ModelError
from mpap_cli.observations import ScanGeometry
from mpap_cli.outputs.exemplar_file import read_exemplar_file, write_exemplar_file
from mpap_cli.outputs.patch_pictures import PatchCluster
from mpap_cli.outputs.scan_pictures import ExemplarPicture

PATCH = np.full((40, 53, 3), (10, 120, 230), dtype=np.uint8)


def scan(cluster: int, image: np.ndarray | None = None) -> ExemplarPicture:
    """Return an exemplar with 720 beams, the first without return."""
    ranges = np.linspace(1, 2, 720, dtype=np.float32)
    ranges[0] = 0
    return ExemplarPicture(
        cluster=cluster,
        p_collision=0.5,
        p_low=0.1,
        p_high=0.9,
        observations=3,
        first_seen_s=0.0,
        log="day1.bag",
        time_s=1.0,
        ranges=ranges,
        geometry=ScanGeometry(720, -1.5, 3 / 719, 0.1, 30.0),
        forward_rad=0.0,
        image=image,
    )


def test_scans_and_patches_come_back(tmp_path: Path) -> None:
    """Scans thinned to 361 beams, photographs as JPEG, the exemplar of a patch before members."""
    path = tmp_path / "exemplars.npz"
    patches = PatchCluster(
        cluster=4, p_obstacle=0.5, observations=2, presses=1, exemplar=PATCH, members=(PATCH,) * 9
    )
    photo = np.zeros((480, 640, 3), dtype=np.uint8)

    write_exemplar_file(path, [scan(7, photo)], [patches])
    found = read_exemplar_file(path)

    assert list(found.scans) == [7]
    assert found.scans[7].angles.size == 360
    assert np.isnan(found.scans[7].ranges[0])
    image = cv2.imdecode(np.frombuffer(found.scans[7].photo, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    assert image.shape == (180, 240, 3)
    assert len(found.patches[4]) == 6
    patch = cv2.imdecode(np.frombuffer(found.patches[4][0], np.uint8), cv2.IMREAD_COLOR)
    assert patch is not None
    assert np.abs(patch.astype(int) - PATCH).max() < 12


def test_clusters_without_picture(tmp_path: Path) -> None:
    """An exemplar that cannot be read any more leaves its cluster without picture."""
    path = tmp_path / "exemplars.npz"
    gone = PatchCluster(cluster=1, p_obstacle=None, observations=2, presses=None, exemplar=None)

    write_exemplar_file(path, [scan(0)], [gone])
    found = read_exemplar_file(path)

    assert found.scans[0].photo == b""
    assert found.patches == {1: ()}


def test_garbled_file(tmp_path: Path) -> None:
    """It is one line, as with every other file."""
    path = tmp_path / "exemplars.npz"
    write_exemplar_file(path, [scan(0)], [])
    path.write_bytes(path.read_bytes()[:200])

    with pytest.raises(ModelError, match="not a whole file of exemplars"):
        read_exemplar_file(path)
