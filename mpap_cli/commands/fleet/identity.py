"""Which log it is: told by its content, or where that was seen before by what the disk says."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import LogPath
from mpap_cli.outputs.results_reader import InputFile, describe_input


@dataclass(frozen=True, slots=True)
class Sighting:
    """What is known of a log without reading it: where it lies, bytes, last change.

    Content that is read once is not read again as long as all three stay. ``changed`` is
    the time of the last change of the inode in nanoseconds, which no copying tool sets
    back; behind a URL it is what the store says changes with the content, such as the ETag.
    """

    path: str
    size: int
    changed: str


def sight(path: LogPath) -> Sighting:
    """Ask the disk or the store about a log.

    Raises
    ------
    LogError
        If it cannot be reached.
    """
    try:
        if isinstance(path, Path):
            return _on_disk(path.absolute())
        if not path.is_dir():
            return Sighting(str(path), path.facts.size, path.facts.mark)
        parts = sorted(path.iterdir())
        marks = (f"{part.name} {part.facts.size} {part.facts.mark}" for part in parts)
        size = sum(part.facts.size for part in parts)
        return Sighting(str(path), size, _digest(marks))
    except OSError as err:
        msg = f"{path.name}: cannot be read ({(err.strerror or str(err)).lower()})"
        raise LogError(msg) from err


def _on_disk(path: Path) -> Sighting:
    """Ask the disk about a file, or about a folder and the files in it."""
    whole = path.resolve()
    own = whole.stat()
    parts = [item.stat() for item in whole.iterdir() if item.is_file()] if whole.is_dir() else []
    size = sum(part.st_size for part in parts) if whole.is_dir() else own.st_size
    changed_ns = max(part.st_ctime_ns for part in (own, *parts))
    return Sighting(str(path), size, str(changed_ns))


def describe_log(path: LogPath) -> InputFile:
    """Say what a log is by its content.

    Behind a URL, where that would be to fetch it all, size and mark of the store must do.

    Raises
    ------
    LogError
        If it cannot be read.
    """
    if isinstance(path, Path):
        return describe_input(path)
    seen = sight(path)
    return InputFile(path.name, seen.size, f"not read whole; {seen.changed}")


def definitions_digest(folders: Iterable[Path]) -> str:
    """Return one digest of the message definitions that folders hold; empty without any.

    Raises
    ------
    LogError
        If one cannot be read.
    """
    files = [file for folder in folders for file in sorted(folder.rglob("*.[mi][sd][gl]"))]
    return _digest(describe_input(file).sha256 for file in files) if files else ""


def _digest(lines: Iterable[str]) -> str:
    return hashlib.sha256("\n".join(lines).encode("utf-8", "surrogateescape")).hexdigest()
