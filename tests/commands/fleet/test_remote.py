"""Logs behind URLs: known again by size and ETag."""

from pathlib import Path

from tests.commands.fleet.logs import states
from tests.commands.running import BAG, FIXTURES, done, mpap
from tests.file_server import serving

ONE = ("--jobs", "1", "--end", "30")


def test_a_url_gives_the_same_model_as_the_file(tmp_path: Path) -> None:
    """The second time its content is not asked for."""
    done("learn", "--merge", BAG, *ONE, "-o", tmp_path / "near")

    with serving(FIXTURES) as server:
        words = ("learn", "--merge", f"{server.url}/{BAG.name}", *ONE, "-o", tmp_path / "far")
        first, again = done(*words), done(*words)

    for name in ("clusters.csv", "model.npz"):
        far, near = (tmp_path / place / "learn" / name for place in ("far", "near"))
        assert far.read_bytes() == near.read_bytes(), name
    assert "learnt in" in first.err
    assert "1 log learnt before" in again.err


def test_a_store_that_refuses_stops_no_other_log(tmp_path: Path) -> None:
    """The log is named; the others are merged."""
    with serving(FIXTURES) as server:
        url = f"{server.url}/missing.bag"
        outcome = mpap("learn", "--merge", url, BAG, *ONE, "-o", tmp_path)

    assert outcome.code == 3
    assert "left out: 1 log of 2 (missing.bag)" in outcome.err
    assert states(tmp_path) == {"missing.bag": "failed", BAG.name: "done"}
