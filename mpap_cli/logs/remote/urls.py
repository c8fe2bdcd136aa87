"""What can be told from a URL by its words alone."""

import glob
import re
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

HTTP = frozenset({"http", "https"})
_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
_LOCAL = frozenset({"file", "local"})


def is_url(word: str) -> bool:
    """Tell a URL from a path.

    >>> is_url("s3://logs/day1.mcap"), is_url("day1.mcap"), is_url("C://day1.mcap")
    (True, False, False)
    """
    return _URL.match(word) is not None


def scheme_of(url: str) -> str:
    """Return what stands before ``://``, in small letters."""
    return url.partition("://")[0].lower()


def local_path(url: str) -> Path | None:
    """Return the path that a URL of a local file stands for; None of others.

    >>> local_path("file:///logs/day%201.bag")
    PosixPath('/logs/day 1.bag')
    """
    if scheme_of(url) not in _LOCAL:
        return None
    rest = url.partition("://")[2].removeprefix("localhost/")
    return Path("/" + unquote(rest.lstrip("/")))


def split_query(url: str) -> tuple[str, str]:
    """Part what names a file on a web server from the query and the fragment behind it.

    >>> split_query("https://host/day1.mcap?key=1")
    ('https://host/day1.mcap', '?key=1')
    """
    if scheme_of(url) not in HTTP:
        return url, ""
    begin = min((url.index(mark) for mark in "?#" if mark in url), default=len(url))
    return url[:begin], url[begin:].partition("#")[0]


def shown(url: str) -> str:
    """Return a URL without what could be secret: user, password, query.

    >>> shown("https://me:secret@host/day1.mcap?signature=abc")
    'https://host/day1.mcap'
    """
    bare = split_query(url)[0]
    scheme, _, rest = bare.partition("://")
    host, slash, path = rest.partition("/")
    return f"{scheme}://{host.rpartition('@')[2]}{slash}{path}"


def base_name(url: str) -> str:
    """Return the base name of the file or folder.

    >>> base_name("https://host/a/day%201.mcap?key=1"), base_name("s3://logs/day1/")
    ('day 1.mcap', 'day1')
    """
    bare = shown(url)
    parts = [part for part in bare.partition("://")[2].split("/") if part]
    last = parts[-1] if parts else bare
    return PurePosixPath(unquote(last) if scheme_of(url) in HTTP else last).name or last


def split_pattern(url: str) -> tuple[str, str]:
    """Part the folder that is named from the pattern behind it; empty if there is none.

    A web server has its query behind a ``?``.

    >>> split_pattern("s3://logs/*/a.mcap"), split_pattern("https://[::1]/day?x=*")
    (('s3://logs/', '*/a.mcap'), ('https://[::1]/day/', ''))
    """
    parts = split_query(url)[0].split("/")
    begin = 3 if scheme_of(url) in HTTP else 2
    magic = (place for place, part in enumerate(parts) if place >= begin and glob.has_magic(part))
    first = next(magic, len(parts))
    return "/".join(parts[:first]) + "/", "/".join(parts[first:])
