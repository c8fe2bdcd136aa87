"""Pictures of clusters of image patches."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.outputs.canvas import Image, probability_color
from mpap_cli.outputs.patch_pictures import PatchCluster, write_members, write_patch_exemplars

GREEN = (20, 200, 20)
PINK = (180, 20, 230)
WRITERS = (write_patch_exemplars, write_members)

Writer = Callable[[Path, Sequence[PatchCluster]], None]


def patch(color: tuple[int, int, int], height: int = 40, width: int = 53) -> Image:
    """Return a patch of one color."""
    return np.full((height, width, 3), color, dtype=np.uint8)


def cluster(number: int, p: float | None, n_members: int = 3) -> PatchCluster:
    """Return a cluster with a green exemplar and pink members."""
    return PatchCluster(
        cluster=number,
        p_obstacle=p,
        observations=1200,
        presses=4,
        exemplar=patch(GREEN),
        members=(patch(PINK),) * n_members,
    )


def drawn(path: Path) -> Image:
    """Read a picture back."""
    image = cv2.imread(str(path))
    assert image is not None
    return np.asarray(image, dtype=np.uint8)


def share(image: Image, color: tuple[int, int, int]) -> float:
    """Return the share of pixels of a color."""
    return float((image == color).all(axis=2).mean())


@pytest.mark.parametrize("write", WRITERS)
def test_same_clusters_same_bytes(tmp_path: Path, write: Writer) -> None:
    """The order in which clusters are given does not matter, nor the time of day."""
    clusters = [cluster(0, 0.1), cluster(1, 0.9), cluster(2, None), cluster(3, 0.1)]

    write(tmp_path / "a.png", clusters)
    write(tmp_path / "b.png", clusters[::-1])

    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_most_likely_obstacle_is_the_first_tile(tmp_path: Path) -> None:
    """The first tile is framed in the color of the highest probability."""
    write_patch_exemplars(tmp_path / "a.png", [cluster(0, 0.0), cluster(1, 1.0)])

    tiles = drawn(tmp_path / "a.png")[100:]
    middle = 26 + 200 + 11
    assert share(tiles[:, :middle], probability_color(1.0)) > 0.02
    assert share(tiles[:, :middle], probability_color(0.0)) == 0.0
    assert share(tiles[:, middle:], probability_color(0.0)) > 0.002


def test_exemplars_show_no_members(tmp_path: Path) -> None:
    """A tile holds the exemplar alone, enlarged."""
    write_patch_exemplars(tmp_path / "a.png", [cluster(0, 0.5)])

    image = drawn(tmp_path / "a.png")
    assert share(image, GREEN) * image.shape[0] * image.shape[1] > 190 * 140
    assert share(image, PINK) == 0.0


def test_row_has_its_exemplar_then_at_most_twelve_members(tmp_path: Path) -> None:
    """Members stand to the right of the exemplar; more than twelve change nothing."""
    write_members(tmp_path / "12.png", [cluster(0, 0.5, 12)])
    write_members(tmp_path / "40.png", [cluster(0, 0.5, 40)])

    image = drawn(tmp_path / "12.png")
    pink = np.flatnonzero((image == PINK).all(axis=2).any(axis=0))
    green = np.flatnonzero((image == GREEN).all(axis=2).any(axis=0))
    assert green.max() < pink.min()
    assert pink.size == 12 * 106
    assert (tmp_path / "12.png").read_bytes() == (tmp_path / "40.png").read_bytes()


@pytest.mark.parametrize("write", WRITERS)
def test_many_clusters_fit_on_a_page(tmp_path: Path, write: Callable[..., None]) -> None:
    """Beyond the limit a line replaces the clusters, with or without labels."""
    known = [cluster(k, k / 40) for k in range(40)]
    unknown = [cluster(k, None) for k in range(40)]

    write(tmp_path / "12.png", known[:12], limit=12)
    write(tmp_path / "40.png", known, limit=12)
    write(tmp_path / "none.png", unknown, limit=12)

    height = drawn(tmp_path / "12.png").shape[0]
    assert drawn(tmp_path / "40.png").shape[0] == height + 34
    assert drawn(tmp_path / "none.png").shape[0] == height + 34


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize(("height", "width"), [(1, 1), (3, 500), (500, 3), (240, 320)])
def test_patches_of_any_size_are_drawn(
    tmp_path: Path, write: Writer, height: int, width: int
) -> None:
    """A patch may be one pixel or an image; its proportions are kept."""
    image = patch(GREEN, height, width)
    one = PatchCluster(
        cluster=0, p_obstacle=0.5, observations=1, presses=1, exemplar=image, members=(image,)
    )

    write(tmp_path / "a.png", [one])

    assert share(drawn(tmp_path / "a.png"), GREEN) > 0.0
    assert (image == GREEN).all()


@pytest.mark.parametrize("write", WRITERS)
def test_cluster_without_pictures_keeps_its_place(tmp_path: Path, write: Writer) -> None:
    """Where no image can be read any more, the numbers are drawn all the same."""
    bare = PatchCluster(cluster=0, p_obstacle=0.9, observations=1, presses=0, exemplar=None)

    write(tmp_path / "a.png", [bare])

    assert share(drawn(tmp_path / "a.png"), probability_color(0.9)) > 0.0


@pytest.mark.parametrize("write", WRITERS)
def test_no_cluster_is_a_picture_too(tmp_path: Path, write: Writer) -> None:
    """A model without clusters has a page that says so."""
    write(tmp_path / "a.png", [])

    assert drawn(tmp_path / "a.png").min() < 100


@pytest.mark.parametrize("write", WRITERS)
def test_unwritable_place_is_an_os_error(tmp_path: Path, write: Writer) -> None:
    """A picture that cannot be written does not pass in silence."""
    with pytest.raises(FileNotFoundError):
        write(tmp_path / "gone" / "a.png", [])


def test_pictures_need_no_plotting_library() -> None:
    """Learning draws its patches without matplotlib."""
    source = Path(sys.modules[write_members.__module__].__file__ or "").parent

    for name in ("patch_pictures.py", "probabilities.py", "annotated.py", "action_signs.py"):
        assert "matplotlib" not in (source / name).read_text()


def test_a_note_takes_the_place_of_probabilities(tmp_path: Path) -> None:
    """Clusters that are known otherwise have no key of probabilities and no presses."""
    noted = PatchCluster(
        cluster=0,
        p_obstacle=None,
        observations=12,
        presses=None,
        exemplar=patch(GREEN),
        note="90 % lawn",
    )
    other = PatchCluster(
        cluster=0, p_obstacle=None, observations=12, presses=0, exemplar=patch(GREEN)
    )

    write_members(tmp_path / "noted.png", [noted])
    write_members(tmp_path / "other.png", [other])

    head = [drawn(tmp_path / f"{name}.png")[50:90] for name in ("noted", "other")]
    assert (head[0] == 255).all()
    assert not (head[1] == 255).all()
