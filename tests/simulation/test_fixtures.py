"""The fixture logs are what the simulator makes."""

import importlib.util
import shutil
from pathlib import Path
from types import ModuleType

import pytest

FOLDER = Path(__file__).parents[2] / "fixtures"


def load_script() -> ModuleType:
    """Import fixtures/make.py, which is no part of a package."""
    spec = importlib.util.spec_from_file_location("make_fixtures", FOLDER / "make.py")
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script


@pytest.mark.slow
def test_fixtures_are_what_the_simulator_makes() -> None:
    """Stamps, bumper messages and the truth equal exactly, ranges on a grid of 1 mm."""
    lines = load_script().check(FOLDER)

    assert lines == []


def test_fixtures_stay_small() -> None:
    """No fixture is larger than 300 kB, all together are below 3 MB."""
    script = load_script()

    sizes = [
        sum(file.stat().st_size for file in (path, *path.rglob("*")) if file.is_file())
        for path in (FOLDER / name for name in script.FIXTURES)
    ]

    assert max(sizes) < 300_000
    assert sum(sizes) < 3_000_000


def test_changed_fixture_is_named(tmp_path: Path) -> None:
    """A log that differs, or is missing, is named with what differs."""
    script = load_script()
    name, other = "outdoor.mcap", "indoor-a2.mcap"
    for source, target in ((name, "a"), (other, "b")):
        (tmp_path / target).mkdir()
        shutil.copy(FOLDER / source, tmp_path / target / name)
        shutil.copy(FOLDER / f"{name}.truth.csv", tmp_path / target)
    fresh = tmp_path / "a" / name

    same = script.difference(FOLDER / name, fresh)
    changed = script.difference(tmp_path / "b" / name, fresh)
    missing = script.difference(tmp_path / name, fresh)
    (tmp_path / "a" / f"{name}.truth.csv").write_text("edited\n")
    edited = script.difference(fresh, FOLDER / name)

    assert same == ""
    assert changed == "outdoor.mcap: topics, stamps or bumper messages differ"
    assert "outdoor.mcap" in missing
    assert edited == "outdoor.mcap: the truth differs"
