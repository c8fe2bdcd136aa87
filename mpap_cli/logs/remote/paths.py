"""Where logs lie: on this machine, or behind a URL."""

import errno
import hashlib
import logging
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import BinaryIO, TypeAlias, cast

from mpap_cli.errors import LogError
from mpap_cli.logs.remote.opening import open_store
from mpap_cli.logs.remote.range_stream import Blocks, RangeStream
from mpap_cli.logs.remote.stores import Facts, Store, Traffic
from mpap_cli.logs.remote.urls import base_name, shown, split_pattern, split_query

_LOG = logging.getLogger(__name__)
_PIECE_BYTES = 1 << 22


class RemotePath:
    """A file or folder behind a URL, with those methods of a path that logs are read by.

    As text it shows neither user nor password nor query; ``url`` holds them. All methods
    that ask the store raise ``OSError``. ``sha256`` is known once the file was copied.
    """

    def __init__(self, url: str, traffic: Traffic | None = None) -> None:
        self.url = url
        self.traffic = Traffic() if traffic is None else traffic
        self.sha256 = ""
        self._blocks = Blocks()
        self._inside: dict[str, RemotePath] = {}

    def __str__(self) -> str:
        return shown(self.url)

    def __repr__(self) -> str:
        return f"RemotePath({str(self)!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RemotePath) and self.url == other.url

    def __hash__(self) -> int:
        return hash(self.url)

    def __lt__(self, other: "RemotePath") -> bool:
        return self.url < other.url

    def __truediv__(self, name: str) -> "RemotePath":
        bare, query = split_query(self.url)
        return self._in_folder(f"{bare.rstrip('/')}/{name}{query}")

    def __reduce__(self) -> tuple[type["RemotePath"], tuple[str]]:
        return RemotePath, (self.url,)

    @property
    def name(self) -> str:
        """The base name."""
        return base_name(self.url)

    @property
    def stem(self) -> str:
        """The base name without its last ending."""
        return PurePosixPath(self.name).stem

    @property
    def suffix(self) -> str:
        """The last ending of the base name."""
        return PurePosixPath(self.name).suffix

    @property
    def parent(self) -> "RemotePath":
        """The folder."""
        bare, query = split_query(self.url)
        return RemotePath(bare.rstrip("/").rpartition("/")[0] + "/" + query, self.traffic)

    def with_ending(self, ending: str) -> "RemotePath":
        """Return what lies beside under the same name with something behind it."""
        bare, query = split_query(self.url)
        return RemotePath(f"{bare}{ending}{query}", self.traffic)

    def absolute(self) -> "RemotePath":
        """Return the same; a URL is absolute."""
        return self

    def resolve(self) -> "RemotePath":
        """Return the same."""
        return self

    def _in_folder(self, url: str) -> "RemotePath":
        """Return a file of the folder, the same for the same URL."""
        return self._inside.setdefault(url, RemotePath(url, self.traffic))

    def describe(self) -> tuple[int, str]:
        """Return what the content is known again by, of a folder that of what was opened in it.

        Returns
        -------
        int
            Size in bytes.
        str
            SHA-256 of a file that was read whole; else why there is none, and the mark that
            the store gave. Of a folder, the SHA-256 of one line ``mark  name`` for each file.
        """
        if not self.is_dir():
            mark = f"; {self.facts.mark}" if self.facts.mark else ""
            return self.facts.size, self.sha256 or f"not read whole{mark}"
        files = sorted(path for path in self._inside.values() if path.was_opened)
        described = [path.describe() for path in files]
        lines = [f"{m}  {path.name}\n" for path, (_, m) in zip(files, described, strict=True)]
        total = hashlib.sha256("".join(lines).encode("utf-8", "surrogateescape"))
        return sum(size for size, _ in described), total.hexdigest()

    @property
    def was_opened(self) -> bool:
        """Whether the store has said that this is a file."""
        facts: Facts | None = self.__dict__.get("facts")
        return facts is not None and not facts.is_folder

    @cached_property
    def _store(self) -> Store:
        return open_store(self.url)

    @cached_property
    def facts(self) -> Facts:
        """What the store says; asked once."""
        facts = self._store.facts()
        self.traffic.add(facts.head)
        if facts.head:
            self._blocks.add(0, facts.head)
        return facts

    def is_dir(self) -> bool:
        """Tell whether it is a folder."""
        return split_query(self.url)[0].endswith("/") or self.facts.is_folder

    def is_file(self) -> bool:
        """Tell whether there is such a file, and it may be read."""
        try:
            return not self.is_dir()
        except (FileNotFoundError, PermissionError):
            return False

    def iterdir(self) -> Iterator["RemotePath"]:
        """Yield what lies in the folder."""
        for url in self._store.listing():
            yield self._in_folder(url)

    def matches(self, pattern: str) -> list["RemotePath"]:
        """Return what lies in the folder and matches, each with a count of its own."""
        return [RemotePath(url) for url in self._store.listing(pattern)]

    def open(self, _mode: str = "rb") -> BinaryIO:
        """Return a stream that fetches what is read."""
        if self.facts.is_folder:
            raise IsADirectoryError(errno.EISDIR, "it is a folder or a web page, not a log")
        # where there are no ranges the head tells what it is; the rest is read from a copy
        size = self.facts.size if self.facts.has_ranges else len(self.facts.head)
        return cast("BinaryIO", RangeStream(size, self._fetch, self._blocks))

    def pieces(self) -> Iterator[bytes]:
        """Yield the whole file in order; by ranges, where what breaks off is asked for again."""
        if not self.facts.has_ranges:
            for piece in self._store.whole():
                self.traffic.add(piece)
                yield piece
            return
        for begin in range(0, self.facts.size, _PIECE_BYTES):
            yield self._fetch(begin, min(begin + _PIECE_BYTES, self.facts.size))

    def _fetch(self, begin: int, end: int) -> bytes:
        block = self._store.fetch(begin, end)
        self.traffic.add(block)
        return block

    def tell_traffic(self) -> None:
        """Say how much was fetched."""
        size = f" of {self.facts.size:,}" if self.was_opened else ""
        fetched, times = f"{self.traffic.n_bytes:,}", self.traffic.n_requests
        _LOG.debug("%s: %s%s bytes fetched in %d requests", self.name, fetched, size, times)


LogPath: TypeAlias = Path | RemotePath


def first_bytes(path: LogPath, size: int) -> bytes:
    """Read the first bytes of a file, wherever it lies; fewer if it has no more."""
    if isinstance(path, RemotePath) and not path.facts.has_ranges:
        begin = bytearray()
        pieces = path.pieces()
        while len(begin) < size and (piece := next(pieces, b"")):
            begin += piece
        return bytes(begin[:size])
    with path.open("rb") as stream:
        return stream.read(size)


def paths_of_url(url: str) -> list[RemotePath]:
    """Turn a URL into what it stands for: one file or folder, or all that match it.

    Raises
    ------
    LogError
        If a pattern matches nothing, or its folder cannot be listed.
    """
    folder, pattern = split_pattern(url)
    if not pattern:
        return [RemotePath(url)]
    try:
        found = RemotePath(folder + split_query(url)[1]).matches(pattern)
    except OSError as err:
        msg = f"{shown(url)}: cannot be listed ({err.strerror})"
        raise LogError(msg) from err
    if not found:
        msg = f"{shown(url)}: matches no file or folder"
        raise LogError(msg)
    return found
