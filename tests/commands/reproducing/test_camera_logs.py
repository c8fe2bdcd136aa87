"""Logs of the camera experiments."""

from pathlib import Path

from mpap_cli.commands.reproducing.camera_logs import named_places, repeats, with_camera
from tests.commands.reproducing.camera_benches import A, short_bench
from tests.commands.running import BAG


def test_logs_without_images_are_passed_over(tmp_path: Path) -> None:
    """A place whose logs hold scans only is not there for the camera."""
    bench = short_bench(tmp_path, indoor=(str(BAG), A), outdoor=(str(BAG),))

    places = named_places(bench)

    assert [(place.name, len(place.logs)) for place in places] == [("Indoor", 1)]
    assert with_camera([str(BAG)]) == ()


def test_camera_runs_are_repeated_less_often(tmp_path: Path) -> None:
    """A short bench has one repeat."""
    assert list(repeats(short_bench(tmp_path, seed=4))) == [4]
