"""Putting finished results in place, so that a kill at any moment can be mended.

A staging folder whose settings.json is there and fits is committed: whatever part of it
has been renamed already, the rest can follow at any time. Any other is a leftover.
"""

import errno
import os
import shutil
from contextlib import suppress
from pathlib import Path, PurePosixPath

from mpap_cli.errors import OutputError
from mpap_cli.outputs.folder_lock import FolderLock
from mpap_cli.outputs.results_record import (
    SETTINGS_NAME,
    listed_outputs,
    read_record,
    sha256_of,
)


def staging_of(folder: Path) -> Path:
    """Return the hidden folder beside a results folder in which a run writes."""
    return folder.parent / f".{folder.name}.unfinished"


def lock_of(folder: Path) -> FolderLock:
    """Return the lock of a results folder."""
    return FolderLock(folder.parent / f".{folder.name}.lock")


def flush(path: Path) -> None:
    """Bring a file or folder to the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def publish(folder: Path) -> None:
    """Rename the staged files into place, settings last; a broken call can be repeated.

    Outputs that only the older results list are removed.

    Raises
    ------
    OSError
        If a file cannot be renamed or removed.
    """
    staging = staging_of(folder)
    if not (staging / SETTINGS_NAME).exists():
        return
    names = listed_outputs(staging)
    obsolete = listed_outputs(folder) - names
    folder.mkdir(exist_ok=True)
    blocked = next((folder / name for name in sorted(names) if (folder / name).is_dir()), None)
    if blocked is not None:
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(blocked))
    for name in sorted(names):
        _move(staging, folder, name)
    for name in sorted(obsolete):
        _remove(folder, name)
    _move(staging, folder, SETTINGS_NAME)
    flush(folder)
    flush(folder.parent)


def _move(staging: Path, folder: Path, name: str) -> None:
    """Rename one file into place, if that is not done yet."""
    if (staging / name).exists():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (staging / name).replace(folder / name)


def _remove(folder: Path, name: str) -> None:
    """Remove a file of the older results, and the folders that it leaves empty."""
    (folder / name).unlink(missing_ok=True)
    for parent in PurePosixPath(name).parents[:-1]:
        with suppress(OSError):  # not empty, or gone already
            (folder / parent).rmdir()


def clear_staging(folder: Path) -> None:
    """Finish what a killed run committed and remove what it left; the lock must be held.

    Raises
    ------
    OSError
        If the folder cannot be written.
    """
    staging = staging_of(folder)
    if _is_committed(folder):
        publish(folder)
    if staging.exists():
        shutil.rmtree(staging)


def recover(folder: Path) -> None:
    """Finish a commit that was killed; leave alone what another run is writing.

    Where the folder cannot be written nothing happens: the reader then names the set.
    """
    if not (staging_of(folder) / SETTINGS_NAME).exists():
        return
    lock = lock_of(folder)
    with suppress(OSError, OutputError):
        lock.acquire()
        clear_staging(folder)
    lock.release()


def _is_committed(folder: Path) -> bool:
    """Tell whether the staged settings fit what is staged or renamed already."""
    staging = staging_of(folder)
    try:
        outputs = read_record(staging).outputs
    except OutputError:
        return False
    return all(
        digest in {_digest(staging / name), _digest(folder / name)}
        for name, digest in outputs.items()
    )


def _digest(path: Path) -> str:
    """Return the SHA-256 of a file, nothing if it cannot be read."""
    try:
        return sha256_of(path)
    except OSError:
        return ""
