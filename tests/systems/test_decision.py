"""From patches to a motion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.observations import BoolArray
from mpap_cli.params import ObstacleParams
from mpap_cli.systems.decision import ACTIONS, Decider


def decide(grids: list[list[str]], front_rows: int = 3) -> list[str]:
    """Decide on grids drawn with # (obstacle) and . (free)."""
    params = ObstacleParams(front_rows=front_rows)
    rows, columns = len(grids[0]), len(grids[0][0])
    cells = np.array([list("".join(grid)) for grid in grids])
    actions = Decider(params, (rows, columns)).decide((cells == "#") * 0.9, cells == "")
    return [ACTIONS[action] for action in actions]


@pytest.mark.parametrize(
    ("grid", "action"),
    [
        (["######", "######", "######", "......", "......", "......"], "straight"),
        (["......", "......", "......", "..#...", "......", "......"], "rotate-right"),
        (["......", "......", "......", "......", "...#..", "......"], "rotate-left"),
        (["......", ".#....", "......", "......", "......", "......"], "straight"),
        (["......", "......", "......", ".#....", "......", "......"], "straight"),
        (["......", "......", "......", "......", ".#....", "......"], "rotate-right"),
        (["......", "......", "......", "......", "......", "######"], "stop"),
        (["......", "......", "......", "......", "......", "#####."], "rotate-right"),
        (["......", "......", "......", "......", "..##..", "......"], "rotate-left"),
    ],
)
def test_the_robot_goes_where_it_is_free(grid: list[str], action: str) -> None:
    """Straight on over three free patches, two beside them, else to the freer half, or it stops."""
    assert decide([grid]) == [action]


def test_between_equal_halves_it_keeps_on_rotating_the_same_way() -> None:
    """Going straight or stopping in between makes it forget nothing."""
    right, equal = ["##..", "##.."], ["....", "####"]
    blocked, free = ["####", "...."], ["....", "...."]

    actions = decide([blocked, right, blocked, free, equal, blocked], front_rows=2)

    assert actions == [
        "rotate-left", "rotate-right", "rotate-right", "straight", "stop", "rotate-right",
    ]  # fmt: skip


@pytest.mark.parametrize(("unknown", "action"), [("free", "straight"), ("obstacle", "stop")])
def test_what_an_unknown_patch_is_can_be_chosen(unknown: str, action: str) -> None:
    """It is explored by bumping, or avoided; its probability does not matter."""
    params = ObstacleParams(unknown=unknown)
    everything = np.ones((1, 36))

    (found,) = Decider(params, (6, 6)).decide(everything, everything == 1)

    assert ACTIONS[found] == action


def test_a_small_grid_needs_no_more_rows_than_it_has() -> None:
    """Else it could never go straight."""
    assert decide([["...", "..."]]) == ["straight"]
    assert decide([[".#.", "..."]]) == ["rotate-left"]


def test_without_labels_all_is_free() -> None:
    """A probability that is not known is no obstacle."""
    nothing = np.full((2, 36), np.nan)

    actions = Decider(ObstacleParams(), (6, 6)).decide(nothing, np.zeros((2, 36), dtype=np.bool_))

    assert actions.tolist() == [0, 0]


def reference(obstacles: BoolArray, front_rows: int) -> list[int]:
    """Decide image by image as the definition says."""
    direction, actions = 1, []
    _, rows, columns = obstacles.shape
    for grid in obstacles:
        depth = []
        for column in range(columns):
            free = 0
            while free < rows and not grid[rows - 1 - free, column]:
                free += 1
            depth.append(free)
        middle = {columns // 2, (columns - 1) // 2}
        half = columns // 2
        left, right = sum(depth[:half]), sum(depth[columns - half :])
        beside = {column + step for column in middle for step in (-1, 0, 1)} & set(range(columns))
        is_wide = min(depth[column] for column in beside) >= min(2, rows)
        if is_wide and min(depth[column] for column in middle) >= min(front_rows, rows):
            actions.append(0)
        elif max(depth) == 0:
            actions.append(3)
        else:
            if left != right:
                direction = 1 if left > right else 2
            actions.append(direction)
    return actions


@given(
    st.integers(0, 40), st.integers(1, 4), st.integers(1, 5), st.integers(0, 999), st.integers(1, 9)
)
def test_decisions_equal_those_made_one_by_one(
    n: int, rows: int, columns: int, seed: int, block: int
) -> None:
    """On grids of every shape, however the images are cut into blocks."""
    random = np.random.default_rng(seed)
    p = random.choice([0.0, 0.5, 1.0], size=(n, rows, columns), p=[0.6, 0.2, 0.2])
    decider = Decider(ObstacleParams(front_rows=2), (rows, columns))
    unknown = np.zeros((n, rows * columns), dtype=np.bool_)

    parts = [
        decider.decide(p[at : at + block].reshape(-1, rows * columns), unknown[at : at + block])
        for at in range(0, n, block)
    ]

    assert [action for part in parts for action in part.tolist()] == reference(p >= 0.5, 2)
