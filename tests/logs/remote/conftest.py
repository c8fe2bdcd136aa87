"""Served folders, and no long waits for servers that fail."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from mpap_cli.logs.remote import copying, http_store, object_store
from tests.file_server import FileServer, serving

Serve = Callable[..., FileServer]


@pytest.fixture(autouse=True)
def short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ask again at once."""
    for module in (http_store, object_store):
        monkeypatch.setattr(module, "WAITS_S", (0.0, 0.0))
        monkeypatch.setattr(module, "FIRST_WAITS_S", (0.0,))
    monkeypatch.setattr(copying, "_WAITS_S", (0.0,))


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Return a function that serves a folder until the test ends."""
    with ExitStack() as stack:

        def call(folder: Path, **manners: object) -> FileServer:
            return stack.enter_context(serving(folder, **manners))

        yield call
