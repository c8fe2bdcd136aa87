"""Labels of patches around presses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.observations import NS_PER_S, Float64Array, IntArray, Press
from mpap_cli.params import ObstacleParams
from mpap_cli.properties.obstacle_labels import (
    floor_patches,
    label_patches,
    pressed_images,
)

TENTH_NS = NS_PER_S // 10
FLOOR = {
    (6, 6): (range(3, 6), range(1, 5)),
    (4, 12): (range(2, 4), range(2, 10)),
    (5, 3): (range(2, 5), range(1, 2)),
    (1, 1): (range(1), range(1)),
    (2, 2): (range(1, 2), range(2)),
}


@st.composite
def drives(draw: st.DrawFn) -> tuple[IntArray, tuple[Press, ...], Float64Array]:
    """Images and presses on a grid of tenths of a second, so that many limits are met."""
    gaps = draw(st.lists(st.sampled_from([0, 1, 2, 3, 10]), max_size=25))
    stamps_ns = np.cumsum(np.array(gaps, dtype=np.int64)) * TENTH_NS
    at, presses = 0, list[Press]()
    held = draw(st.booleans())
    for gap, length in draw(
        st.lists(st.tuples(st.integers(1, 40), st.integers(1, 19)), max_size=4)
    ):
        start = at + gap
        at = start + length
        presses.append(Press(start * TENTH_NS, at * TENTH_NS, held and not presses))
    driven = draw(
        st.lists(
            st.sampled_from([0.0, 0.1, 1.0, float("nan")]),
            min_size=stamps_ns.size,
            max_size=stamps_ns.size,
        )
    )
    return stamps_ns, tuple(presses), np.array(driven, dtype=np.float64)


def press_of(stamps_ns: IntArray, index: int, presses: tuple[Press, ...]) -> int:
    """Return the start of the press of one image as the definition says."""
    stamp = stamps_ns[index]
    for press in presses:
        if press.start_ns <= stamp < press.end_ns:
            return press.start_ns
    for press in presses:
        gaps = np.abs(stamps_ns - press.start_ns)
        if gaps.min() <= 2 * TENTH_NS and index == int(gaps.argmin()):
            return press.start_ns
    return -1


def is_driven(
    stamp_ns: int, presses: tuple[Press, ...], driven_m: float, farthest_m: float
) -> bool:
    """Whether the floor of an image is driven over, with the limits of the defaults."""
    for press in presses:
        since = -(10**18) if press.held_from_start else press.start_ns
        soon = stamp_ns < since <= stamp_ns + 20 * TENTH_NS
        lately = since <= stamp_ns < press.end_ns + 25 * TENTH_NS
        if soon or lately:
            return False
    return not driven_m < max(0.1, 0.5 * farthest_m)


@given(drives(), st.sampled_from(["driven", "plain"]), st.booleans())
def test_labels_equal_those_of_the_definition(
    drive: tuple[IntArray, tuple[Press, ...], Float64Array], rule: str, odometry: bool
) -> None:
    """Image by image, patch by patch."""
    stamps_ns, presses, driven_m = drive
    params = ObstacleParams(obstacle_labels=rule, label_rows="1:3")
    floor = [r * 6 + c for r in FLOOR[6, 6][0] for c in FLOOR[6, 6][1]]

    labels = label_patches(stamps_ns, presses, params, (6, 6), driven_m if odometry else None)

    wanted = np.full((stamps_ns.size, 36), -1)
    for index, stamp_ns in enumerate(stamps_ns.tolist()):
        moved = driven_m[index] if odometry else np.nan
        so_far = [way for way in driven_m[: index + 1].tolist() if odometry and way == way]  # noqa: PLR0124  # NaN
        start_ns = press_of(stamps_ns, index, presses)
        if start_ns >= 0:
            late = rule == "driven" and stamp_ns >= start_ns + NS_PER_S
            wanted[index, 6:18] = -1 if late else 1
        elif rule == "plain":
            wanted[index] = 0
        elif is_driven(stamp_ns, presses, moved, max([0.0, *so_far])):
            wanted[index, floor] = 0
    assert labels.dtype == np.int8
    assert labels.tolist() == wanted.tolist()


@given(drives())
def test_an_image_is_of_the_press_of_the_definition(
    drive: tuple[IntArray, tuple[Press, ...], Float64Array],
) -> None:
    """During a press it is of that press, near its start only the nearest one is."""
    stamps_ns, presses, _ = drive

    found = pressed_images(stamps_ns, presses, 0.2)

    assert found.tolist() == [
        press_of(stamps_ns, index, presses) for index in range(stamps_ns.size)
    ]


@pytest.mark.parametrize("shape", list(FLOOR))
def test_the_floor_is_the_lower_middle_of_any_grid(shape: tuple[int, int]) -> None:
    """Of 6 x 6 patches it is rows 4 to 6 and columns 2 to 5, counted from 1."""
    floor = floor_patches(shape)

    rows, columns = FLOOR[shape]
    assert np.argwhere(floor).tolist() == [[row, column] for row in rows for column in columns]


def test_labels_leave_their_input_alone() -> None:
    """Nothing is written into the stamps or the distances."""
    stamps_ns, driven_m = np.arange(5, dtype=np.int64) * NS_PER_S, np.zeros(5)
    stamps_ns.flags.writeable = driven_m.flags.writeable = False

    labels = label_patches(stamps_ns, [Press(1, 2)], ObstacleParams(), (2, 2), driven_m)

    assert labels.shape == (5, 4)
