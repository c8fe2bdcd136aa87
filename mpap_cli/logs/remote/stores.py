"""What holds remote files: facts about one of them, and its bytes by ranges."""

import errno
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, Protocol, TypeVar

from mpap_cli.errors import LogError
from mpap_cli.logs.remote.urls import scheme_of, shown

REMOTE_EXTRA = 'pip install "mpap[remote]"'
WAITS_S = (0.5, 1.0, 2.0, 4.0)
"""Before each further attempt, once something has been read."""

FIRST_WAITS_S = (0.5,)
CONNECT_S, ANSWER_S = 10.0, 30.0

_IN_EXTRA = frozenset({"http", "https", "s3", "s3a"})
_OPTIONS: dict[str, dict[str, Any]] = {
    "s3": {"config_kwargs": {"connect_timeout": CONNECT_S, "read_timeout": ANSWER_S}},
}

Answer = TypeVar("Answer")


class BrokenConnectionError(OSError):
    """Something that may go better the next time."""


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of a remote file or folder.

    ``size`` is in bytes; ``mark`` changes with the content (an ETag), empty where there is
    none; without ``has_ranges`` the file can only be read from its beginning to its end, and
    a size of 0 may mean that it is not known; ``head`` is how the file begins, as far as it
    was fetched.
    """

    size: int
    mark: str = ""
    is_folder: bool = False
    has_ranges: bool = True
    head: bytes = b""


@dataclass(slots=True)
class Traffic:
    """What was fetched of one log."""

    n_requests: int = 0
    n_bytes: int = 0

    def add(self, block: bytes) -> None:
        """Count one request."""
        self.n_requests += 1
        self.n_bytes += len(block)


class Store(Protocol):
    """What holds one file or folder; every error is an ``OSError`` without secrets in it."""

    def facts(self) -> Facts:
        """Ask what it is."""
        ...

    def fetch(self, begin: int, end: int) -> bytes:
        """Return exactly the bytes begin <= b < end."""
        ...

    def whole(self) -> Iterator[bytes]:
        """Yield all bytes of one answer in order."""
        ...

    def listing(self, pattern: str = "") -> list[str]:
        """Return the URLs of what lies in the folder, or matches the pattern; sorted."""
        ...


def persistently(ask: Callable[[], Answer], waits_s: tuple[float, ...]) -> Answer:
    """Ask again, after a while, where a connection breaks.

    Raises
    ------
    OSError
        If it breaks each time.
    """
    for wait_s in waits_s:
        try:
            return ask()
        except BrokenConnectionError:
            time.sleep(wait_s)
    try:
        return ask()
    except BrokenConnectionError as err:
        msg = f"{err.strerror}, {len(waits_s) + 1} attempts"
        raise OSError(errno.EIO, msg) from err


def filesystem(url: str, **options: Any) -> tuple[Any, str]:
    """Return the file system that holds a URL, and the path in it.

    Raises
    ------
    LogError
        If a package is missing, or the protocol is unknown.
    """
    scheme = scheme_of(url)
    require_extra(url, "upath")
    from upath import UPath  # noqa: PLC0415  # local logs do not need it

    try:
        place = UPath(url, **_OPTIONS.get(scheme, {}), **options)
        found = place.fs, place.path
    except ImportError as err:
        pip = REMOTE_EXTRA if scheme in _IN_EXTRA else "install the fsspec package for it"
        msg = f"{shown(url)}: what reads {scheme}:// is not installed; {pip}"
        raise LogError(msg) from err
    except ValueError as err:
        msg = f"{shown(url)}: not a URL that can be read; use https://, s3:// or a path"
        raise LogError(msg) from err
    return found


def require_extra(url: str, *packages: str) -> None:
    """Refuse a URL where a package of the extra is missing.

    Raises
    ------
    LogError
        Says what to install.
    """
    if any(find_spec(package) is None for package in packages):
        msg = f"{shown(url)}: logs are read from URLs with an extra; {REMOTE_EXTRA}"
        raise LogError(msg)
