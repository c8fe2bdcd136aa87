"""settings.json: what a run was, what it read, and the SHA-256 of all it wrote."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path, PurePosixPath
from typing import Annotated, Any

from mpap_cli.errors import OutputError, require_finite

SETTINGS_NAME = "settings.json"
_LARGEST_SETTINGS = 64 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class InputFile:
    """What was read, known again wherever it lies: base name, bytes and SHA-256."""

    name: Annotated[str, "base name"]
    size: Annotated[int, "bytes"]
    sha256: Annotated[str, "checksum; of a log behind a URL perhaps what the server says instead"]


@dataclass(frozen=True, slots=True)
class Results:
    """A whole set of results, each output checked against its SHA-256."""

    folder: Path
    mpap: Annotated[str, "version that wrote it"]
    command: Annotated[str, "command that wrote it"]
    seed: Annotated[int, "seed of everything random"]
    settings: Annotated[Mapping[str, Any], "every setting and option that can change results"]
    inputs: Annotated[tuple[InputFile, ...], "what was read, in the order given"]
    warnings: Annotated[tuple[str, ...], "what was said on stderr"]
    outputs: Annotated[Mapping[str, str], "SHA-256 of each file beside it, by name"]

    def path(self, name: str) -> Path:
        """Return the path of an output.

        Raises
        ------
        OutputError
            If the run did not write it.
        """
        if name not in self.outputs:
            msg = f"{self.folder}: there is no {name}; run mpap {self.command} so that it writes it"
            raise OutputError(msg)
        return self.folder / name


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal."""
    require_finite(path)
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def is_safe_name(name: str) -> bool:
    """Tell whether a name stays inside its folder.

    >>> is_safe_name("images/1.png"), is_safe_name("../1.png"), is_safe_name("/1.png")
    (True, False, False)
    """
    path = PurePosixPath(name)
    plain = name == str(path) and "\0" not in name and "\\" not in name
    return plain and bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def listed_outputs(folder: Path) -> set[str]:
    """Return the outputs that the settings of older results list; none if there are none."""
    try:
        return set(read_record(folder).outputs)
    except OutputError:
        return set()


def read_record(folder: Path) -> Results:
    """Read and check settings.json alone.

    Raises
    ------
    OutputError
        If there is none, or it is not one that a run wrote.
    """
    path = folder / SETTINGS_NAME
    try:
        with path.open("rb") as stream:
            text = stream.read(_LARGEST_SETTINGS)
    except FileNotFoundError as err:
        there = folder.is_dir() and any(folder.iterdir())
        what = "no settings.json, an unfinished run" if there else "there are no results"
        msg = f"{folder}: {what}; run mpap {folder.name} again"
        raise OutputError(msg) from err
    except OSError as err:
        msg = f"{path}: cannot be read ({(err.strerror or str(err)).lower()}); check the folder"
        raise OutputError(msg) from err
    try:
        return _results(folder, json.loads(text))
    except (ValueError, TypeError, KeyError, RecursionError) as err:
        msg = f"{path}: not the settings of a run; run mpap {folder.name} again"
        raise OutputError(msg) from err


def _results(folder: Path, record: Any) -> Results:
    """Build the record, checking every part that is used as a name or number."""
    names = [item.name for item in fields(InputFile)]
    inputs = tuple(InputFile(**{name: item[name] for name in names}) for item in record["inputs"])
    outputs, settings = record["outputs"], record["settings"]
    warnings = tuple(record.get("warnings", ()))  # older results have none
    texts = (record["mpap"], record["command"], *warnings, *outputs, *outputs.values())
    good = (
        isinstance(settings, dict)
        and isinstance(record["seed"], int)
        and all(isinstance(text, str) for text in texts)
        and all(is_safe_name(name) for name in outputs)
    )
    if not good:
        raise ValueError(folder)
    return Results(
        folder=folder,
        mpap=record["mpap"],
        command=record["command"],
        seed=record["seed"],
        settings=settings,
        inputs=inputs,
        warnings=warnings,
        outputs=outputs,
    )
