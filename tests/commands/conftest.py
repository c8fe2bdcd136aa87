"""Results that many tests read and none changes: each is made once."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.commands.running import BAG, MCAP, done

Made = Callable[..., Path]


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Return a function that runs a command once for all tests; only read what it returns."""
    folders: dict[tuple[object, ...], Path] = {}

    def run(*words: object) -> Path:
        if words not in folders:
            out = tmp_path_factory.mktemp("made")
            done(*words, "-o", out)
            folders[words] = out
        return folders[words]

    return run


@pytest.fixture
def learnt(made: Made, tmp_path: Path) -> Path:
    """Return a results folder of one's own, with two logs of one flat learnt."""
    return Path(shutil.copytree(made("learn", BAG, MCAP), tmp_path / "learnt"))
