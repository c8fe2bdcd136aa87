"""The model file: numbers and a header, checked before they are believed."""

import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from mpap_cli.errors import ModelError
from mpap_cli.logs.remote.urls import base_name, is_url
from mpap_cli.outputs.array_members import (
    open_members,
    read_array,
    read_record,
    write_array,
    write_record,
)

MODEL_NAME = "model.npz"
FORMAT = "mpap model"
VERSION = 1
_HEADER = "header"


def write_model(path: Path, header: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> None:
    """Write a model; the same model gives the same bytes.

    Parameters
    ----------
    path : Path
        File to write, by custom ``model.npz``; ``numpy.load`` opens it.
    header : dict
        What JSON can hold: settings, logs, counts.
    arrays : dict
        Numeric arrays by name; the name ``header`` is taken.

    Raises
    ------
    OSError
        If the file cannot be written.
    ValueError
        If an array holds anything but numbers, or bears the name ``header``.
    """
    if _HEADER in arrays:
        msg = f"an array of a model cannot be named {_HEADER}"
        raise ValueError(msg)
    names = sorted(arrays)
    record = {"format": FORMAT, "version": VERSION, "header": header, "arrays": names}
    with zipfile.ZipFile(path, "w") as archive:
        write_record(archive, _HEADER, record)
        for name in names:
            write_array(archive, name, arrays[name])


def read_model(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Read a model that :func:`write_model` wrote.

    Parameters
    ----------
    path : Path
        A model file.

    Returns
    -------
    tuple of dict and dict
        Header and arrays. What they mean is checked by who builds the model.

    Raises
    ------
    ModelError
        If the file is missing, no model, of another version, cut off, garbled, or
        declares more than it holds.
    """
    with open_members(path, "model") as archive:
        record = read_record(archive, _HEADER)
        check_format(path, record, FORMAT, VERSION)
        header, names = record["header"], record["arrays"]
        if not isinstance(header, dict):
            msg = "header is no record"
            raise ValueError(msg)  # noqa: TRY004  # the file is wrong, not the caller
        _check_members(path, archive, names)
        return header, {name: read_array(archive, name) for name in names}


def _check_members(path: Path, archive: zipfile.ZipFile, names: Any) -> None:
    """Check that the arrays together hold no more than the file: members could share bytes."""
    listed = isinstance(names, list) and all(isinstance(name, str) for name in names)
    if not listed or len(set(names)) != len(names):
        msg = "its arrays have no names, or one is there twice"
        raise ValueError(msg)
    declared = sum(archive.getinfo(f"{name}.npy").file_size for name in names)
    size = path.stat().st_size
    if declared > size:
        msg = f"its arrays declare {declared} bytes in a file of {size}"
        raise ValueError(msg)


def check_format(path: Path, record: dict[str, Any], name: str, version: int) -> None:
    """Check format and version of a file's header.

    Raises
    ------
    ModelError
        If the file is of another format or version.
    """
    if record.get("format") != name:
        msg = f"{path.name}: not an {name} file; choose one that mpap learn wrote"
        raise ModelError(msg)
    found = record.get("version")
    if found != version:
        msg = (
            f"{path.name}: format version {found!r}, this mpap reads version {version}; "
            "learn again, or use the mpap that wrote it"
        )
        raise ModelError(msg)


def find_model(path: Path) -> Path:
    """Return the model file that is meant: the file itself, or the one of an OUT folder.

    Parameters
    ----------
    path : Path
        A model file or a folder of results.

    Returns
    -------
    Path
        The file, or ``learn/model.npz`` of the folder, else its ``merge/model.npz``.

    Raises
    ------
    ModelError
        If there is neither, or it is a URL.
    """
    url = str(path).replace(":/", "://", 1)
    if is_url(url) and not path.exists():
        msg = f"{base_name(url)}: models are read from this machine only; fetch it first"
        raise ModelError(msg)
    if not path.is_dir():
        return path
    found = next(_models_in(path), None)
    if found is not None:
        return found
    msg = f"{path}: no learn/model.npz and no merge/model.npz in it; run mpap learn first"
    raise ModelError(msg)


def has_model(folder: Path) -> bool:
    """Tell whether :func:`find_model` finds one in a folder of results."""
    return next(_models_in(folder), None) is not None


def _models_in(folder: Path) -> Iterator[Path]:
    """Yield the models in a folder of results, the one to be taken first."""
    for command in ("learn", "merge"):
        path = folder / command / MODEL_NAME
        if path.is_file():
            yield path
