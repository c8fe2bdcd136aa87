"""Commands on logs behind URLs: results, and what of a URL stands in them."""

import json
import logging
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from urllib.request import urlopen

import pytest

from mpap_cli.logs.remote import http_store
from tests.commands.running import BAG, FIXTURES, MCAP, done, mpap
from tests.file_server import FileServer, serving

Serve = Callable[..., FileServer]
MODEL_FILES = ("clusters.csv", "model.npz", "recording.npz", "exemplars.png")


@pytest.fixture
def serve(monkeypatch: pytest.MonkeyPatch) -> Iterator[Serve]:
    """Return a function that serves a folder until the test ends."""
    monkeypatch.setattr(http_store, "WAITS_S", (0.0,))
    with ExitStack() as stack:

        def call(folder: Path, **manners: object) -> FileServer:
            return stack.enter_context(serving(folder, **manners))

        yield call


def signed(server: FileServer, *names: str) -> list[str]:
    """Return URLs with a user, a password and a signature."""
    host = server.url.replace("://", "://me:PASSWORD@")
    return [f"{host}/{name}?key=SIGNATURE" for name in names]


def test_learns_the_same_from_a_url(serve: Serve, tmp_path: Path) -> None:
    """Clusters, model, recording and picture are those of the local logs, byte for byte."""
    served = tmp_path / "web"
    served.mkdir()
    (served / FIXTURES.name).symlink_to(FIXTURES)
    server = serve(served)
    urls = signed(server, *(f"{FIXTURES.name}/{log.name}" for log in (BAG, MCAP)))

    done("learn", *urls, "-o", tmp_path / "far")

    done("learn", BAG, MCAP, "-o", tmp_path / "near")
    for name in MODEL_FILES:
        far, near = (tmp_path / place / "learn" / name for place in ("far", "near"))
        assert far.read_bytes() == near.read_bytes(), name


def test_nothing_secret_is_written_or_said(
    serve: Serve, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Results and talk hold base names; settings.json says why there is no SHA-256."""
    server = serve(FIXTURES)
    caplog.set_level(logging.DEBUG, "mpap_cli")

    ends = [
        done("learn", "-v", *signed(server, MCAP.name), "-o", tmp_path),
        done("info", *signed(server, MCAP.name), "--format", "json"),
    ]

    printed = "".join(end.out + end.err for end in ends)
    written = b"".join(file.read_bytes() for file in tmp_path.rglob("*") if file.is_file())
    for secret in ("PASSWORD", "SIGNATURE"):
        assert secret not in printed + caplog.text
        assert secret.encode() not in written
    settings = json.loads((tmp_path / "learn" / "settings.json").read_text())
    with urlopen(f"{server.url}/{MCAP.name}") as answer:  # noqa: S310  # of this test
        mark = answer.headers["ETag"].strip('"')
    assert settings["inputs"] == [
        {
            "name": MCAP.name,
            "size": MCAP.stat().st_size,
            "sha256": f"not read whole; etag {mark}",
        }
    ]


def test_what_was_copied_has_its_sha256(serve: Serve, tmp_path: Path) -> None:
    """A log that is copied whole is known again as the local one."""
    database = next((FIXTURES / "indoor-b").glob("*.zstd"))
    server = serve(FIXTURES)

    done("learn", f"{server.url}/indoor-b/{database.name}", "-o", tmp_path / "far")

    done("learn", database, "-o", tmp_path / "near")
    far, near = (
        json.loads((tmp_path / place / "learn" / "settings.json").read_text())["inputs"]
        for place in ("far", "near")
    )
    assert far == near


def test_a_log_that_is_refused_is_left_out(serve: Serve, tmp_path: Path) -> None:
    """Of several logs the others are learnt, and the exit code tells; of one it is an error."""
    server = serve(FIXTURES, statuses={BAG.name: 403})
    refused, good = (f"{server.url}/{log.name}" for log in (BAG, MCAP))

    two = mpap("learn", refused, good, "-o", tmp_path / "two")
    one = mpap("learn", refused, "-o", tmp_path / "one")

    assert (two.code, one.code) == (3, 1)
    assert one.err.startswith(f"mpap: {BAG.name}: cannot be read (access refused, the server")
    settings = json.loads((tmp_path / "two" / "learn" / "settings.json").read_text())
    assert [one["name"] for one in settings["inputs"]] == [MCAP.name]
    assert not (tmp_path / "one" / "learn").exists()


def test_nothing_is_written_of_a_log_that_breaks_off(serve: Serve, tmp_path: Path) -> None:
    """Half of a log is not taken for the whole: older results stay as they were."""
    out = tmp_path / "out"
    done("learn", MCAP, "-o", out)
    before = (out / "learn" / "settings.json").read_bytes()
    server = serve(FIXTURES, n_breaks=1000, break_after=20_000)

    end = mpap("learn", f"{server.url}/{MCAP.name}", "-o", out)

    assert end.code == 1
    assert "the connection broke off, 2 attempts" in end.err
    assert (out / "learn" / "settings.json").read_bytes() == before


def test_models_are_read_from_this_machine_only(serve: Serve, tmp_path: Path) -> None:
    """A model behind a URL is an error that says so."""
    server = serve(FIXTURES)

    end = mpap("predict", f"{server.url}/model.npz", MCAP, "-o", tmp_path)

    assert end.code == 1
    assert end.err == "mpap: model.npz: models are read from this machine only; fetch it first\n"
