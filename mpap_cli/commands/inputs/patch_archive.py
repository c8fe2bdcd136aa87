"""Labelled patches as arrays in an npz file, which is not trusted."""

import math
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.errors import LogError, require_finite
from mpap_cli.features.images.image_decode import Image
from mpap_cli.observations import IntArray

MOST_BYTES = 1 << 31

_GARBLED = (
    zipfile.BadZipFile,
    zipfile.LargeZipFile,
    RuntimeError,  # encrypted, or packed in a way that is not known
    EOFError,
    ValueError,
    KeyError,
    TypeError,
    SyntaxError,
    OverflowError,
    UnicodeError,
)
_HEADERS: dict[tuple[int, int], Callable[[IO[bytes]], tuple[Any, bool, np.dtype[Any]]]] = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


@dataclass(frozen=True, slots=True, eq=False)
class PatchArchive:
    """Images (n, h, w, 3), RGB, uint8, their labels (n,), and the names of the classes."""

    patches: Image
    labels: IntArray
    class_names: tuple[str, ...]


def read_patch_archive(path: Path) -> PatchArchive:
    """Read the arrays ``patches``, ``labels`` and ``class_names`` of an npz file.

    Nothing is unpickled, and sizes are checked before memory is taken.

    Parameters
    ----------
    path : Path
        As ``numpy.savez`` or ``numpy.savez_compressed`` writes it.

    Returns
    -------
    PatchArchive
        One image at least.

    Raises
    ------
    LogError
        If the file is missing or garbled, an array is missing or of another type or shape,
        larger than 2 GiB, or a label has no name.
    """
    try:
        require_finite(path)
        with zipfile.ZipFile(path) as archive:
            patches = _read(archive, "patches")
            labels = _read(archive, "labels")
            names = _read(archive, "class_names")
    except FileNotFoundError as err:
        msg = f"{path}: there is no such file or folder; give a folder per class, or an npz file"
        raise LogError(msg) from err
    except OSError as err:
        msg = f"{path}: cannot be read ({(err.strerror or str(err)).lower()}); check the path"
        raise LogError(msg) from err
    except _GARBLED as err:
        words = " ".join(str(err.args[0] if err.args else err).split())[:120] or "garbled"
        msg = (
            f"{path.name}: not an npz file with patches, labels and class_names ({words}); "
            "write them with numpy.savez, or give a folder per class"
        )
        raise LogError(msg) from err
    complaint = _complaint(patches, labels, names)
    if complaint:
        msg = f"{path.name}: {complaint}"
        raise LogError(msg)
    return PatchArchive(
        patches=patches,
        labels=labels.astype(np.int64),
        class_names=tuple(
            name.decode("utf-8", "replace") if isinstance(name, bytes) else str(name)
            for name in names.tolist()
        ),
    )


def _read(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """Read one array; ValueError or KeyError if it cannot be."""
    member = archive.getinfo(f"{name}.npy")
    with archive.open(member) as stream:
        version = np.lib.format.read_magic(stream)
        if version not in _HEADERS:
            msg = f"{name} has a header of version {version[0]}.{version[1]}"
            raise ValueError(msg)
        shape, _, dtype = _HEADERS[version](stream)
        declared = math.prod(shape) * dtype.itemsize
        if dtype.hasobject or min(shape, default=0) < 0:
            msg = f"{name} holds objects"
            raise ValueError(msg)
        if declared > MOST_BYTES:
            msg = f"{name} declares {declared:,} bytes, more than {MOST_BYTES:,}"
            raise ValueError(msg)
        if declared != member.file_size - stream.tell():
            msg = f"{name} declares {declared:,} bytes and has {member.file_size - stream.tell():,}"
            raise ValueError(msg)
    with archive.open(member) as stream:
        return np.asarray(np.lib.format.read_array(stream, allow_pickle=False))


def _complaint(patches: NDArray[Any], labels: NDArray[Any], names: NDArray[Any]) -> str:
    """Return what is wrong with the arrays, empty if nothing is."""
    color = 3
    if patches.dtype != np.uint8 or patches.ndim != 4 or patches.shape[3] != color:  # noqa: PLR2004
        return f"patches: found {_kind(patches)}, expected uint8 of shape (n, h, w, 3), RGB"
    if labels.dtype.kind not in "iu" or labels.shape != patches.shape[:1]:
        return f"labels: found {_kind(labels)}, expected whole numbers of shape ({len(patches)},)"
    if names.dtype.kind not in "US" or names.ndim != 1:
        return f"class_names: found {_kind(names)}, expected one text a class"
    if not len(patches):
        return "patches: found none; give some images"
    wrong = int(np.count_nonzero((labels < 0) | (labels >= len(names))))
    if wrong:
        return f"labels: {wrong} of {len(labels)} have no name; expected 0 to {len(names) - 1}"
    return ""


def _kind(array: NDArray[Any]) -> str:
    """Return type and shape of an array in words."""
    return f"{array.dtype} of shape {array.shape}"
