"""Moments of a log, as typed after ``--start`` and ``--end``."""

import re
from datetime import UTC, datetime, timedelta
from decimal import Decimal

from mpap_cli.errors import SettingError
from mpap_cli.observations import NS_PER_S

_OFFSET = re.compile(r"\+?(?:(?:(?P<h>\d+):(?=\d+:))?(?P<m>\d+):)?(?P<s>\d+(?:\.\d*)?|\.\d+)\s*s?")
_RFC_3339 = re.compile(
    r"(?P<moment>\d{4}-\d\d-\d\d[Tt ]\d\d:\d\d:\d\d)(?:\.(?P<part>\d+))?"
    r"(?P<zone>[Zz]|[+-]\d\d:\d\d)"
)
_MIN_NS_DIGITS = 13  # as an offset in seconds that would be 30,000 years
_MAX_OFFSET_DIGITS = 9
_MINUTES, _HOURS = 60, 3600
_FIRST_DATE_NS = 365 * 24 * 3600 * NS_PER_S  # no robot ran in 1970
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def is_date(stamp_ns: int) -> bool:
    """Tell a date from a time that counts from the start of a simulation or of the robot.

    >>> is_date(1_518_607_201_000_000_000), is_date(7_200_000_000_000)
    (True, False)
    """
    return stamp_ns >= _FIRST_DATE_NS


def parse_time(text: str, log_start_ns: int) -> int:
    """Turn an offset or an absolute time into a stamp.

    Parameters
    ----------
    text : str
        An offset into the log (``12.5``, ``+10s``, ``1:30``, ``1:02:03``), a time as in
        RFC 3339 (``2024-02-07T10:15:00Z``), or nanoseconds since 1970 (13 digits or more).
    log_start_ns : int
        Stamp of the first message of the log.

    Returns
    -------
    int
        Nanoseconds.

    Raises
    ------
    SettingError
        If the text is none of these.

    Examples
    --------
    >>> parse_time("1:30", 1_000)
    90000001000
    >>> parse_time("1970-01-01T00:00:01.5Z", 1_000)
    1500000000
    >>> parse_time("1518607201000000000", 1_000)
    1518607201000000000
    """
    word = text.strip()
    if re.fullmatch(rf"\d{{{_MIN_NS_DIGITS},19}}", word):
        return int(word)
    if match := _OFFSET.fullmatch(word):
        hours, minutes, seconds = match["h"] or "0", match["m"] or "0", match["s"]
        whole = int(hours) * _HOURS + int(minutes) * _MINUTES
        if max(map(len, (hours, minutes, seconds.split(".")[0]))) <= _MAX_OFFSET_DIGITS:
            return log_start_ns + int((whole + Decimal(seconds)) * NS_PER_S)
    if (match := _RFC_3339.fullmatch(word)) and (moment := _moment(match)) is not None:
        return moment
    msg = (
        f"time {text}: expected seconds into the log (12.5, 1:30, 1:02:03), a time with its zone "
        "(2024-02-07T10:15:00Z) or nanoseconds since 1970"
    )
    raise SettingError(msg)


def _moment(match: re.Match[str]) -> int | None:
    """Turn a time of RFC 3339 into nanoseconds; None if there is no such day or hour."""
    zone = match["zone"].upper().replace("Z", "+00:00")
    try:
        moment = datetime.fromisoformat(match["moment"].upper().replace(" ", "T") + zone)
    except ValueError:
        return None
    seconds = (moment - _EPOCH) // timedelta(seconds=1)
    part = (match["part"] or "")[:9].ljust(9, "0")
    return seconds * NS_PER_S + int(part)
