"""Remote files that cannot be read in place: copied once, for as long as the log is open."""

import errno
import hashlib
import logging
import time
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.raw import Reading
from mpap_cli.logs.remote.paths import RemotePath
from mpap_cli.logs.remote.stores import persistently

_LOG = logging.getLogger(__name__)

TELL_EVERY_S = 10.0
_WAITS_S = (0.5, 2.0)  # each attempt begins anew where there are no ranges


def copy_whole(path: RemotePath, reading: Reading, reason: str) -> Path:
    """Copy a remote file into the private folder of an open log, and say so.

    Parameters
    ----------
    path : RemotePath
        A file.
    reading : Reading
        Lends the folder, and removes it in the end.
    reason : str
        Why it is not read in place.

    Returns
    -------
    Path
        The copy, under the same base name.

    Raises
    ------
    LogError
        If it cannot be fetched to its end, or there is no room.
    """
    folder = reading.scratch() / "fetched"
    copy = folder / path.name
    if path.sha256 and copy.exists():
        return copy
    size = path.facts.size
    words = f"{size / 1e6:,.1f} MB" if size else "of unknown size"
    _LOG.info("%s: copied to a temporary folder first (%s): %s", path.name, words, reason)
    try:
        folder.mkdir(exist_ok=True)
        path.sha256 = persistently(lambda: _copy(path, copy), _WAITS_S)
    except OSError as err:
        room = err.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
        hint = "; name a folder with room in TMPDIR" if room else ""
        msg = f"{path.name}: cannot be copied ({err.strerror}){hint}"
        raise LogError(msg) from err
    return copy


def copy_beside(path: RemotePath, reading: Reading, endings: tuple[str, ...]) -> None:
    """Copy what lies beside a file that was copied, under its name with such an ending."""
    for ending in endings:
        beside = path.with_ending(ending)
        if beside.is_file() and beside.facts.size:
            copy_whole(beside, reading, f"it belongs to {path.name}")


def _copy(path: RemotePath, copy: Path) -> str:
    """Copy all, tell how far it is now and then, and return the SHA-256."""
    size, n_bytes, digest = path.facts.size, 0, hashlib.sha256()
    told_s = time.monotonic()
    with copy.open("wb") as target:
        for piece in path.pieces():
            n_bytes += target.write(piece)
            digest.update(piece)
            if size and n_bytes > size:
                break
            if time.monotonic() - told_s > TELL_EVERY_S:
                told_s = time.monotonic()
                share = f" ({n_bytes / size:.0%})" if size else ""
                _LOG.info("%s: %s MB copied%s", path.name, f"{n_bytes / 1e6:,.0f}", share)
    if size and n_bytes != size:
        raise OSError(errno.EIO, "the server does not give the bytes that it says it has")
    return digest.hexdigest()
