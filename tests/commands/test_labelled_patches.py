"""Labelled images are read, cut and described; what cannot be used is counted or refused."""

import io
import shutil
import zipfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from mpap_cli.commands.inputs import labelled_patches as module
from mpap_cli.commands.inputs.labelled_patches import TINY, UNREADABLE, read_labelled_patches
from mpap_cli.commands.inputs.patch_archive import read_patch_archive
from mpap_cli.errors import LogError, UsageError
from mpap_cli.params import ImageParams
from tests.commands.patch_sets import CLASSES, arrays, images, write_folder, write_npz

PARAMS = ImageParams()


def test_a_folder_and_an_archive_of_the_same_patches_are_alike(tmp_path: Path) -> None:
    """Features, classes and names do not depend on how the patches are kept."""
    archive = write_npz(tmp_path / "patches.npz")
    for label, name in enumerate(CLASSES):
        (tmp_path / "set" / name).mkdir(parents=True)
        for number, image in enumerate(images(label, 30)):
            cv2.imwrite(str(tmp_path / "set" / name / f"{number:02}.png"), image[..., ::-1])

    of_folder = read_labelled_patches(tmp_path / "set", PARAMS)
    of_archive = read_labelled_patches(archive, PARAMS)

    np.testing.assert_array_equal(of_folder.points.features, of_archive.points.features)
    np.testing.assert_array_equal(of_folder.points.classes, of_archive.points.classes)
    assert of_folder.class_names == of_archive.class_names == CLASSES
    assert of_folder.points.n_classes == 3


def test_large_images_are_cut_at_their_own_size(tmp_path: Path) -> None:
    """260 x 200 pixels hold 25 patches; a picture can be asked for by row."""
    folder = write_folder(tmp_path / "set")
    first = cv2.imread(str(folder / CLASSES[0] / "0.png"))
    assert first is not None

    patches = read_labelled_patches(folder, PARAMS)
    pictures = patches.draw([0, 26, 149])

    assert patches.points.features.shape == (150, 109)
    assert np.bincount(patches.points.classes).tolist() == [50, 50, 50]
    np.testing.assert_array_equal(pictures[0], first[:40, :52])
    assert set(pictures) == {0, 26, 149}


def test_images_that_cannot_be_used_are_counted(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Cut off and tiny images are left out with one line each; other files are no images."""
    folder = write_folder(tmp_path / "set")
    whole = folder / CLASSES[0] / "0.png"
    (folder / CLASSES[1] / "cut.png").write_bytes(whole.read_bytes()[:500])
    cv2.imwrite(str(folder / CLASSES[1] / "tiny.png"), np.zeros((7, 60, 3), np.uint8))
    (folder / CLASSES[2] / "README.txt").write_text("no image")

    patches = read_labelled_patches(folder, PARAMS)
    code = patches.warn_of_losses()

    assert patches.left_out == {UNREADABLE: 1, TINY: 1}
    assert code == 3
    assert len(patches.points.classes) == 150
    warnings = [one.message for one in caplog.records if one.levelname == "WARNING"]
    assert warnings == [f"1 image left out: {UNREADABLE}", f"1 image left out: {TINY}"]


def test_a_picture_that_is_gone_is_left_out(tmp_path: Path) -> None:
    """An image that was removed since gives no picture."""
    folder = write_folder(tmp_path / "set")
    patches = read_labelled_patches(folder, PARAMS)
    (folder / CLASSES[0] / "0.png").unlink()

    pictures = patches.draw([0, 60])

    assert set(pictures) == {60}


def test_a_share_of_each_class_can_be_drawn(tmp_path: Path) -> None:
    """Ten of each class, the same for the same seed; pictures follow the draw."""
    archive = write_npz(tmp_path / "patches.npz")
    every = read_labelled_patches(archive, PARAMS)

    first = read_labelled_patches(archive, PARAMS, per_class=10, seed=4)
    again = read_labelled_patches(archive, PARAMS, per_class=10, seed=4)
    other = read_labelled_patches(archive, PARAMS, per_class=10, seed=5)

    assert np.bincount(first.points.classes).tolist() == [10, 10, 10]
    np.testing.assert_array_equal(first.points.features, again.points.features)
    assert not np.array_equal(first.points.features, other.points.features)
    drawn = (every.points.features == first.points.features[0]).all(axis=1)
    np.testing.assert_array_equal(
        first.draw([0])[0], every.draw([int(drawn.argmax())])[int(drawn.argmax())]
    )


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"patches": arrays()["patches"].astype(float)}, "patches: found float64"),
        ({"patches": arrays()["patches"][..., 0]}, r"patches: found uint8 of shape \(90, 40, 52\)"),
        ({"patches": arrays()["patches"][:0], "labels": np.zeros(0, int)}, "found none"),
        ({"labels": np.zeros(90)}, "labels: found float64"),
        ({"labels": np.zeros(89, int)}, r"labels: found int64 of shape \(89,\)"),
        ({"labels": np.arange(90) - 1}, "labels: 87 of 90 have no name; expected 0 to 2"),
        ({"labels": np.array([None] * 90)}, "labels holds objects"),
        ({"class_names": np.arange(3)}, "class_names: found int64"),
        ({"class_names": None}, "not an npz file with patches, labels and class_names"),
        ({"patches": np.zeros((4, 7, 90, 3), np.uint8), "labels": np.zeros(4, int)}, TINY),
    ],
)
def test_wrong_arrays_are_refused(tmp_path: Path, changes: dict[str, Any], match: str) -> None:
    """Types, shapes, labels without a name: what was found and what is expected."""
    path = write_npz(tmp_path / "patches.npz", **changes)

    with pytest.raises(LogError, match=match):
        read_labelled_patches(path, PARAMS)


def header(shape: tuple[int, ...]) -> bytes:
    """Return the header of an array of bytes."""
    stream = io.BytesIO()
    words = {"descr": "|u1", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(stream, words)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("shape", "match"),
    [
        ((10**6, 400, 520, 3), "declares 624,000,000,000 bytes, more than"),
        ((1000, 40, 52, 3), "declares 6,240,000 bytes and has 3"),
        ((-1, 40, 52, 3), "holds objects"),
    ],
)
def test_sizes_are_checked_before_memory_is_taken(
    tmp_path: Path, shape: tuple[int, ...], match: str
) -> None:
    """An array that declares more than there is, or than can be held, is refused."""
    path = tmp_path / "patches.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("patches.npy", header(shape) + b"abc")

    with pytest.raises(LogError, match=match):
        read_patch_archive(path)


@pytest.mark.parametrize("content", [b"", b"no zip at all", b"PK\x03\x04" + b"\0" * 40])
def test_what_is_no_archive_is_refused(tmp_path: Path, content: bytes) -> None:
    """Any other file: one line that says what is expected."""
    path = tmp_path / "patches.npz"
    path.write_bytes(content)

    with pytest.raises(LogError, match="not an npz file with patches"):
        read_labelled_patches(path, PARAMS)


def test_a_future_header_is_refused(tmp_path: Path) -> None:
    """Only the headers that are known are read."""
    path = tmp_path / "patches.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("patches.npy", b"\x93NUMPY\x03\x00" + header((1,))[8:] + b"a")

    with pytest.raises(LogError, match=r"header of version 3\.0"):
        read_patch_archive(path)


def test_paths_without_images_are_named(tmp_path: Path) -> None:
    """A missing path, a folder without classes, images that are not in a class."""
    flat = write_folder(tmp_path / "set") / CLASSES[0]
    (tmp_path / "empty" / "a").mkdir(parents=True)

    for path, match in (
        (tmp_path / "nowhere", "there is no such file or folder"),
        (tmp_path / "empty", "found no folder with images"),
        (flat, "found no folder with images"),
    ):
        with pytest.raises(LogError, match=match):
            read_labelled_patches(path, PARAMS)


def test_too_many_patches_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More than can be held: fewer images are asked for."""
    folder = write_folder(tmp_path / "set")
    monkeypatch.setattr(module, "MOST_PATCHES", 100)

    with pytest.raises(UsageError, match="more than 100 patches"):
        read_labelled_patches(folder, PARAMS)


def test_a_file_too_large_for_an_image_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its bytes are not read."""
    folder = write_folder(tmp_path / "set")
    shutil.copy(folder / CLASSES[0] / "0.png", folder / CLASSES[0] / "2.png")
    largest = max(file.stat().st_size for file in (folder / CLASSES[0]).iterdir())
    monkeypatch.setattr(module, "_MOST_FILE_BYTES", largest - 1)

    patches = read_labelled_patches(folder, PARAMS)

    assert patches.left_out[UNREADABLE] >= 1
