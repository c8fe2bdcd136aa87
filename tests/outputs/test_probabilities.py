"""Ranking clusters and drawing their probabilities."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.outputs.canvas import Box, blank, probability_color
from mpap_cli.outputs.probabilities import divide, draw_bar, draw_key, left_out_text, rank


@given(n=st.integers(0, 60), limit=st.integers(1, 20))
def test_every_cluster_is_drawn_or_left_out(n: int, limit: int) -> None:
    """Nothing is lost or doubled, no more than the limit is drawn, the order stays."""
    ranked = list(range(n))

    shown, left_out = divide(ranked, limit)

    assert len(shown) == min(n, limit)
    assert sorted(shown + left_out) == ranked
    assert shown == sorted(shown)


def test_clusters_without_labels_come_last() -> None:
    """None and NaN rank below zero."""
    assert rank(None) == rank(math.nan) < rank(0.0) < rank(1.0)


def test_left_out_clusters_without_labels_have_no_span() -> None:
    """Where one has no probability, none is named."""
    assert left_out_text([0.4, None]) == "and 2 more, in clusters.csv"


def test_bar_is_as_long_as_its_probability() -> None:
    """Half a probability fills half of the bar; NaN draws nothing."""
    page = blank(100, 20)
    empty = blank(100, 20)

    draw_bar(page, Box(0, 5, 100, 10), 0.5)
    draw_bar(empty, Box(0, 5, 100, 10), math.nan)

    assert (page[10, :49] == probability_color(0.5)).all()
    assert not (page[10, 52:] == probability_color(0.5)).all(axis=1).any()
    assert (empty == 255).all()


def test_key_runs_from_zero_to_one() -> None:
    """The colors of the key are those of the probabilities, from left to right."""
    page = blank(400, 40)

    draw_key(page, "obstacle", 390, 24)

    row = page[18, 230:370]
    expected = [probability_color(step / 139) for step in range(140)]
    np.testing.assert_array_equal(row, expected)
