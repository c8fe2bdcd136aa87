"""Camera images with probabilities on their patches and the action below."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.observations import BoolArray, Float64Array
from mpap_cli.outputs.action_signs import ACTION_SIGNS
from mpap_cli.outputs.annotated import MOST_ON_SHEET, annotate, write_annotated_sheet
from mpap_cli.outputs.canvas import Image, probability_color

VERMILION = probability_color(1.0)
GREEN = (115, 158, 0)
STRIP = 52
CAMERA = np.full((480, 640, 3), (90, 120, 60), dtype=np.uint8)


def grid(p: float = 0.0, *, unknown: bool = False) -> tuple[Float64Array, BoolArray]:
    """Return probabilities and unknown flags of 6 x 6 patches that are all alike."""
    return np.full((6, 6), p), np.full((6, 6), unknown)


def count(image: Image, color: tuple[int, int, int]) -> int:
    """Return how many pixels have a color, the strip left out."""
    return int((image[:-STRIP] == color).all(axis=2).sum())


def test_obstacle_is_framed_in_its_own_patch() -> None:
    """The frame lies inside of the patch that the grid says, row by row from the top left."""
    p, unknown = grid()
    p[2, 5] = 0.9

    drawn = annotate(CAMERA, p, unknown, "straight", 0.5)

    rows, columns = np.nonzero((drawn[:-STRIP] == VERMILION).all(axis=2))
    assert (rows.min(), rows.max()) == (160, 238)
    assert (columns.min(), columns.max()) == (532, 636)


def test_free_and_obstacle_are_told_by_the_threshold() -> None:
    """From the threshold on a patch is an obstacle."""
    p, unknown = grid(0.2)

    below = annotate(CAMERA, p, unknown, "straight", 0.21)
    at = annotate(CAMERA, p, unknown, "straight", 0.2)

    assert count(below, VERMILION) == 0
    assert count(below, GREEN) > 1000
    assert count(at, GREEN) == 0
    assert count(at, VERMILION) > 2000


@pytest.mark.parametrize("p", [0.0, 1.0])
def test_unknown_is_neither_free_nor_obstacle(p: float) -> None:
    """An unknown patch is hatched grey, whatever its probability."""
    drawn = annotate(CAMERA, *grid(p, unknown=True), "stop", 0.5)

    assert count(drawn, GREEN) == 0
    assert count(drawn, VERMILION) == 0
    assert count(drawn, (235, 235, 235)) > 1000


def test_kinds_differ_without_color() -> None:
    """In shades of grey a free, an obstacle and an unknown patch still look different."""
    kinds = [grid(0.4), grid(0.4), grid(0.4, unknown=True)]
    thresholds = (0.5, 0.3, 0.5)

    greys = [
        cv2.cvtColor(annotate(CAMERA, *kind, "stop", at)[:-STRIP], cv2.COLOR_BGR2GRAY)
        for kind, at in zip(kinds, thresholds, strict=True)
    ]

    untouched = int(cv2.cvtColor(CAMERA, cv2.COLOR_BGR2GRAY)[0, 0])
    shares = [float((np.abs(grey.astype(int) - untouched) > 3).mean()) for grey in greys]
    free, obstacle, unknown = shares
    assert free < 0.15 < unknown < 0.5
    assert obstacle > 0.9


def test_model_without_labels_draws_a_plain_grid() -> None:
    """Where no probability is known, patches are neither free nor obstacles."""
    drawn = annotate(CAMERA, *grid(np.nan), "stop", 0.5)

    assert count(drawn, GREEN) == 0
    assert count(drawn, VERMILION) == 0
    assert count(drawn, (140, 140, 140)) > 1000


@pytest.mark.parametrize(
    ("height", "width", "expected"),
    [
        (240, 320, (480, 640)),
        (720, 1280, (720, 1280)),
        (1440, 2560, (720, 1280)),
        (1, 1, (640, 640)),
    ],
)
def test_images_of_any_size_become_readable(
    height: int, width: int, expected: tuple[int, int]
) -> None:
    """Small images are enlarged, huge ones reduced, proportions kept, a strip below."""
    image = np.zeros((height, width, 3), dtype=np.uint8)

    drawn = annotate(image, *grid(), "straight", 0.5)

    assert drawn.shape == (expected[0] + STRIP, expected[1], 3)


@pytest.mark.parametrize("shape", [(3, 3), (12, 12), (1, 40), (2, 5)])
def test_grids_of_any_shape_are_drawn(shape: tuple[int, int]) -> None:
    """Every patch of the grid has its frame."""
    drawn = annotate(CAMERA, np.zeros(shape), np.zeros(shape, dtype=np.bool_), "straight", 0.5)

    middle = (480 // shape[0]) // 2 + (480 % shape[0]) // 2
    edges = np.diff((drawn[middle] == GREEN).all(axis=1).astype(int)) == 1
    assert int(edges.sum()) >= 2 * shape[1] - 1


def test_flat_image_has_room_for_no_number() -> None:
    """An image lower than its grid is drawn all the same."""
    flat = np.zeros((2, 640, 3), dtype=np.uint8)

    drawn = annotate(flat, *grid(unknown=True), "straight", 0.5)

    assert drawn.shape == (2 + STRIP, 640, 3)


def test_every_action_has_its_own_sign() -> None:
    """The strip below the image differs from action to action."""
    strips = [annotate(CAMERA, *grid(), action, 0.5)[-STRIP:] for action in ACTION_SIGNS]

    signs = {strip[:, :60].tobytes() for strip in strips}
    assert len(signs) == len(ACTION_SIGNS) == 4


def test_left_is_right_in_a_mirror() -> None:
    """The two turns are drawn alike, to their own sides."""
    left = annotate(CAMERA, *grid(), "rotate-left", 0.5)[-STRIP:, :61]
    right = annotate(CAMERA, *grid(), "rotate-right", 0.5)[-STRIP:, :61]

    difference = np.abs(left.astype(int) - right[:, ::-1])
    assert difference.max() < 16


def test_input_is_untouched() -> None:
    """The image and the arrays stay as they were; the result shares no memory with them."""
    image, (p, unknown) = CAMERA.copy(), grid(0.7)

    drawn = annotate(image, p, unknown, "straight", 0.5)

    assert (image == CAMERA).all()
    assert (p == 0.7).all()
    assert not np.shares_memory(drawn, image)


def test_same_input_same_pixels() -> None:
    """Nothing that is kept between two calls changes the second."""
    first = annotate(CAMERA, *grid(0.3, unknown=True), "stop", 0.5)
    second = annotate(CAMERA, *grid(0.3, unknown=True), "stop", 0.5)

    assert first.tobytes() == second.tobytes()


def test_wrong_shape_or_action_is_a_bug() -> None:
    """Grids of different shapes and unheard-of actions are refused."""
    p, unknown = grid()

    with pytest.raises(ValueError, match="expected one grid"):
        annotate(CAMERA, p, unknown[:3], "straight", 0.5)
    with pytest.raises(ValueError, match="action: found fly, expected one of straight"):
        annotate(CAMERA, p, unknown, "fly", 0.5)


@pytest.mark.parametrize("n_images", [0, 1, 5, MOST_ON_SHEET, MOST_ON_SHEET + 1])
def test_sheet_holds_up_to_24_images(tmp_path: Path, n_images: int) -> None:
    """Rows of four; of more than 24 images as many are shown, first and last among them."""
    image = annotate(CAMERA, *grid(), "straight", 0.5)
    write_annotated_sheet(tmp_path / "a.png", [(image, "day1.bag  1.0 s")] * n_images)

    sheet = cv2.imread(str(tmp_path / "a.png"))

    assert sheet is not None
    row = round(460 * image.shape[0] / image.shape[1]) + 50
    assert sheet.shape[0] == 64 + -(-min(n_images, 24) // 4) * row


def test_sheet_spreads_over_all_images(tmp_path: Path) -> None:
    """The last of many images is on the sheet, in its last place."""
    images = [(np.full((30, 40, 3), value, dtype=np.uint8), "") for value in range(100)]

    write_annotated_sheet(tmp_path / "a.png", images)

    sheet = cv2.imread(str(tmp_path / "a.png"))
    assert sheet is not None
    assert (sheet == 99).all(axis=2).sum() > 10_000
    assert (sheet == 0).all(axis=2).sum() > 10_000


def test_same_sheet_same_bytes(tmp_path: Path) -> None:
    """Long captions are cut; the file is the same each time."""
    images = [(CAMERA, "a" * 300), (CAMERA[:, :200], "day2.bag")]

    write_annotated_sheet(tmp_path / "a.png", images)
    write_annotated_sheet(tmp_path / "b.png", images)

    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_unwritable_sheet_is_an_os_error(tmp_path: Path) -> None:
    """A sheet that cannot be written does not pass in silence."""
    with pytest.raises(FileNotFoundError):
        write_annotated_sheet(tmp_path / "gone" / "a.png", [])
