"""Files in a bucket, or wherever else fsspec reads."""

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, TypeVar

from mpap_cli.logs.remote.stores import (
    FIRST_WAITS_S,
    WAITS_S,
    BrokenConnectionError,
    Facts,
    filesystem,
    persistently,
)
from mpap_cli.logs.remote.urls import scheme_of

Answer = TypeVar("Answer")

_HEAD_BYTES = 1 << 12
_MARKS = ("ETag", "etag", "md5Hash", "content_md5", "LastModified", "mtime", "created")
_NO_CREDENTIALS = "no credentials; set AWS_PROFILE, or FSSPEC_S3_ANON=true for a public bucket"


class ObjectStore:
    """One object, or all whose names begin as a folder's; a :class:`Store`."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._fs, self._path = filesystem(url)

    def facts(self) -> Facts:
        """Ask for size and mark; nothing of the content."""
        told = persistently(partial(self._ask, self._fs.info, self._path), FIRST_WAITS_S)
        if told["type"] == "directory":
            return Facts(0, is_folder=True)
        mark = next((f"{name.lower()} {told[name]}" for name in _MARKS if told.get(name)), "")
        mark = mark.replace('"', "")
        if told["size"] is None:
            head = self._ask(self._fs.cat_file, self._path, start=0, end=_HEAD_BYTES)
            return Facts(0, mark, has_ranges=False, head=head)
        return Facts(told["size"], mark)

    def fetch(self, begin: int, end: int) -> bytes:
        """Return exactly that range."""
        ask = partial(self._ask, self._fs.cat_file, self._path, start=begin, end=end)
        block: bytes = persistently(ask, WAITS_S)
        if len(block) != end - begin:
            raise OSError(errno.EIO, "the store does not give the bytes that it says it has")
        return block

    def whole(self) -> Iterator[bytes]:
        """Yield all bytes at once."""
        yield self._ask(self._fs.cat_file, self._path)

    def listing(self, pattern: str = "") -> list[str]:
        """Return what lies in the folder, or matches a pattern."""
        path = self._path.rstrip("/")
        names = (
            self._ask(self._fs.glob, f"{path}/{pattern}" if path else pattern)
            if pattern
            else self._ask(self._fs.ls, path, detail=False)
        )
        scheme = scheme_of(self._url)
        return sorted(f"{scheme}://{name.lstrip('/')}" for name in names)

    @staticmethod
    def _ask(ask: Callable[..., Answer], *places: Any, **options: Any) -> Answer:
        """Ask the file system; its errors become ours, without what it writes in them."""
        with _errors_told():
            return ask(*places, **options)


@contextmanager
def _errors_told() -> Iterator[None]:
    """Turn errors of the file system into errors with a text of ours."""
    try:
        yield
    except FileNotFoundError as err:
        raise FileNotFoundError(errno.ENOENT, "not found") from err
    except PermissionError as err:
        raise PermissionError(errno.EACCES, "access refused; check the rights") from err
    except (TimeoutError, ConnectionError) as err:
        raise BrokenConnectionError(errno.EIO, "the connection broke off") from err
    except OSError as err:
        text = os.strerror(err.errno).lower() if err.errno else "the store reports an error"
        raise OSError(errno.EIO, text) from err
    except ValueError as err:
        raise OSError(errno.EINVAL, "the store cannot look that up") from err
    except _foreign() as err:
        if type(err).__name__ in {"NoCredentialsError", "PartialCredentialsError"}:
            raise PermissionError(errno.EACCES, _NO_CREDENTIALS) from err
        raise BrokenConnectionError(errno.EIO, "the store cannot be reached") from err


def _foreign() -> tuple[type[Exception], ...]:
    """Return the errors of stores that are no errors of the operating system."""
    import sys  # noqa: PLC0415

    botocore = sys.modules.get("botocore.exceptions")
    return (botocore.BotoCoreError,) if botocore else ()
