"""exemplars.npz: the exemplar of every cluster as it was seen, small, for the report."""

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from mpap_cli.errors import ModelError
from mpap_cli.observations import Float32Array
from mpap_cli.outputs.array_members import open_members, read_array, read_record, write_array
from mpap_cli.outputs.array_members import write_record as write_json
from mpap_cli.outputs.canvas import Image
from mpap_cli.outputs.model_file import check_format
from mpap_cli.outputs.patch_pictures import PatchCluster
from mpap_cli.outputs.probabilities import divide, rank
from mpap_cli.outputs.scan_pictures import ExemplarPicture
from mpap_cli.outputs.scan_views import see

EXEMPLARS_NAME = "exemplars.npz"
FORMAT = "mpap exemplars"
VERSION = 1
MOST_CLUSTERS = 240
_WHAT = "file of exemplars"
_MOST_BEAMS = 361
_MOST_MEMBERS = 5
_PHOTO_WIDTH = 240
_JPEG_QUALITY = 82


@dataclass(frozen=True, slots=True, eq=False)
class ScanExemplar:
    """A scan by angle, and a photograph.

    ``angles`` (n,) in degrees about forward, left positive; ``ranges`` (n,) in metres, NaN
    without return; ``photo`` a JPEG of that moment, empty if there is none.
    """

    angles: Float32Array
    ranges: Float32Array
    photo: bytes


@dataclass(frozen=True, slots=True, eq=False)
class Exemplars:
    """By the number of the cluster: scans, and JPEGs of patches (the exemplar, then members)."""

    scans: dict[int, ScanExemplar]
    patches: dict[int, tuple[bytes, ...]]


def write_exemplar_file(
    path: Path, scans: Sequence[ExemplarPicture], patches: Sequence[PatchCluster]
) -> None:
    """Write the exemplars of both models.

    Parameters
    ----------
    path : Path
        File to write.
    scans, patches : sequence
        One a cluster; of more than 240 of a kind those with the highest and the lowest
        probability are kept, two to one.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    kept_scans, _ = divide(sorted(scans, key=lambda one: -rank(one.p_collision)), MOST_CLUSTERS)
    kept, _ = divide(sorted(patches, key=lambda one: -rank(one.p_obstacle)), MOST_CLUSTERS)
    record: dict[str, object] = {
        "format": FORMAT,
        "version": VERSION,
        "scans": [one.cluster for one in kept_scans],
        "patches": [[one.cluster, len(_pictures(one))] for one in kept],
    }
    with zipfile.ZipFile(path, "w") as archive:
        for one in kept_scans:
            seen = see(one.ranges, one.geometry, one.forward_rad, one.range_max)
            thin = slice(None, None, max(1, -(-seen.angles.size // _MOST_BEAMS)))
            name = f"scan{one.cluster:05d}"
            write_array(archive, f"{name}/angles", seen.angles[thin].astype(np.float32))
            write_array(archive, f"{name}/ranges", seen.ranges[thin].astype(np.float32))
            write_array(archive, f"{name}/photo", _jpeg(one.image, _PHOTO_WIDTH))
        for cluster in kept:
            for index, picture in enumerate(_pictures(cluster)):
                name = f"patch{cluster.cluster:05d}/{index}"
                write_array(archive, name, _jpeg(picture, picture.shape[1]))
        write_json(archive, _WHAT, record)


def _pictures(one: PatchCluster) -> list[Image]:
    """Return the exemplar and some members; nothing where the exemplar is not at hand."""
    return [] if one.exemplar is None else [one.exemplar, *one.members[:_MOST_MEMBERS]]


def _jpeg(image: Image | None, width: int) -> np.ndarray[tuple[int], np.dtype[np.uint8]]:
    """Encode an image as JPEG, made narrower if it is wider than that."""
    if image is None:
        return np.zeros(0, dtype=np.uint8)
    size = (width, max(1, round(image.shape[0] * width / image.shape[1])))
    is_wide = image.shape[1] > width
    shown = cv2.resize(image, size, interpolation=cv2.INTER_AREA) if is_wide else image
    _, encoded = cv2.imencode(".jpg", shown, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    return np.asarray(encoded, dtype=np.uint8).reshape(-1)


def read_exemplar_file(path: Path) -> Exemplars:
    """Read what :func:`write_exemplar_file` wrote.

    Raises
    ------
    ModelError
        If the file is missing, of another kind or version, or garbled.
    """
    with open_members(path, _WHAT) as archive:
        record = read_record(archive, _WHAT)
        check_format(path, record, FORMAT, VERSION)
        scans = {int(one): _scan(archive, int(one)) for one in record["scans"][:MOST_CLUSTERS]}
        patches = {
            int(one): tuple(
                read_array(archive, f"patch{int(one):05d}/{index}").tobytes()
                for index in range(min(int(number), 1 + _MOST_MEMBERS))
            )
            for one, number in record["patches"][:MOST_CLUSTERS]
        }
    return Exemplars(scans, patches)


def _scan(archive: zipfile.ZipFile, cluster: int) -> ScanExemplar:
    name = f"scan{cluster:05d}"
    angles, ranges = (read_array(archive, f"{name}/{part}") for part in ("angles", "ranges"))
    if angles.ndim != 1 or angles.shape != ranges.shape or angles.dtype != np.float32:
        msg = f"{_WHAT}: the scan of cluster {cluster} is garbled; run mpap learn again"
        raise ModelError(msg)
    return ScanExemplar(angles, ranges, read_array(archive, f"{name}/photo").tobytes())
