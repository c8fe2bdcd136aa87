"""``mpap evaluate`` finds the same today and tomorrow."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.commands.golden import assert_golden
from tests.commands.running import BAG, MCAP, PAPER, bytes_of, done, evaluated, record_of

Made = Callable[..., Path]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "words"), [("robust", ()), ("paper", PAPER)])
def test_scores_are_as_they_were(made: Made, name: str, words: tuple[str, ...]) -> None:
    """What two logs score does not change unnoticed."""
    out = made("evaluate", BAG, MCAP, *words)

    for table in ("auc", "clusters", "presses"):
        assert_golden(out / "evaluate" / f"{table}.csv", f"evaluate-{name}-{table}.csv")


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_the_same_run_gives_the_same_bytes(made: Made, tmp_path: Path, jobs: int) -> None:
    """Neither the day nor the number of threads can be seen in the results."""
    before = bytes_of(made("evaluate", BAG, MCAP, *PAPER) / "evaluate")

    done("evaluate", BAG, MCAP, *PAPER, "-o", tmp_path / "again", "--jobs", jobs)

    assert bytes_of(tmp_path / "again" / "evaluate") == before


@pytest.mark.slow
def test_another_seed_hardly_moves_the_area(made: Made, tmp_path: Path) -> None:
    """The seed draws jitter, trees and resamples; it is named, and the area stays."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    done("evaluate", "--seed", "7", "-o", out)

    before, after = evaluated(made("evaluate", BAG), "auc")[0], evaluated(out, "auc")[0]
    assert record_of(out / "evaluate")["seed"] == 7
    assert float(after["auc"]) == pytest.approx(float(before["auc"]), abs=0.02)
    assert after["auc_low"] != before["auc_low"]
