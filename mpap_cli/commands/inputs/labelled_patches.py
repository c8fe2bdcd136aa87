"""Image patches whose classes are known: a folder per class, or arrays in a file (5.1.1)."""

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.patch_archive import read_patch_archive
from mpap_cli.errors import LogError, UsageError
from mpap_cli.evaluation.clusterers.records import LabelledPoints
from mpap_cli.features.images.image_decode import COMPRESSED, Image, decode_frame
from mpap_cli.features.images.single_patches import LEAST_SIDE, cut_at_own_size, embed_patches
from mpap_cli.observations import Frame, IntArray
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.params import ImageParams

LOGGER = logging.getLogger(__name__)

IMAGE_ENDINGS = frozenset({".jpg", ".jpeg", ".png", ".webp", ".bmp"})
MOST_PATCHES = 500_000
UNREADABLE = "cannot be read"
TINY = f"lower or narrower than {LEAST_SIDE} pixels"

_MOST_FILE_BYTES = 1 << 28

Draw = Callable[[Iterable[int]], dict[int, Image]]
"""Gives pictures of patches by row, BGR; without those that cannot be read any more."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LabelledPatches:
    """Embedded patches with their classes, and where their pictures are.

    ``left_out`` counts images that could not be used, by reason.
    """

    points: LabelledPoints
    class_names: tuple[str, ...]
    draw: Draw
    left_out: Counter[str]
    inputs: tuple[InputFile, ...]

    def warn_of_losses(self) -> int:
        """Say which images were left out; return the exit code that this means."""
        for reason, n_images in sorted(self.left_out.items()):
            LOGGER.warning("%d image%s left out: %s", n_images, "s" * (n_images > 1), reason)
        return 3 if self.left_out else 0


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Images:
    """Labelled images: class, name and pixels (None: unreadable), and each once more."""

    class_names: tuple[str, ...]
    every: Callable[[], Iterator[tuple[int, str, Image | None]]]
    again: Callable[[str], Image | None]
    inputs: tuple[InputFile, ...]


def read_labelled_patches(
    path: Path, params: ImageParams, per_class: int | None = None, seed: int = 0
) -> LabelledPatches:
    """Read labelled images, cut them into patches and describe these.

    Parameters
    ----------
    path : Path
        A folder with a folder of images for each class (folders in these count too), or an
        npz file with ``patches`` (n, h, w, 3), RGB, uint8, ``labels`` (n,) and
        ``class_names``.
    params : ImageParams
        How a patch is described.
    per_class : int, optional
        Most patches of a class; which ones is drawn at random. None: all.
    seed : int
        Of the draw.

    Returns
    -------
    LabelledPatches
        In the order of classes and names. Images are cut as by
        :func:`~mpap_cli.features.images.single_patches.cut_at_own_size`.

    Raises
    ------
    LogError
        If there is nothing that can be read, or the file is not such an npz.
    UsageError
        If there are more patches than can be held.
    """
    images = _from_folder(path) if path.is_dir() else _from_archive(path)
    left_out: Counter[str] = Counter()
    features, classes, places = [], list[int](), list[tuple[str, int]]()
    for label, name, image in images.every():
        if image is None or min(image.shape[:2]) < LEAST_SIDE:
            left_out[UNREADABLE if image is None else TINY] += 1
            continue
        found = embed_patches(cut_at_own_size(image), params)
        features.append(found)
        classes += [label] * len(found)
        places += [(name, number) for number in range(len(found))]
        if len(classes) > MOST_PATCHES:
            msg = f"{path}: more than {MOST_PATCHES:,} patches; give fewer or smaller images"
            raise UsageError(msg)
    if not classes:
        reasons = ", ".join(sorted(left_out)) or "there is none"
        msg = f"{path}: no image can be used ({reasons}); give larger or other images"
        raise LogError(msg)
    labels = np.array(classes, np.int64)
    kept = _drawn(labels, per_class, seed)

    return LabelledPatches(
        points=LabelledPoints(features=np.concatenate(features)[kept], classes=labels[kept]),
        class_names=images.class_names,
        draw=partial(_pictures, images, [places[row] for row in kept]),
        left_out=left_out,
        inputs=images.inputs,
    )


def _pictures(
    images: _Images, places: Sequence[tuple[str, int]], rows: Iterable[int]
) -> dict[int, Image]:
    """Cut patches out of their images once more, each of which is read once."""
    of_image: dict[str, list[int]] = {}
    for row in sorted(set(rows)):
        of_image.setdefault(places[row][0], []).append(row)
    found: dict[int, Image] = {}
    for name, wanted in of_image.items():
        image = images.again(name)
        patches = [] if image is None else list(cut_at_own_size(image))
        found |= {row: patches[places[row][1]] for row in wanted if places[row][1] < len(patches)}
    return found


def _drawn(labels: IntArray, per_class: int | None, seed: int) -> IntArray:
    """Return the rows to keep, ascending."""
    if per_class is None:
        return np.arange(len(labels))
    rng = np.random.default_rng(seed)
    parts = [
        rng.permutation(np.flatnonzero(labels == one))[:per_class] for one in np.unique(labels)
    ]
    return np.sort(np.concatenate(parts))


def _from_folder(folder: Path) -> _Images:
    """Find the images of a folder per class."""
    classes = {
        one.name: _image_files(one)
        for one in sorted(folder.iterdir())
        if one.is_dir() and not one.name.startswith(".")
    }
    names = tuple(name for name, files in classes.items() if files)
    if not names:
        msg = f"{folder}: found no folder with images; make one for each class, named like it"
        raise LogError(msg)

    def every() -> Iterator[tuple[int, str, Image | None]]:
        for label, name in enumerate(names):
            for file in classes[name]:
                yield label, str(file), _decode(file)
            LOGGER.info("%s: %d images read", name, len(classes[name]))

    return _Images(
        class_names=names,
        every=every,
        again=lambda name: _decode(Path(name)),
        inputs=tuple(describe_input(file) for name in names for file in classes[name]),
    )


def _image_files(folder: Path) -> list[Path]:
    """Return the images in a folder and in the folders within, by name."""
    return sorted(
        file
        for file in folder.rglob("*")
        if file.suffix.lower() in IMAGE_ENDINGS and not file.name.startswith(".") and file.is_file()
    )


def _decode(file: Path) -> Image | None:
    """Decode an image file, None if that fails or it is too large to be one."""
    try:
        if file.stat().st_size > _MOST_FILE_BYTES:
            return None
        payload = file.read_bytes()
    except OSError:
        return None
    return decode_frame(Frame(0, COMPRESSED, 0, 0, 0, payload))


def _from_archive(path: Path) -> _Images:
    """Read the images of an npz file."""
    archive = read_patch_archive(path)

    def image_of(number: int) -> Image:
        return np.ascontiguousarray(archive.patches[number][..., ::-1])

    return _Images(
        class_names=archive.class_names,
        every=lambda: (
            (int(label), str(number), image_of(number))
            for number, label in enumerate(archive.labels)
        ),
        again=lambda name: image_of(int(name)),
        inputs=(describe_input(path),),
    )
