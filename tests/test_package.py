"""Wheel and sdist hold what they should, and the wheel works without the checkout."""

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
RUN = """
import sys, mpap_cli
from mpap_cli.cli.main import main
assert mpap_cli.__file__.startswith(sys.argv[1]), mpap_cli.__file__
main(sys.argv[2:])
"""


def build(source: Path, folder: Path, kind: str) -> Path:
    """Build a wheel or an sdist out of a source tree."""
    words = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(folder)]
    subprocess.run(words, cwd=source, check=True, capture_output=True)  # noqa: S603
    (built,) = folder.iterdir()
    return built


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a wheel of the checkout."""
    return build(ROOT, tmp_path_factory.mktemp("wheel"), "wheel")


def files_of(wheel: Path) -> set[str]:
    """Return what a wheel holds of the package."""
    with zipfile.ZipFile(wheel) as archive:
        return {name for name in archive.namelist() if name.startswith("mpap_cli/")}


@pytest.mark.slow
def test_wheel_holds_the_package_whole(wheel: Path) -> None:
    """Every file under version control that lies in the package, and nothing else."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "mpap_cli"],  # noqa: S607
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()

    assert files_of(wheel) == {name for name in listed if (ROOT / name).is_file()}


@pytest.mark.slow
def test_wheel_works_alone(wheel: Path, tmp_path: Path) -> None:
    """Unpacked anywhere it learns, and draws the report; definitions and templates are there."""
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)  # noqa: S202  # what this test built
    log = ROOT / "fixtures" / "indoor-json.mcap"
    words = [sys.executable, "-P", "-c", RUN, str(site), "learn", str(log), "--out", "out"]

    done = subprocess.run(  # noqa: S603  # what this test unpacked
        words,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.returncode == 0, done.stderr
    assert "5 presses" in done.stdout
    assert (tmp_path / "out" / "report.html").stat().st_size > 20_000


@pytest.mark.slow
def test_sdist_builds_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    """What is published as source is enough to build, test and look things up."""
    sdist = build(ROOT, tmp_path / "sdist", "sdist")
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path / "source", filter="data")
    (source,) = (tmp_path / "source").iterdir()

    again = build(source, tmp_path / "again", "wheel")

    assert files_of(again) == files_of(wheel)
    assert {"tests", "fixtures", "docs", "README.md", "LICENSE", "CHANGELOG.md"} <= {
        path.name for path in source.iterdir()
    }
