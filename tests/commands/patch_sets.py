"""Small sets of labelled image patches, as folders and as arrays."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

CLASSES = ("gravel", "lawn", "tiles")
_COLORS = ((90, 90, 100), (40, 150, 60), (180, 120, 60))


def images(label: int, n_images: int, height: int = 40, width: int = 52) -> NDArray[np.uint8]:
    """Return RGB images of a surface: a color, and noise as coarse as the number says."""
    rng = np.random.default_rng(label)
    made = []
    for _ in range(n_images):
        white = rng.normal(0, 25, (height, width)).astype(np.float32)
        noise = np.asarray(cv2.GaussianBlur(white, (0, 0), 0.5 + label))[..., None]
        light = rng.uniform(0.9, 1.1)
        made.append(np.clip(light * np.array(_COLORS[label]) + noise, 0, 255))
    return np.asarray(made, np.uint8)


def arrays(n_each: int = 30, n_classes: int = 3) -> dict[str, NDArray[Any]]:
    """Return the arrays of an npz file."""
    return {
        "patches": np.concatenate([images(label, n_each) for label in range(n_classes)]),
        "labels": np.repeat(np.arange(n_classes), n_each),
        "class_names": np.array(CLASSES[:n_classes]),
    }


def write_npz(path: Path, **changes: Any) -> Path:
    """Write a set of patches; an array that is None is left out."""
    kept = {name: array for name, array in {**arrays(), **changes}.items() if array is not None}
    np.savez_compressed(path, **kept)
    return path


def write_folder(folder: Path, n_images: int = 2, height: int = 200, width: int = 260) -> Path:
    """Write a folder of images for each class."""
    for label, name in enumerate(CLASSES):
        (folder / name).mkdir(parents=True)
        for number, image in enumerate(images(label, n_images, height, width)):
            cv2.imwrite(str(folder / name / f"{number}.png"), image[..., ::-1])
    return folder
