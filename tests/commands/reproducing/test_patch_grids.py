"""9 to 144 patches an image."""

from pathlib import Path

import pytest

from mpap_cli.commands.reproducing import patch_grids
from mpap_cli.commands.reproducing.patch_grids import _settings
from tests.commands.reproducing.camera_benches import ours, short_bench


def test_free_rows_are_as_deep_whatever_the_grid(tmp_path: Path) -> None:
    """Two thirds of the rows ahead, one third beside them."""
    bench = short_bench(tmp_path)

    pairs = [set(_settings(bench, shape).pairs) for shape in ((3, 6), (6, 6), (12, 12))]

    assert {"grid=3x6", "front-rows=2", "side-rows=1"} <= pairs[0]
    assert {"front-rows=4", "side-rows=2"} <= pairs[1]
    assert {"front-rows=8", "side-rows=4"} <= pairs[2]


@pytest.mark.slow
def test_coarse_and_fine_grids_tell_obstacles(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nine patches and 72: an area above chance, more exemplars where patches are small."""
    monkeypatch.setattr(patch_grids, "GRIDS", ((3, 3), (6, 12)))
    bench = short_bench(tmp_path)

    patch_grids.run(bench)

    coarse, fine = "9 (3x3)", "72 (6x12)"
    for row in (coarse, fine):
        auc = ours(bench, "9 to 144 patches", row, "AUC")
        assert auc is not None
        assert auc > 0.6
    few, many = (ours(bench, "9 to 144 patches", row, "exemplars") for row in (coarse, fine))
    assert few is not None
    assert many is not None
    assert few < many
