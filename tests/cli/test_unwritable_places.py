"""Disks that are full or read-only, for the page, for merging and for simulated logs."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.cli.disks import small_disk, tree

LOG = Path(__file__).parents[2] / "fixtures" / "indoor-a.bag"
OTHER = LOG.with_name("indoor-a2.mcap")
MERGE = ("learn", "--merge", str(LOG), str(OTHER), "--jobs", "1", "--end")

Run = Callable[..., Any]


@pytest.fixture(scope="module")
def merged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an OUT that holds leaves and what was merged of them."""
    from mpap_cli.cli.main import main  # noqa: PLC0415  # once for all tests

    out = tmp_path_factory.mktemp("merged") / "out"
    with pytest.raises(SystemExit, match="0"):
        main([*MERGE, "40", "-o", str(out), "-q"])
    return out


@pytest.mark.parametrize("n_bytes", [200, 2500])
@pytest.mark.parametrize("end", ["40", "41"])
def test_merging_on_a_disk_that_fills_up_loses_nothing(
    tmp_path: Path, run: Run, merged: Path, end: str, n_bytes: int
) -> None:
    """With leaves that are there and with new ones; of these the manifest may tell."""
    out = tmp_path / "out"
    shutil.copytree(merged, out)
    before = tree(out)

    with small_disk(n_bytes):
        outcome = run(*MERGE, end, "-o", out)

    assert outcome.code == 1
    assert "cannot be written (file too large)" in outcome.err
    assert outcome.err.splitlines()[-1].startswith("mpap: ")
    assert "Traceback" not in outcome.err
    after = tree(out)
    assert after.keys() == before.keys()
    changed = {name for name in before if after[name] != before[name]}
    assert changed <= ({"leaves/manifest.csv"} if (end, n_bytes) == ("41", 2500) else set())


def test_merging_on_a_full_disk_is_one_line(
    run: Run, mount: Callable[[str], Path], merged: Path
) -> None:
    """Nothing stays where not even the manifest fits; a read-only disk is named too."""
    disk = mount("size=4k")

    full = run(*MERGE, "40", "-o", disk / "out")
    left = list(disk.iterdir())
    mount("remount,size=4m")
    shutil.copytree(merged, disk / "out")
    mount("remount,ro")
    refused = run(*MERGE, "40", "-o", disk / "out")

    assert full.code == refused.code == 1
    assert "cannot be written (no space left on device)" in full.err.splitlines()[-1]
    assert left == []
    assert f"{disk}/out/learn: cannot be written (read-only" in refused.err.splitlines()[-1]


def test_a_page_that_does_not_fit_is_a_warning(
    tmp_path: Path, run: Run, mount: Callable[[str], Path], merged: Path
) -> None:
    """The results stay, the older page too, and no temporary file."""
    out, disk = tmp_path / "out", mount("size=24k")
    shutil.copytree(merged, out)
    before = tree(out)
    line = ("similar", merged, "--at", f"{LOG}@12.5")

    with small_disk(8000):
        small = run(*line, "-o", out)
    full = run(*line, "-o", disk / "out")

    assert small.code == full.code == 0
    assert f"{out}/report.html: cannot be written (file too large)" in small.err
    assert f"{disk}/out/report.html: cannot be written (no space left on device)" in full.err
    after, written = tree(out), {"similar/settings.json", "similar/similar.csv"}
    assert after.keys() == before.keys() | written
    assert after["report.html"] == before["report.html"]
    assert tree(disk / "out").keys() == written
    assert {path.name for path in (disk / "out").iterdir()} == {"similar"}


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", "folder"])
@pytest.mark.parametrize("disk", ["200", "2500", "12000", "full", "read-only"])
def test_a_simulated_log_that_does_not_fit_leaves_nothing(
    tmp_path: Path, run: Run, request: pytest.FixtureRequest, name: str, disk: str
) -> None:
    """Neither log nor truth stay; one line names the log."""
    line = ["--camera", "--image-size", "64x64", "--camera-hz", "2", "--duration", "3"]
    place = tmp_path / "place"
    place.mkdir()
    limit = int(disk) if disk.isdigit() else 1 << 30
    if not disk.isdigit():
        mount = request.getfixturevalue("mount")
        place = mount("size=12k" if disk == "full" else "ro")

    with small_disk(limit):
        outcome = run("simulate", place / name, *line)

    found = {"full": "no space left on device|database or disk is full", "read-only": "read-only"}
    assert outcome.code == 1
    assert re.fullmatch(
        rf"mpap: {place}/.*cannot be written \(.*({found.get(disk, 'file too large|disk')}).*\).*",
        outcome.err.splitlines()[-1],
    )
    assert list(place.iterdir()) == []
