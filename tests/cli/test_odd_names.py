"""Logs with odd names: what is written about them can be copied to any system."""

import re
from pathlib import Path

import pytest

from tests.cli.conftest import Run, WriteScans

SAFE = re.compile(r"[\w-][\w.-]*[\w-]", re.ASCII)
ODD = ('day:1 "what?"*|<>.bag', "NUL.bag", "fünf Räder.bag", "x" * 200 + ".bag")


@pytest.mark.slow
def test_every_file_about_an_odd_log_has_a_safe_name(
    run: Run, write_scans: WriteScans, tmp_path: Path
) -> None:
    """Segments and predictions of each log; none is lost to another of the same name."""
    logs = [write_scans(name, pressed="near") for name in ODD]
    out = tmp_path / "out"

    learnt = run("learn", *logs, "-o", out)
    predicted = run("predict", out, *logs, "--to-mcap", "-o", out)
    cut = run("extract", *logs, "--presses", "--split", "--lookback", 1, "--post", 1, "-o", out)

    names = {path.name for path in out.rglob("*")}
    assert (learnt.code, predicted.code, cut.code) == (0, 0, 0)
    assert [name for name in names if not SAFE.fullmatch(name) or len(name) > 120] == []
    assert len(list((out / "predict").glob("*.mcap"))) == len(ODD)
    assert len({path.name[0] for path in (out / "extract").glob("*.bag")}) == len(ODD)
