"""A run that is killed at any moment loses nothing and stands in nobody's way."""

from pathlib import Path

import pytest

from benchmarks.kills import kill_often


@pytest.mark.slow
def test_results_are_whole_after_every_kill(tmp_path: Path) -> None:
    """Each folder holds older or new results, never mixed, and the next run works."""
    kills = list(kill_often(tmp_path, ("learn", "merge", "predict"), n_kills=6, seed=1))

    assert [kill.complaints for kill in kills] == [()] * 6
    assert {kill.results for kill in kills} <= {"older", "new"}
