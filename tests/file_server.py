"""A web server on loopback that gives files by ranges, or misbehaves as it is told."""

import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

_RANGE = re.compile(r"bytes=(\d+)-(\d+)$")


@dataclass
class Manners:
    """How the server behaves.

    ``statuses`` are given instead of the file, by name; the first ``n_breaks`` answers that
    are longer than ``break_after`` bytes end there; ``extra`` is added to every size that is
    told; answers wait ``wait_s``.
    """

    has_ranges: bool = True
    tells_size: bool = True
    has_etag: bool = True
    statuses: dict[str, int] = field(default_factory=dict)
    n_failures: int = 0
    n_breaks: int = 0
    break_after: int = 1 << 14
    extra: int = 0
    wait_s: float = 0.0
    user: str = ""


@dataclass
class FileServer:
    """The running server; ``asked`` are the paths and ranges, ``n_bytes`` went out."""

    url: str
    manners: Manners
    asked: list[tuple[str, str]] = field(default_factory=list)
    n_bytes: int = 0


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    folder: Path
    told: FileServer

    def log_message(self, *_words: Any) -> None:
        """Say nothing."""

    def do_GET(self) -> None:
        """Answer as the manners say."""
        manners = self.told.manners
        name = unquote(urlsplit(self.path).path).lstrip("/")
        self.told.asked.append((self.path, self.headers.get("Range", "")))
        time.sleep(manners.wait_s)
        if manners.n_failures:
            manners.n_failures -= 1
            self.send_error(503)
        elif manners.user and self.headers.get("Authorization") != manners.user:
            self.send_error(401)
        elif name in manners.statuses:
            self.send_error(manners.statuses[name])
        elif (self.folder / name).is_dir():
            self._list(self.folder / name)
        elif (self.folder / name).is_file():
            self._send(self.folder / name)
        else:
            self.send_error(404)

    def _list(self, folder: Path) -> None:
        """Send a page with links, as web servers do."""
        names = sorted(one.name + "/" * one.is_dir() for one in folder.iterdir())
        page = "".join(f'<a href="{name}">{name}</a>\n' for name in names).encode()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", str(len(page)))
        self.end_headers()
        self.wfile.write(page)

    def _send(self, file: Path) -> None:
        """Send a file or a range of it."""
        manners, size = self.told.manners, file.stat().st_size
        begin, end = 0, size
        wanted = _RANGE.match(self.headers.get("Range", "")) if manners.has_ranges else None
        total = size + manners.extra
        if wanted:
            begin, end = int(wanted[1]), min(int(wanted[2]) + 1, size)
        if wanted and begin >= size:
            self.send_response(416)
            self.send_header("Content-Range", f"bytes */{total}")
            self.send_header("Content-Length", "0")
            self.end_headers()
            return
        self.send_response(206 if wanted else 200)
        if wanted:
            self.send_header("Content-Range", f"bytes {begin}-{end - 1}/{total}")
        if manners.tells_size:
            length = end - begin if wanted else total
            self.send_header("Content-Length", str(length))
        else:
            self.close_connection = True
        if manners.has_etag:
            self.send_header("ETag", f'"{file.stat().st_mtime_ns:x}"')
        self.end_headers()
        self._write(file, begin, end)

    def _write(self, file: Path, begin: int, end: int) -> None:
        """Send the bytes, or some of them."""
        manners = self.told.manners
        breaks = manners.n_breaks > 0 and end - begin > manners.break_after
        with file.open("rb") as stream:
            stream.seek(begin)
            content = stream.read(manners.break_after if breaks else end - begin)
        try:
            self.wfile.write(content)
        except ConnectionError:
            self.close_connection = True  # whoever asked wanted the beginning only
            return
        self.told.n_bytes += len(content)
        if breaks or manners.extra:
            manners.n_breaks -= breaks
            self.close_connection = True


class _Server(ThreadingHTTPServer):
    def handle_error(self, *_who: Any) -> None:
        """Say nothing of clients that leave."""


@contextmanager
def serving(folder: Path, **manners: Any) -> Iterator[FileServer]:
    """Serve a folder on loopback for as long as the block lasts."""
    handler = type("Handler", (_Handler,), {"folder": folder})
    with _Server(("127.0.0.1", 0), handler) as server:
        told = FileServer(f"http://127.0.0.1:{server.server_port}", Manners(**manners))
        handler.told = told  # type: ignore[attr-defined]  # made for this server alone
        thread = threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True)
        thread.start()
        try:
            yield told
        finally:
            server.shutdown()
            thread.join()


Serve = Callable[..., FileServer]
