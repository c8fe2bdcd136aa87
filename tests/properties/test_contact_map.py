"""The map from onsets to contacts rises and fits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.properties.contact_map import SMALLEST_SLOPE, ContactMap, fit_contact_map

P = st.floats(1e-6, 1 - 1e-6)


def test_the_fit_finds_the_map_that_made_the_counts() -> None:
    """With many labels the prior does not matter."""
    made = ContactMap(1.7, 0.8)
    onset = np.linspace(0.02, 0.9, 40)
    positive = np.round(made.apply(onset) * 100_000).astype(np.int64)
    counts = np.stack([100_000 - positive, positive], axis=1)

    fitted = fit_contact_map(onset, counts)

    assert (fitted.slope, fitted.offset) == pytest.approx((1.7, 0.8), abs=0.01)


@given(st.lists(st.tuples(P, st.integers(0, 50), st.integers(0, 50)), min_size=1, max_size=20))
def test_the_map_rises_whatever_the_counts(rows: list[tuple[float, int, int]]) -> None:
    """It cannot turn the order of two observations, nor blow up."""
    table = np.array(rows)

    fitted = fit_contact_map(table[:, 0], table[:, 1:].astype(np.int64))

    assert fitted.slope >= SMALLEST_SLOPE
    assert np.isfinite([fitted.slope, fitted.offset]).all()
    grid = fitted.apply(np.array([0.1, 0.3, 0.5, 0.7]))
    assert (np.diff(grid) > 0).all()


def test_probabilities_against_the_contacts_keep_the_smallest_slope() -> None:
    """The offset then carries the base rate."""
    onset, counts = np.array([0.1, 0.9]), np.array([[100, 900], [900, 100]])

    fitted = fit_contact_map(onset, counts)

    assert fitted.slope == SMALLEST_SLOPE
    assert fitted.apply(onset).mean() == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("counts", [[[5, 0], [7, 0]], [[0, 5], [0, 7]], [[0, 0], [0, 0]]])
def test_one_kind_of_labels_changes_nothing(counts: list[list[int]]) -> None:
    """There is nothing to fit."""
    assert fit_contact_map(np.array([0.2, 0.4]), np.array(counts)) == ContactMap()


def test_certainty_and_absence_pass_through() -> None:
    """0, 1 and NaN stay; the input is not written to."""
    given_p = np.array([0.0, np.nan, 1.0, 0.5])
    given_p.flags.writeable = False

    mapped = ContactMap(2.0, 1.0).apply(given_p)

    assert mapped[[0, 2]].tolist() == [0.0, 1.0]
    assert np.isnan(mapped[1])
    assert mapped[3] == pytest.approx(1 / (1 + np.exp(-1.0)))
