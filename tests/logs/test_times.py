"""Moments as typed after ``--start`` and ``--end``."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import SettingError
from mpap_cli.logs.replay import parse_time

START_NS = 1_707_300_900_000_000_000


@pytest.mark.parametrize(
    ("text", "offset_ns"),
    [
        ("0", 0),
        ("12.5", 12_500_000_000),
        (" +10s ", 10_000_000_000),
        (".25", 250_000_000),
        ("3.", 3_000_000_000),
        ("0.000000001", 1),
        ("1:30", 90_000_000_000),
        ("1:30.5", 90_500_000_000),
        ("1:02:03", 3_723_000_000_000),
        ("90:00", 5_400_000_000_000),
    ],
)
def test_offsets_count_from_the_start_of_the_log(text: str, offset_ns: int) -> None:
    """Seconds, minutes and hours are exact to the nanosecond."""
    assert parse_time(text, START_NS) == START_NS + offset_ns


@pytest.mark.parametrize(
    ("text", "stamp_ns"),
    [
        ("2024-02-07T10:15:00Z", START_NS),
        ("2024-02-07 10:15:00z", START_NS),
        ("2024-02-07t11:15:00+01:00", START_NS),
        ("2024-02-07T10:15:00.123456789Z", START_NS + 123_456_789),
        ("2024-02-07T10:15:00.1234567891Z", START_NS + 123_456_789),
        ("1707300900000000000", START_NS),
        ("1969-12-31T23:59:59.5Z", -500_000_000),
    ],
)
def test_absolute_times_do_not_depend_on_the_log(text: str, stamp_ns: int) -> None:
    """RFC 3339 and nanoseconds are absolute, to the nanosecond."""
    assert parse_time(text, 5) == stamp_ns


@pytest.mark.parametrize(
    "text",
    [
        *("", "-5", "soon", "1:2:3:4", "1:", ":30", "1.5:30", "10m", "nan", "1e3"),
        *("2024-02-07", "2024-02-07T10:15:00", "2024-02-30T10:15:00Z", "2024-02-07T25:15:00Z"),
        *("1707300900", "12345678901234567890"),
    ],
)
def test_other_texts_are_no_times(text: str) -> None:
    """The error lists what would do; a time without zone or seconds since 1970 would not."""
    with pytest.raises(SettingError, match="seconds into the log"):
        parse_time(text, START_NS)


@given(st.text(alphabet="0123456789:.+-TZs ", max_size=25))
def test_any_text_is_a_time_or_a_setting_error(text: str) -> None:
    """No text leads to another error."""
    with contextlib.suppress(SettingError):
        assert isinstance(parse_time(text, 0), int)
