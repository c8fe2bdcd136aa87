"""Errors that a user can mend: one line each, with the exit code they lead to."""

import errno
import stat
from pathlib import Path
from typing import ClassVar


class MpapError(Exception):
    """Base of all errors that mpap explains in one line.

    The text names the file or option, what was found and what to do next.
    Everything else that is raised is a bug and shows its traceback.
    """

    exit_code: ClassVar[int] = 1


class LogError(MpapError):
    """A log is missing, empty, unreadable or holds no message."""


class ModelError(MpapError):
    """A model or recording file cannot be used."""


class OutputError(MpapError):
    """The results folder cannot be written or read."""


class UsageError(MpapError):
    """What was asked for does not fit the input: topic, option, order of commands."""

    exit_code: ClassVar[int] = 2


class SettingError(UsageError):
    """A setting has a name or value that does not exist."""


def require_finite(path: Path) -> None:
    """Require that what is to be read comes to an end: a file or folder, no pipe, no device.

    Raises
    ------
    OSError
        If it is a pipe, a device or a socket, or is not there.

    Examples
    --------
    >>> require_finite(Path("/dev/null"))
    Traceback (most recent call last):
    OSError: [Errno 22] a pipe, device or socket, no file: '/dev/null'
    """
    mode = path.stat().st_mode
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise OSError(errno.EINVAL, "a pipe, device or socket, no file", str(path))
