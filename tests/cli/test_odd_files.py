"""Pipes, devices and sockets in place of files: one line, and nobody waits for them."""

import os
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

LOG = Path(__file__).parents[2] / "fixtures" / "indoor-a.bag"
WORDS: dict[str, Callable[[Path], list[object]]] = {
    "log": lambda odd: ["info", odd],
    "model": lambda odd: ["predict", odd, LOG],
    "merged": lambda odd: ["merge", odd],
    "config": lambda odd: ["learn", LOG, "--config", odd],
    "presses": lambda odd: ["learn", LOG, "--bump-from", odd],
    "truth": lambda odd: ["evaluate", LOG, "--truth", odd],
    "groups": lambda odd: ["evaluate", LOG, "--groups", odd],
    "definitions": lambda odd: ["learn", LOG, "--msgs", odd],
    "patches": lambda odd: ["cluster", odd],
}


@pytest.fixture(params=["pipe", "device", "socket"])
def odd(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Return something that never ends, or that nothing can be read of."""
    path = tmp_path / "odd.csv"
    if request.param == "pipe":
        os.mkfifo(path)
    elif request.param == "device":
        path.symlink_to("/dev/zero")
    else:
        with socket.socket(socket.AF_UNIX) as one:
            one.bind(os.path.relpath(path))
    return path


@pytest.mark.parametrize("place", WORDS)
def test_what_is_no_file_is_one_line(
    run: Callable[..., Any], tmp_path: Path, odd: Path, place: str
) -> None:
    """It is named, and nothing is written."""
    words = WORDS[place](odd)
    out = [] if words[0] == "info" else ["-o", tmp_path / "out"]

    outcome = run(*words, *out)

    assert outcome.code in {1, 2}
    assert "odd.csv" in outcome.err.splitlines()[-1]
    assert "Traceback" not in outcome.err
    assert not (tmp_path / "out").exists()
