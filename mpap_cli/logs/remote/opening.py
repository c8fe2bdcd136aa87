"""Which store holds what a URL names."""

from mpap_cli.logs.remote.stores import Store, require_extra
from mpap_cli.logs.remote.urls import HTTP, scheme_of


def open_store(url: str) -> Store:
    """Return what holds the file or folder of a URL; nothing is asked yet.

    Raises
    ------
    LogError
        If a package is missing, or the protocol is unknown.
    """
    if scheme_of(url) in HTTP:
        require_extra(url, "upath", "fsspec", "aiohttp")
        from mpap_cli.logs.remote.http_store import HttpStore  # noqa: PLC0415

        return HttpStore(url)
    from mpap_cli.logs.remote.object_store import ObjectStore  # noqa: PLC0415

    return ObjectStore(url)
