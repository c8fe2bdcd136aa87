"""Settings: checks, texts and profiles."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import SettingError
from mpap_cli.params import (
    PROFILES,
    ScanParams,
    make_settings,
    parse_preference,
    setting_fields,
    settings_values,
)


@pytest.mark.parametrize("profile", PROFILES)
def test_settings_survive_as_texts(profile: str) -> None:
    """Settings written as texts and read again are the same settings."""
    settings = make_settings(profile)

    again = make_settings(profile, settings_values(settings))

    assert again == settings


def test_profiles_name_existing_settings() -> None:
    """Every key of a profile is a setting."""
    keys = set(setting_fields())

    named = {key for values in PROFILES.values() for key in values}

    assert named <= keys


def test_profile_paper_is_the_papers_model() -> None:
    """Profile paper counts all pressed scans and reads the nearest exemplar's cluster."""
    paper = make_settings("paper")

    assert paper.properties.readout == "exemplar"
    assert paper.properties.learn_target == "contact"
    assert paper.affinity.preference == "median"
    assert (paper.meta_point.theta, paper.meta_point.min_points) == (0.10, 5)
    assert not paper.scan.keep_scale


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("theta", "0", "a distance above 0"),
        ("theta", "wide", "expected float"),
        ("theta", "nan", "a distance above 0"),
        ("min-points", "0", "1 or more"),
        ("max-iter", "10001", "1 to 10,000"),
        ("convergence-iter", "1001", "1 to 1,000"),
        ("folds", "1001", "2 to 1,000"),
        ("bump-ignore", "(a|a)", "joined by"),
        ("bump-ignore", "floor|a*a*a*!", "two of"),
        ("bump-ignore", "x" * 501, "words joined"),
        ("damping", "0.4", "0.5 up to below 1"),
        ("damping", "1", "0.5 up to below 1"),
        ("preference", "quantile:2", "quantile:0..1"),
        ("preference", "most", "quantile:0..1"),
        ("feature", "median-value", "one of min-value"),
        ("keep-scale", "yes", "true or false"),
        ("fov", "400", "at most 360 wide"),
        ("fov", "90,-90", "at most 360 wide"),
        ("forward", "left", "360, or tf"),
        ("near-floor-m", "2", "below near-cap-m"),
        ("noise-ttl", "0", "more than 0"),
        ("no-such", "1", "no such setting"),
        ("theta", "1e308", "a distance above 0"),
        ("onset-s", "1e30", "at most 1e"),
        ("bump-merge", "inf", "at most 1e"),
        ("noise-ttl", "1e300", "at most 1e"),
        ("seed", "9999999999", "0 to 4294967295"),
        ("min-points", "1000000000000000000000", "1 or more"),
        ("resamples", "1000000000000", "10 to 100,000"),
        ("preference", "1e308", "quantile:0..1"),
        ("max-range", "1e308", "at most 1e"),
        ("forward", "1e300", "from -360 to 360"),
    ],
)
def test_a_wrong_value_is_named_with_what_was_expected(key: str, value: str, expected: str) -> None:
    """A wrong setting is refused by key, with what would fit."""
    with pytest.raises(SettingError, match=expected) as caught:
        make_settings("robust", {key: value})

    assert str(caught.value).startswith(f"setting {key}: ")


def test_an_unknown_profile_is_refused() -> None:
    """A profile that does not exist is refused with the list of those that do."""
    with pytest.raises(SettingError, match="expected one of robust, paper"):
        make_settings("best")


def test_a_setting_may_be_emptied() -> None:
    """The text none empties a setting that may be empty."""
    settings = make_settings("robust", {"max-range": "none"})

    assert settings.scan.max_range is None


@given(st.floats(0, 1), st.sampled_from(["quantile", "range"]))
def test_preference_rules_keep_their_number(number: float, name: str) -> None:
    """A rule with a number is read back exactly."""
    assert parse_preference(f"{name}:{number!r}") == (name, number)


@given(st.floats(-360, 359), st.floats(0.1, 360))
def test_field_of_view_keeps_its_edges(start: float, width: float) -> None:
    """FROM,TO gives both edges, whatever they are."""
    end = min(start + width, start + 359)

    edges = ScanParams(fov=f"{start!r},{end!r}").fov_degrees()

    assert edges == (start, end)
