"""``mpap compare``: a matrix of logs, and an exit code for CI."""

from pathlib import Path

import pytest

from mpap_cli.commands.compare import NOVEL
from tests.commands.running import BAG, FIXTURES, MCAP, done, header_of, mpap, rows_of

OUTDOOR = FIXTURES / "outdoor.mcap"
CAMERAS = FIXTURES / "camera-a.mcap", FIXTURES / "camera-b.mcap"


def shares(out: Path) -> dict[tuple[str, str], float]:
    """Return the unknown share in percent, by log and what it was held against."""
    rows = rows_of(out / "compare" / "compare.csv")
    return {(row["log"], row["against"]): float(row["percent_unknown"]) for row in rows}


def test_two_runs_of_one_flat_and_one_outdoors(tmp_path: Path) -> None:
    """The flat explains itself, not the world outside; all others explain no less than one."""
    outcome = done("compare", BAG, MCAP, OUTDOOR, "-o", tmp_path)
    found = shares(tmp_path)

    assert header_of(tmp_path / "compare" / "compare.csv") == (
        "log log_index against against_index observations unknown percent_unknown"
    )
    assert found[BAG.name, MCAP.name] < 10
    assert found[OUTDOOR.name, BAG.name] > 20
    for name in (BAG.name, MCAP.name, OUTDOOR.name):
        single = [share for (log, other), share in found.items() if log == name != other]
        assert found[name, "all others"] <= min(single)
    assert f"{found[OUTDOOR.name, BAG.name]:.1f} %" in outcome.out
    assert (tmp_path / "compare" / "compare.png").stat().st_size > 10_000


@pytest.mark.parametrize(("allowed", "code"), [("0.01", NOVEL), ("0.9", 0)])
def test_exit_code_speaks_of_the_last_log(tmp_path: Path, allowed: str, code: int) -> None:
    """More of it is unknown than allowed, or not; the results are there either way."""
    outcome = mpap("compare", BAG, OUTDOOR, "--fail-if-novel", allowed, "-o", tmp_path)

    assert outcome.code == code
    assert shares(tmp_path)[OUTDOOR.name, "all others"] > 1
    assert ("more than was allowed" in outcome.out) == (code == NOVEL)


def test_images(tmp_path: Path) -> None:
    """Two worlds with other textures know nothing of each other."""
    done("compare", *CAMERAS, "-o", tmp_path)

    assert min(shares(tmp_path).values()) > 80


def test_one_log_is_nothing_to_compare(tmp_path: Path) -> None:
    """It takes two; nothing is written."""
    outcome = mpap("compare", BAG, "-o", tmp_path / "out")

    assert outcome.code == 2
    assert "expected two or more" in outcome.err
    assert not (tmp_path / "out").exists()


def test_same_bytes_whatever_the_jobs(tmp_path: Path) -> None:
    """Threads change nothing."""
    for jobs in (1, 3):
        done("compare", BAG, MCAP, "--jobs", jobs, "-o", tmp_path / str(jobs))

    first, second = ((tmp_path / jobs / "compare" / "compare.csv").read_bytes() for jobs in "13")
    assert first == second
