"""``novelty``: windows of several logs, the model carried from one to the next."""

import json
from pathlib import Path

import pytest

from tests.commands.camera_runs import CAMERA_A, CAMERA_B, NOVELTY_COLUMNS, SMALL
from tests.commands.conftest import Made
from tests.commands.running import BAG, FIXTURES, MCAP, bytes_of, done, header_of, mpap, rows_of

A_B_A = (CAMERA_A, CAMERA_B, CAMERA_A)
WINDOW = ("--window", "10")


def unknown_of(out: Path, log_index: int) -> float:
    """Return the share of a log that was unknown when it began."""
    rows = [
        row
        for row in rows_of(out / "novelty" / "novelty.csv")
        if int(row["log_index"]) == log_index
    ]
    n = sum(int(row["observations"]) for row in rows)
    shares = (float(row["percent_unknown_at_start"]) * int(row["observations"]) for row in rows)
    return sum(shares) / n


def test_another_world_is_new_and_the_first_one_is_not(made: Made) -> None:
    """A, B, A again: nearly all of B is unknown when it begins, hardly anything of A is."""
    out = made("novelty", *A_B_A, *WINDOW, *SMALL)

    assert header_of(out / "novelty" / "novelty.csv") == NOVELTY_COLUMNS
    first = rows_of(out / "novelty" / "novelty.csv")[0]
    assert (first["percent_unknown_at_start"], first["sensor"]) == ("", "image")
    assert unknown_of(out, 1) >= 90
    assert unknown_of(out, 2) <= 5
    assert (out / "novelty" / "novelty.png").stat().st_size > 10_000


def test_scans_are_taken_where_a_log_has_no_camera(made: Made) -> None:
    """The sensor is that which all logs share; each scan is one observation."""
    out = made("novelty", BAG, CAMERA_A, *WINDOW)

    rows = rows_of(out / "novelty" / "novelty.csv")
    assert {row["sensor"] for row in rows} == {"scan"}
    assert sum(int(row["observations"]) for row in rows if row["log_index"] == "0") == 800


def test_a_second_run_of_the_same_flat_is_less_new(made: Made) -> None:
    """Scans of a flat that was learnt are mostly known; those of the outdoors are less."""
    out = made("novelty", BAG, MCAP, FIXTURES / "outdoor.mcap", *WINDOW)

    assert unknown_of(out, 1) < unknown_of(out, 2)


def test_a_model_makes_its_own_world_known(made: Made, tmp_path: Path) -> None:
    """--model starts from what was learnt, so that the first log has the column too."""
    model = made("learn", CAMERA_A, "--sensor", "image", *SMALL)

    done("novelty", CAMERA_A, "--model", model, "-o", tmp_path / "out")

    assert unknown_of(tmp_path / "out", 0) <= 5


def test_overlapping_windows_are_more(made: Made) -> None:
    """--step 5 with windows of 10 s gives about twice the rows."""
    apart = rows_of(made("novelty", *A_B_A, *WINDOW, *SMALL) / "novelty" / "novelty.csv")
    overlapping = made("novelty", *A_B_A, *WINDOW, "--step", "5", *SMALL)

    assert len(rows_of(overlapping / "novelty" / "novelty.csv")) > 1.5 * len(apart)


def test_the_same_bytes_twice(made: Made, tmp_path: Path) -> None:
    """Whatever --jobs."""
    done("novelty", *A_B_A, *WINDOW, *SMALL, "--jobs", 1, "-o", tmp_path / "out")

    assert bytes_of(tmp_path / "out" / "novelty") == bytes_of(
        made("novelty", *A_B_A, *WINDOW, *SMALL) / "novelty"
    )


def test_what_is_printed(tmp_path: Path) -> None:
    """A line a log, and with --format json the rows of the table."""
    page = done("novelty", *A_B_A, *WINDOW, *SMALL, "-o", tmp_path / "table")
    facts = done("novelty", *A_B_A, *WINDOW, *SMALL, "--format", "json", "-o", tmp_path / "json")

    assert "unknown at its start" in page.out
    assert page.out.count("camera-a.mcap") >= 2
    assert list(json.loads(facts.out)[0]) == NOVELTY_COLUMNS.split()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--step", "7", "--window", "60"), "does not divide"),
        (("--sensor", "image"), "no image topic"),
        (("--model", "nowhere"), "nowhere"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path: Path, words: tuple[str, ...], said: str) -> None:
    """One line, no results."""
    outcome = mpap("novelty", BAG, *words, "-o", tmp_path / "out")

    assert outcome.code in {1, 2}
    assert said in outcome.err
    assert not (tmp_path / "out").exists()
