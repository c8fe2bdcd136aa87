"""Web servers that refuse, break off, are slow, or say what is not so."""

import re

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import expand_paths, open_log
from mpap_cli.logs.remote import http_store
from tests.conftest import WriteLog
from tests.logs.remote.conftest import Serve
from tests.logs.remote.served import ROWS, big_rows, messages_of, remote


def test_goes_on_behind_broken_connections(write_log: WriteLog, serve: Serve) -> None:
    """A connection that breaks is made anew, and an overloaded server asked again."""
    log = write_log("mcap-none", big_rows())
    server = serve(log.parent, n_breaks=2, n_failures=1)

    found = messages_of(remote(server, log.name))

    assert found == messages_of(log)
    assert server.manners.n_breaks == server.manners.n_failures == 0


@pytest.mark.parametrize("has_ranges", [True, False])
def test_gives_up_where_connections_break_for_good(
    write_log: WriteLog, serve: Serve, has_ranges: bool
) -> None:
    """The log cannot be read to its end, which is no damage of the file."""
    log = write_log("mcap-none", big_rows())
    server = serve(log.parent, n_breaks=1000, has_ranges=has_ranges, break_after=20_000)

    with pytest.raises(LogError, match=r"^log.mcap: .*the connection broke off, \d attempts\)"):
        messages_of(remote(server, log.name))


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (404, "not found, the server answers 404"),
        (403, "access refused, the server answers 403; check the rights, or ask for a new link"),
        (401, "access refused, the server answers 401; check the rights, or ask for a new link"),
        (503, "the server answers 503, 2 attempts"),
        (418, "the server answers 418"),
    ],
)
def test_says_what_a_server_refuses(
    write_log: WriteLog, serve: Serve, status: int, words: str
) -> None:
    """The reason stands in one line, without what was secret in the URL."""
    log = write_log("mcap-none", ROWS)
    server = serve(log.parent, statuses={log.name: status})
    path = remote(server, "log.mcap?signature=SECRET")

    with pytest.raises(LogError, match=f"^log.mcap: cannot be read \\({re.escape(words)}\\)$"):
        open_log(path)


def test_waits_no_longer_than_it_should(
    write_log: WriteLog, serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A server that does not answer is given up."""
    log = write_log("mcap-none", ROWS)
    server = serve(log.parent, wait_s=0.5)
    monkeypatch.setattr(http_store, "ANSWER_S", 0.1)

    with pytest.raises(LogError, match="the server does not answer in time, 2 attempts"):
        open_log(remote(server, log.name))


@pytest.mark.parametrize("url", ["http://127.0.0.1:9/log.mcap", "https:///log.mcap"])
def test_says_that_no_server_is_there(url: str) -> None:
    """A server that cannot be reached, or is not named, is told in one line."""
    with pytest.raises(LogError, match=r"log.mcap: cannot be read \((the server cannot|not a URL)"):
        open_log(expand_paths([url])[0])


@pytest.mark.parametrize("has_ranges", [True, False])
def test_believes_no_size_that_is_too_large(
    write_log: WriteLog, serve: Serve, has_ranges: bool
) -> None:
    """A server that says it has more than it gives is not read."""
    log = write_log("mcap-none", big_rows())
    server = serve(log.parent, extra=1000, has_ranges=has_ranges)

    with pytest.raises(LogError, match=r"(that it says it has|broke off)"):
        open_log(remote(server, log.name))


def test_copies_a_file_of_unknown_size(write_log: WriteLog, serve: Serve) -> None:
    """Where a server tells no size, all that comes is taken."""
    log = write_log("mcap-none", ROWS)
    server = serve(log.parent, has_ranges=False, tells_size=False)

    found = messages_of(remote(server, log.name))

    assert found == messages_of(log)


def test_notices_a_file_that_is_replaced(write_log: WriteLog, serve: Serve) -> None:
    """What was fetched of two files is not read as one."""
    log = write_log("mcap-none", big_rows())
    server = serve(log.parent)

    with open_log(remote(server, log.name)) as reader:
        log.write_bytes(log.read_bytes())
        with pytest.raises(LogError, match="has changed while it was read"):
            list(reader.messages({"/image"}))


def test_says_that_a_page_is_no_log(write_log: WriteLog, serve: Serve) -> None:
    """A page without logs, and an empty file, are named as such."""
    log = write_log("mcap-none", ROWS)
    log.with_name("empty.bag").write_bytes(b"")
    (log.parent / "sub").mkdir()
    server = serve(log.parent)

    with pytest.raises(LogError, match=r"sub: no .db3 or .mcap file in this folder"):
        open_log(remote(server, "sub"))
    with pytest.raises(LogError, match=r"empty.bag: the file is empty"):
        open_log(remote(server, "empty.bag"))


def test_sends_user_and_password(write_log: WriteLog, serve: Serve) -> None:
    """What the URL says of the user goes to the server and stands in no text."""
    log = write_log("mcap-none", ROWS)
    server = serve(log.parent, user="Basic bWU6c2VjcmV0")
    (path,) = expand_paths([server.url.replace("://", "://me:secret@") + "/log.mcap"])

    found = messages_of(path)

    assert found == messages_of(log)
    assert str(path) == f"{server.url}/log.mcap"
    assert "secret" not in repr(path)
