"""Cleaning of beams: every habit of drivers, and the options that go against them."""

import math

import numpy as np
import pytest

from mpap_cli.errors import UsageError
from mpap_cli.features.scans.scan_cleaning import clean_ranges, range_limits
from mpap_cli.observations import ScanGeometry
from mpap_cli.params import ScanParams

GEOMETRY = ScanGeometry(1, 0.0, 0.1, 0.05, 8.0)
CODES = {
    "valid": 3.0,
    "below range_min": 0.01,
    "zero": 0.0,
    "negative": -2.0,
    "nan": math.nan,
    "inf": math.inf,
    "-inf": -math.inf,
    "above range_max": 81.83,
}
NO_RETURN = ["zero", "negative", "nan", "inf", "above range_max"]
TOO_NEAR = ["below range_min", "-inf"]


def clean_one(beam: float, params: ScanParams, geometry: ScanGeometry = GEOMETRY) -> float:
    """Return the cleaned range of a single beam."""
    cleaned = clean_ranges(np.array([[beam]], np.float32), range_limits(geometry, params))
    return float(cleaned[0, 0])


@pytest.mark.parametrize("code", NO_RETURN)
def test_a_beam_without_return_reads_range_max(code: str) -> None:
    """All ways of writing "nothing in range" become range_max."""
    assert clean_one(CODES[code], ScanParams()) == 8.0


@pytest.mark.parametrize("code", TOO_NEAR)
def test_a_beam_too_near_reads_range_min(code: str) -> None:
    """Minus infinity and ranges below range_min become range_min."""
    assert clean_one(CODES[code], ScanParams()) == pytest.approx(0.05)


@pytest.mark.parametrize("beam", [0.05, 3.0, 8.0])
def test_valid_ranges_stay(beam: float) -> None:
    """Ranges from range_min to range_max, both included, are kept."""
    assert clean_one(beam, ScanParams()) == np.float32(beam)


@pytest.mark.parametrize("code", TOO_NEAR)
def test_near_far_makes_too_near_a_beam_without_return(code: str) -> None:
    """Under near=far a scanner reports nothing in its blind zone."""
    assert clean_one(CODES[code], ScanParams(near="far")) == 8.0


def test_zero_near_makes_zero_too_near() -> None:
    """Under zero=near a range of 0 reads range_min, and with near=far no return."""
    assert clean_one(0.0, ScanParams(zero="near")) == pytest.approx(0.05)
    assert clean_one(0.0, ScanParams(zero="near", near="far")) == 8.0


@pytest.mark.parametrize("code", NO_RETURN)
def test_drop_marks_beams_without_return(code: str) -> None:
    """Under no_return=drop these beams are left out; others are not."""
    params = ScanParams(no_return="drop")

    assert clean_one(CODES[code], params) == -1
    assert clean_one(CODES["-inf"], params) == pytest.approx(0.05)
    assert clean_one(CODES["-inf"], ScanParams(no_return="drop", near="far")) == -1


def test_max_range_caps_returns_and_missing_returns() -> None:
    """A cap below range_max holds for all; a return above it is not left out by drop."""
    assert clean_one(3.0, ScanParams(max_range=2.0)) == 2.0
    assert clean_one(math.inf, ScanParams(max_range=2.0)) == 2.0
    assert clean_one(3.0, ScanParams(max_range=2.0, no_return="drop")) == 2.0
    assert clean_one(9.0, ScanParams(max_range=2.0, no_return="drop")) == -1


def test_max_range_above_range_max_lets_more_in() -> None:
    """A max_range above the message's says how far the scanner really sees."""
    assert clean_one(9.0, ScanParams(max_range=10.0)) == 9.0


@pytest.mark.parametrize("unusable", [0.0, 0.05, -1.0, math.inf, math.nan])
def test_an_unusable_range_max_is_replaced(unusable: float) -> None:
    """The survey's maximum stands in, or else max_range; without both it is an error."""
    geometry = ScanGeometry(1, 0.0, 0.1, 0.05, unusable)

    assert range_limits(geometry, ScanParams(), 6.0).cap == 6.0
    assert range_limits(geometry, ScanParams(max_range=4.0)).cap == 4.0
    with pytest.raises(UsageError, match=r"range_max of the scans: found .*--max-range METRES"):
        range_limits(geometry, ScanParams())


def test_a_usable_range_max_is_kept() -> None:
    """The survey's maximum does not replace a usable one."""
    assert range_limits(GEOMETRY, ScanParams(), 6.0).cap == 8.0


@pytest.mark.parametrize("range_min", [-1.0, 0.0, math.nan, math.inf])
def test_an_unusable_range_min_counts_as_zero(range_min: float) -> None:
    """Without a range_min nothing is too near, and minus infinity reads 0."""
    geometry = ScanGeometry(1, 0.0, 0.1, range_min, 8.0)

    assert clean_one(0.001, ScanParams(), geometry) == np.float32(0.001)
    assert clean_one(-math.inf, ScanParams(), geometry) == 0.0


def test_ranges_are_cleaned_row_by_row_into_an_array_of_their_own() -> None:
    """Each row is cleaned like the next; what was given stays."""
    ranges = np.array([list(CODES.values())] * 3, np.float32)
    before = ranges.copy()

    cleaned = clean_ranges(ranges, range_limits(GEOMETRY, ScanParams()))

    row = [clean_one(beam, ScanParams()) for beam in CODES.values()]
    assert cleaned.tolist() == [row] * 3
    np.testing.assert_array_equal(ranges, before)
