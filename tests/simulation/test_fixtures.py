"""The fixture logs are what the simulator makes."""

import dataclasses
import importlib.util
import shutil
from pathlib import Path
from types import ModuleType

import pytest

from mpap_cli.simulation.settings import CameraParams, SimulationParams

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
    """Stamps, bumper messages, contacts equal exactly, ranges on a grid of 1 mm, images nearly."""
    lines = load_script().check(FOLDER)

    assert lines == []


def test_fixtures_stay_small() -> None:
    """No fixture is larger than 300 kB, with images 1 MB; all together are below 5 MB."""
    script = load_script()

    sizes = {
        name: sum(
            file.stat().st_size
            for file in (FOLDER / name, *(FOLDER / name).rglob("*"))
            if file.is_file()
        )
        for name in script.FIXTURES
    }

    for name, size in sizes.items():
        assert size < (1_000_000 if "camera" in script.FIXTURES[name] else 300_000)
    assert sum(sizes.values()) < 5_000_000


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


def test_changed_images_are_named(tmp_path: Path) -> None:
    """Images of other surfaces, or other shares in their truth, are a difference."""
    script = load_script()
    name = "camera-a.mcap"
    lens = CameraParams(size="64x64", hz=1.0)
    for folder, textures in (("a", "a"), ("b", "b")):
        (tmp_path / folder).mkdir()
        camera = dataclasses.replace(lens, textures=textures)
        params = SimulationParams(duration_s=5, camera=camera)
        script.simulate(tmp_path / folder / name, params)
    first, second = (tmp_path / folder / name for folder in "ab")

    same = script.difference(first, first)
    changed = script.difference(first, second)
    patches = first.with_name(f"{name}.patches.csv")
    shutil.copytree(tmp_path / "a", tmp_path / "c")
    patches.write_text(patches.read_text().replace("1.0000", "0.9000", 1))
    edited = script.difference(first, tmp_path / "c" / name)
    patches.unlink()
    missing = script.difference(first, tmp_path / "c" / name)

    assert same == ""
    assert changed == f"{name}: images differ"
    assert edited == f"{name}: the truth differs"
    assert missing == edited
