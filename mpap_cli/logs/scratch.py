"""Folders for what is thrown away: gone with the run, or with a later one if it was killed."""

import fcntl
import os
import shutil
import socket
import stat
import tempfile
import weakref
from contextlib import suppress
from pathlib import Path

_MARK = ".mpap-in-use"


class ScratchFolder:
    """A new private folder, which goes when it is removed, forgotten, or the process ends.

    Parameters
    ----------
    prefix : str
        What its name begins with.
    parent : Path, optional
        Where it is made; without it where temporary files are.

    Raises
    ------
    OSError
        If it cannot be made.

    Notes
    -----
    A file in it tells the machine, and is locked by the operating system (flock) as long as
    the process lives. So what a killed run of the same user on the same machine has left is
    told from what is in use: it is removed when the next folder of that prefix is made
    there. Where files cannot be locked nothing is ever removed.

    Examples
    --------
    >>> folder = ScratchFolder("mpap-example-")
    >>> (folder.path / "a.txt").write_text("a")
    1
    >>> folder.remove()
    >>> folder.path.exists()
    False
    """

    def __init__(self, prefix: str, parent: Path | None = None) -> None:
        place = Path(tempfile.gettempdir()) if parent is None else parent
        with suppress(OSError):
            _remove_leftovers(place, prefix)
        self.path = Path(tempfile.mkdtemp(prefix=prefix, dir=place))
        try:
            mark = _mark(self.path)
        except BaseException:
            shutil.rmtree(self.path, ignore_errors=True)
            raise
        self._end = weakref.finalize(self, _remove, self.path, mark, os.getpid())

    def remove(self) -> None:
        """Remove the folder and all in it; a second call does nothing."""
        self._end()


def _remove(path: Path, mark: int, process: int) -> None:
    """Remove a folder, if this process made it and is no copy of the one that did."""
    if os.getpid() == process:
        shutil.rmtree(path, ignore_errors=True)
    os.close(mark)


def _mark(folder: Path) -> int:
    """Lock a file in the folder and write the machine into it; return its descriptor."""
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
    descriptor = os.open(folder / _MARK, flags, 0o600)
    try:
        with suppress(OSError):  # not everywhere are there locks; then the file stays empty
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            os.write(descriptor, _machine())
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def _machine() -> bytes:
    return f"{socket.gethostname()}\n".encode()


def _remove_leftovers(place: Path, prefix: str) -> None:
    """Remove the folders of dead processes."""
    for path in place.glob(f"{prefix}*"):
        with suppress(OSError):  # no folder of ours, or in use
            if _is_left_over(path):
                shutil.rmtree(path, ignore_errors=True)


def _is_left_over(folder: Path) -> bool:
    """Whether a process of this user on this machine made the folder and is dead."""
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
        return False
    flags = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK  # a pipe keeps none waiting
    descriptor = os.open(folder / _MARK, flags)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return os.read(descriptor, 300) == _machine()
    finally:
        os.close(descriptor)
