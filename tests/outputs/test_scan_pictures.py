"""Pictures of exemplar scans."""

import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.observations import ScanGeometry
from mpap_cli.outputs.canvas import probability_color, shorten, text_width
from mpap_cli.outputs.scan_pictures import ExemplarPicture, write_exemplars
from mpap_cli.outputs.scan_views import common_scale, half_view, range_ticks, runs_of, see

AROUND = ScanGeometry(361, -np.pi, np.pi / 180, 0.1, 5.0)
AHEAD = ScanGeometry(181, -np.pi / 2, np.pi / 180, 0.1, 8.0)


def exemplar(
    cluster: int,
    p: float | None,
    geometry: ScanGeometry = AROUND,
    image: "np.ndarray[tuple[int, int, int], np.dtype[np.uint8]] | None" = None,
) -> ExemplarPicture:
    """Make an exemplar in front of a wall."""
    ranges = np.linspace(0.5, 4.0, geometry.n_beams, dtype=np.float32)
    ranges[10:40] = np.inf
    return ExemplarPicture(
        cluster=cluster,
        p_collision=p,
        p_low=None if p is None else p / 2,
        p_high=None if p is None else (1 + p) / 2,
        observations=1200,
        first_seen_s=3.5,
        log="day1.bag",
        time_s=12.25,
        ranges=ranges,
        geometry=geometry,
        forward_rad=0.0,
        image=image,
    )


def drawn(path: Path) -> "np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]":
    """Read a picture back."""
    image = cv2.imread(str(path))
    assert image is not None
    return np.asarray(image, dtype=np.uint8)


def has_color(path: Path, color: tuple[int, int, int], fewest: int = 200) -> bool:
    """Tell whether a picture holds pixels of this color."""
    return int((drawn(path) == color).all(axis=2).sum()) >= fewest


def test_forward_is_zero_and_left_is_positive() -> None:
    """Angles count from the direction of travel, ascending, a half turn at most."""
    ranges = np.zeros(4)
    ranges[1] = 2.0
    geometry = ScanGeometry(4, 0.0, np.pi / 2, 0.1, 5.0)

    scan = see(ranges, geometry, np.pi, None)

    np.testing.assert_allclose(scan.angles, [-90, 0, 90, 180], atol=1e-9)
    np.testing.assert_array_equal(scan.ranges, [2.0, np.nan, np.nan, np.nan])


def test_what_came_back_is_told_from_what_did_not() -> None:
    """0, NaN, infinity and ranges outside of the limits are no return."""
    ranges = np.array([0.0, np.nan, np.inf, -1.0, 0.05, 1.0, 5.0, 4.0])
    geometry = ScanGeometry(8, 0.0, 0.1, 0.1, 5.0)

    scan = see(ranges, geometry, 0.0, None)
    shorter = see(ranges, geometry, 0.0, 3.0)

    np.testing.assert_array_equal(np.flatnonzero(scan.returned), [5, 7])
    np.testing.assert_array_equal(np.flatnonzero(shorter.returned), [5])


def test_views_share_one_scale() -> None:
    """All scans are drawn to one range and one width; no return at all has a scale too."""
    scans = [see(np.full(361, r), AROUND, 0.0, None) for r in (0.4, 2.6)]

    assert common_scale(scans) == 3.0
    assert common_scale([see(np.zeros(361), AROUND, 0.0, None)]) == 1.0
    assert common_scale([see(np.full(9, 500.0), AROUND, 0.0, 900.0)]) == 100.0
    assert half_view(scans) == 180.0
    assert half_view([see(np.ones(181), AHEAD, 0.0, None)]) == 90.0


@pytest.mark.parametrize(
    "top_m", [0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 30.0, 50.0, 100.0]
)
def test_ticks_are_few_and_end_in_reach(top_m: float) -> None:
    """Every scale has two to five labels."""
    ticks = range_ticks(top_m)

    assert 2 <= len(ticks) <= 5
    assert 0 < ticks[0] <= ticks[-1] <= top_m


def test_runs_of_nothing_are_none() -> None:
    """No beam came back: nothing is drawn."""
    assert runs_of(np.zeros(5, dtype=np.bool_)) == []


def test_same_exemplars_same_bytes(tmp_path: Path) -> None:
    """The order in which clusters are given does not matter, nor the time of day."""
    exemplars = [exemplar(0, 0.1), exemplar(1, 0.9), exemplar(2, None)]

    write_exemplars(tmp_path / "a.png", exemplars)
    write_exemplars(tmp_path / "b.png", exemplars[::-1])

    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_most_dangerous_comes_first(tmp_path: Path) -> None:
    """The first card has the color of the highest probability."""
    write_exemplars(tmp_path / "a.png", [exemplar(0, 0.0), exemplar(1, 1.0)])

    image = drawn(tmp_path / "a.png")[110:]
    middle = image.shape[1] // 2
    left = (image[:, :middle] == probability_color(1.0)).all(axis=2).sum()
    right = (image[:, middle:] == probability_color(0.0)).all(axis=2).sum()
    assert min(left, right) > 200


def test_image_of_the_moment_is_pasted(tmp_path: Path) -> None:
    """With an image the page is wider and shows it, whatever its size."""
    green = np.zeros((30, 500, 3), dtype=np.uint8)
    green[:] = (0, 255, 0)
    write_exemplars(tmp_path / "a.png", [exemplar(0, 0.5), exemplar(1, 0.5)])
    write_exemplars(tmp_path / "b.png", [exemplar(0, 0.5, image=green), exemplar(1, 0.5)])

    assert drawn(tmp_path / "b.png").shape[1] > drawn(tmp_path / "a.png").shape[1]
    assert has_color(tmp_path / "b.png", (0, 255, 0), 5000)
    assert not has_color(tmp_path / "a.png", (0, 255, 0), 1)


def test_many_clusters_fit_on_a_page(tmp_path: Path) -> None:
    """Beyond the limit a line replaces the cards, with or without labels."""
    known = [exemplar(k, k / 40) for k in range(40)]
    unknown = [exemplar(k, None) for k in range(40)]

    write_exemplars(tmp_path / "12.png", known[:12], limit=12)
    write_exemplars(tmp_path / "40.png", known, limit=12)
    write_exemplars(tmp_path / "none.png", unknown, limit=12)

    height = drawn(tmp_path / "12.png").shape[0]
    assert drawn(tmp_path / "40.png").shape[0] == height + 34
    assert drawn(tmp_path / "none.png").shape[0] == height + 34


@pytest.mark.parametrize("geometry", [AROUND, AHEAD, ScanGeometry(1, 0.0, 0.0, 0.1, 5.0)])
def test_every_kind_of_scan_is_drawn(tmp_path: Path, geometry: ScanGeometry) -> None:
    """A scanner may look around, ahead or along one beam, and see nothing at all."""
    one = exemplar(0, 0.5, geometry)
    one.ranges[:] = np.inf if geometry.n_beams == 361 else 1.0

    write_exemplars(tmp_path / "a.png", [one])

    assert drawn(tmp_path / "a.png").shape[0] > 300


def test_no_cluster_is_a_picture_too(tmp_path: Path) -> None:
    """A model without clusters has a page that says so."""
    write_exemplars(tmp_path / "a.png", [])

    assert drawn(tmp_path / "a.png").min() < 100


def test_unwritable_place_is_an_os_error(tmp_path: Path) -> None:
    """A picture that cannot be written does not pass in silence."""
    with pytest.raises(FileNotFoundError):
        write_exemplars(tmp_path / "gone" / "a.png", [])


def test_long_names_are_cut_in_the_middle() -> None:
    """A long name keeps its beginning and its end."""
    short = shorten("a" * 100 + ".bag", 200, 0.5)

    assert text_width(short, 0.5) <= 200
    assert short.startswith("aaa")
    assert short.endswith(".bag")
    assert shorten("day1.bag", 200, 0.5) == "day1.bag"


def test_colors_run_from_blue_to_vermilion() -> None:
    """The ends are Okabe and Ito's blue and vermilion, as BGR."""
    assert probability_color(0.0) == (178, 114, 0)
    assert probability_color(1.0) == (0, 94, 213)


def test_pictures_need_no_plotting_library() -> None:
    """Learning draws its exemplars without matplotlib."""
    source = Path(sys.modules[write_exemplars.__module__].__file__ or "").parent

    for name in ("scan_pictures.py", "scan_views.py", "canvas.py"):
        assert "matplotlib" not in (source / name).read_text()
