"""One run at a time writes into a results folder."""

import fcntl
import os
import socket
from contextlib import suppress
from pathlib import Path

from mpap_cli.errors import OutputError


class FolderLock:
    """Lock file that names the process which holds it.

    The operating system holds the lock (flock), so that the lock of a dead process is
    free again, whatever became of its number; the text only tells a person who has it.

    Parameters
    ----------
    path : Path
        The lock file; made when the lock is taken, removed when it is given back.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._descriptor = -1

    def acquire(self) -> None:
        """Take the lock or say who has it.

        Raises
        ------
        OutputError
            If another run holds the lock.
        OSError
            If the lock file cannot be made.
        """
        while True:
            # a link put in its place must not lead elsewhere
            flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW
            descriptor = os.open(self._path, flags, 0o644)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as err:
                holder = os.read(descriptor, 300).decode("utf-8", "replace").strip()
                os.close(descriptor)
                msg = (
                    f"{self._path.parent}: another run of mpap writes there "
                    f"({holder or 'just started'}); wait for it or choose another --out"
                )
                raise OutputError(msg) from err
            except OSError:
                os.close(descriptor)
                raise
            if self._is_current(descriptor):
                break
            # the run before removed this file between our opening and our locking it
            os.close(descriptor)
        os.ftruncate(descriptor, 0)
        os.write(descriptor, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        self._descriptor = descriptor

    def _is_current(self, descriptor: int) -> bool:
        """Tell whether the locked file is still the one that bears the name."""
        try:
            named = self._path.stat()
        except FileNotFoundError:
            return False
        return os.path.samestat(named, os.fstat(descriptor))

    def release(self) -> None:
        """Remove the lock file, then give the lock back."""
        if self._descriptor < 0:
            return
        with suppress(OSError):  # an unlocked file that stays behind locks nobody out
            self._path.unlink()
        os.close(self._descriptor)
        self._descriptor = -1
