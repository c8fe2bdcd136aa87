"""Files on a web server."""

import asyncio
import errno
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any, NamedTuple

import aiohttp
import yarl
from fsspec.asyn import sync

from mpap_cli.logs.remote.stores import (
    ANSWER_S,
    CONNECT_S,
    FIRST_WAITS_S,
    WAITS_S,
    BrokenConnectionError,
    Facts,
    filesystem,
    persistently,
)
from mpap_cli.logs.remote.urls import split_query

_HEAD_BYTES = 1 << 14
_PIECE_BYTES = 1 << 20
_SLOWEST = 1 << 14  # bytes a second
_RANGE = re.compile(r"bytes (\d+)-(\d+)/(\d+)$")
_EMPTY_RANGE = re.compile(r"bytes \*/0$")
_WHOLE, _PART, _NO_RANGE = 200, 206, 416
_SAYS_OTHERWISE = "the server does not give the bytes that it says it has"
_LATER = frozenset({408, 425, 429, 500, 502, 503, 504})
_MISSING, _REFUSED = frozenset({404, 410}), frozenset({401, 403, 407})


class _Reply(NamedTuple):
    """What a server answered to a request for a range."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def mark(self) -> str:
        """What changes with the content."""
        for name in ("ETag", "Last-Modified"):
            if name in self.headers:
                return f"{name.lower()} {self.headers[name]}".replace('"', "")
        return ""


class HttpStore:
    """One file or folder behind http:// or https://; a :class:`Store`."""

    def __init__(self, url: str) -> None:
        place, self._query = split_query(url)
        self._fs, self._path = filesystem(place, client_kwargs={"trust_env": True})
        self._mark = ""

    def facts(self) -> Facts:
        """Ask for the first bytes, which tells all there is to know."""
        reply = persistently(partial(self._ask, 0, _HEAD_BYTES), FIRST_WAITS_S)
        self._mark = reply.mark
        content_range = reply.headers.get("Content-Range", "")
        if reply.status == _NO_RANGE and _EMPTY_RANGE.match(content_range):
            return Facts(0, reply.mark)
        _require_sound(reply.status)
        if reply.headers.get("Content-Type", "").startswith("text/html"):
            return Facts(0, reply.mark, is_folder=True, head=reply.body)
        length = reply.headers.get("Content-Length", "")
        size = int(length) if length.isdecimal() else 0
        if reply.status == _WHOLE:
            return Facts(size, reply.mark, has_ranges=False, head=reply.body)
        told = _RANGE.match(content_range)
        if told is None:
            return Facts(0, reply.mark, has_ranges=False, head=reply.body)
        first, last, total = map(int, told.groups())
        if (first, last + 1) != (0, len(reply.body)) or len(reply.body) != min(total, _HEAD_BYTES):
            raise OSError(errno.EIO, _SAYS_OTHERWISE)
        return Facts(total, reply.mark, head=reply.body)

    def fetch(self, begin: int, end: int) -> bytes:
        """Return exactly that range."""
        reply = persistently(partial(self._ask, begin, end), WAITS_S)
        _require_sound(reply.status)
        told = _RANGE.match(reply.headers.get("Content-Range", ""))
        if reply.status != _PART or told is None or reply.mark != self._mark:
            raise OSError(errno.EIO, "the file on the server has changed while it was read")
        if int(told[1]) != begin or len(reply.body) != end - begin:
            raise OSError(errno.EIO, _SAYS_OTHERWISE)
        return reply.body

    def whole(self) -> Iterator[bytes]:
        """Yield all pieces of one answer."""
        session = self._sync(self._fs.set_session(), CONNECT_S)
        with _errors_told():
            reply = self._sync(session.get(self._address(), **self._request(None)), ANSWER_S)
        try:
            _require_sound(reply.status)
            while True:
                with _errors_told():
                    piece = self._sync(reply.content.read(_PIECE_BYTES), ANSWER_S)
                if not piece:
                    return
                yield piece
        finally:
            self._sync(_close(reply), CONNECT_S)

    def listing(self, pattern: str = "") -> list[str]:
        """Return what the page of the folder links to, or what matches a pattern."""
        folder = self._path.rstrip("/") + "/"
        with _errors_told():
            names = (
                self._fs.glob(folder + pattern) if pattern else self._fs.ls(folder, detail=False)
            )
        return sorted(name + self._query for name in set(names) if not name.endswith("?"))

    def _ask(self, begin: int, end: int) -> _Reply:
        """Ask for a range; of an answer that is longer, no more is taken."""
        limit_s = CONNECT_S + ANSWER_S + (end - begin) / _SLOWEST
        with _errors_told():
            reply: _Reply = self._sync(self._get(begin, end), limit_s)
        if reply.status in _LATER:
            raise BrokenConnectionError(errno.EIO, f"the server answers {reply.status}")
        return reply

    async def _get(self, begin: int, end: int) -> _Reply:
        """Read the answer to a request for a range."""
        session = await self._fs.set_session()
        wanted, body = end - begin, bytearray()
        async with session.get(self._address(), **self._request(f"bytes={begin}-{end - 1}")) as got:
            while len(body) < wanted and (piece := await got.content.read(wanted - len(body))):
                body += piece
            return _Reply(got.status, got.headers, bytes(body))

    def _address(self) -> yarl.URL:
        """Return the URL as it was given; what is encoded in it stays so."""
        url = self._path + self._query
        return yarl.URL(url, encoded="%" in url)

    @staticmethod
    def _request(span: str | None) -> dict[str, Any]:
        headers = {"Accept-Encoding": "identity"} | ({"Range": span} if span else {})
        timeout = aiohttp.ClientTimeout(sock_connect=CONNECT_S, sock_read=ANSWER_S)
        return {"headers": headers, "timeout": timeout}

    def _sync(self, ask: Any, limit_s: float) -> Any:
        """Wait for the loop that fsspec runs in a thread of its own."""

        async def awaited() -> Any:
            return await asyncio.wait_for(ask, limit_s)

        return sync(self._fs.loop, awaited)


async def _close(reply: aiohttp.ClientResponse) -> None:
    """Leave the rest of an answer; that is done where the answer is read."""
    reply.close()


def _require_sound(status: int) -> None:
    """Turn a refusal into an error."""
    if status in _MISSING:
        raise FileNotFoundError(errno.ENOENT, f"not found, the server answers {status}")
    if status in _REFUSED:
        text = (
            f"access refused, the server answers {status}; check the rights, or ask for a new link"
        )
        raise PermissionError(errno.EACCES, text)
    if status not in {_WHOLE, _PART}:
        raise OSError(errno.EIO, f"the server answers {status}")


@contextmanager
def _errors_told() -> Iterator[None]:
    """Turn errors of the client, which may hold the whole URL, into ours."""
    try:
        yield
    except FileNotFoundError as err:
        raise FileNotFoundError(errno.ENOENT, "not found") from err
    except aiohttp.ClientSSLError as err:
        raise OSError(errno.EIO, "its certificate is not trusted") from err
    except aiohttp.ClientConnectorError as err:
        number, text = err.os_error.errno or 0, err.os_error.strerror or "no such host"
        why = (os.strerror(number) if number > 0 else text).lower()
        raise BrokenConnectionError(errno.EIO, f"the server cannot be reached ({why})") from err
    except TimeoutError as err:
        raise BrokenConnectionError(errno.EIO, "the server does not answer in time") from err
    except aiohttp.ClientResponseError as err:
        _require_sound(err.status)
        raise OSError(errno.EIO, f"the server answers {err.status}") from err
    except (aiohttp.InvalidURL, ValueError) as err:
        raise OSError(errno.EINVAL, "not a URL that can be read") from err
    except aiohttp.ClientError as err:
        raise BrokenConnectionError(errno.EIO, "the connection broke off") from err
