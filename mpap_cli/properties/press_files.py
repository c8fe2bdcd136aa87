"""Presses written by hand: ``--bump-from FILE.csv`` and ``--truth FILE.csv``."""

import csv
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from pathlib import Path, PurePath

from mpap_cli.errors import LogError, UsageError
from mpap_cli.observations import NS_PER_S, Press

PRESS_COLUMNS = ("log", "start_s", "end_s")
_HELD_NS = NS_PER_S
_MOST_DIGITS = 9
_MOST_SHOWN = 200


@dataclass(frozen=True, slots=True)
class PressRow:
    """One row of a file of presses; times count from the first message of the log."""

    log_index: int | None
    start_ns: int
    end_ns: int
    place: str


def presses_from_csv(path: Path) -> dict[str, tuple[PressRow, ...]]:
    """Read a table of presses, for example an edited ``presses.csv``.

    Parameters
    ----------
    path : Path
        CSV in UTF-8 with the columns log, start_s, end_s and, where several logs bear
        one name, log_index; other columns are not looked at. A log may be named with
        its folder; only its base name counts.

    Returns
    -------
    dict of str to tuple of PressRow
        Rows by base name of the log, in the order of the file. A log that was never
        pressed has no row.

    Raises
    ------
    LogError
        If the file cannot be read.
    UsageError
        If it is no such table: the file, the line, what was found, what was expected.
    """
    rows: dict[str, list[PressRow]] = {}
    try:
        if path.exists() and not path.is_file():
            msg = f"{path}: no file; give a CSV with log,start_s,end_s"
            raise LogError(msg)
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file, restval="", strict=True)
            _check_columns(path, reader.fieldnames or ())
            for record in reader:
                name = PurePath(record["log"].strip()).name
                row = _press_row(record, f"{path.name} line {reader.line_num}")
                rows.setdefault(name, []).append(row)
    except OSError as err:
        msg = f"{path}: {err.strerror or err}; give a CSV with log,start_s,end_s"
        raise LogError(msg) from err
    except (UnicodeDecodeError, csv.Error) as err:
        msg = f"{path.name}: not a CSV file in UTF-8 ({err}); expected log,start_s,end_s"
        raise UsageError(msg) from err
    return {name: tuple(found) for name, found in rows.items()}


def _check_columns(path: Path, found: Collection[str]) -> None:
    missing = [column for column in PRESS_COLUMNS if column not in found]
    if missing:
        named = ", ".join(found)[:_MOST_SHOWN] or "no column"
        lacks = f"no {', '.join(missing)} among {named}"
        msg = f"{path.name} line 1: {lacks}; expected log,start_s,end_s"
        raise UsageError(msg)


def _press_row(record: Mapping[str, str], place: str) -> PressRow:
    """Check one record of the table."""
    if not record["log"].strip():
        msg = f"{place}: log is empty; name the log of the press"
        raise UsageError(msg)
    start_ns = _stamp(record["start_s"], "start_s", place)
    end_ns = _stamp(record["end_s"], "end_s", place)
    if end_ns <= start_ns:
        found = f"end_s {record['end_s'].strip()} is not after start_s {record['start_s'].strip()}"
        msg = f"{place}: {found}; a press ends after it starts"
        raise UsageError(msg)
    text = (record.get("log_index") or "").strip()
    if text and not (text.isascii() and text.isdigit() and len(text) <= _MOST_DIGITS):
        msg = f"{place}: log_index is {text[:_MOST_SHOWN]!r}; expected a whole number from 0"
        raise UsageError(msg)
    return PressRow(int(text) if text else None, start_ns, end_ns, place)


def _stamp(text: str, column: str, place: str) -> int:
    """Turn seconds into exact nanoseconds; a float would lose some in a long log."""
    try:
        seconds = Decimal(text.strip())
    except InvalidOperation:
        seconds = Decimal("NaN")
    if not (seconds.is_finite() and 0 <= seconds < NS_PER_S):
        wanted = "seconds since the log's first message"
        msg = f"{place}: {column} is {text.strip()[:_MOST_SHOWN]!r}; expected {wanted}"
        raise UsageError(msg)
    return round(seconds * NS_PER_S)


def presses_of_log(
    rows: Iterable[PressRow], log_index: int, start_ns: int, end_ns: int
) -> tuple[Press, ...]:
    """Turn the rows of one log into presses.

    Parameters
    ----------
    rows : iterable of PressRow
        Rows under the log's name; those with another ``log_index`` are left out.
    log_index : int
        Place of the log in the order given.
    start_ns, end_ns : int
        Stamps of the log's first and last message.

    Returns
    -------
    tuple of Press
        In time order; presses that overlap are one. A press that lasts beyond the last
        message ends one nanosecond after it and is not released. One that begins within
        the first second is held from the start: bumpers report that late, and the table
        has no column that would tell such a press from an onset.

    Raises
    ------
    UsageError
        If a press begins after the end of the log.

    Examples
    --------
    >>> rows = [PressRow(None, 340_000_000, 900_000_000, "hits.csv line 2")]
    >>> presses_of_log(rows, 0, 0, 5_000_000_000)
    (Press(start_ns=340000000, end_ns=900000000, held_from_start=True, released=True),)
    """
    presses: list[Press] = []
    mine = [row for row in rows if row.log_index in (None, log_index)]
    for row in sorted(mine, key=lambda row: (row.start_ns, row.end_ns)):
        first_ns = start_ns + row.start_ns
        if first_ns > end_ns:
            lasts, at = (end_ns - start_ns) / NS_PER_S, row.start_ns / NS_PER_S
            msg = f"{row.place}: the press begins at {at:g} s, but the log lasts {lasts:g} s"
            raise UsageError(msg)
        after_ns = start_ns + row.end_ns
        if presses and first_ns < presses[-1].end_ns:
            last = presses.pop()
            first_ns, after_ns = last.start_ns, max(after_ns, last.end_ns)
        released = after_ns <= end_ns
        held = not presses and first_ns - start_ns <= _HELD_NS
        presses.append(Press(first_ns, min(after_ns, end_ns + 1), held, released))
    return tuple(presses)


def rows_of_logs(
    rows: Mapping[str, tuple[PressRow, ...]], names: Sequence[str], option: str
) -> dict[str, tuple[PressRow, ...]]:
    """Return the rows for the logs given, in whatever order those are now.

    Parameters
    ----------
    rows : mapping of str to tuple of PressRow
        From :func:`presses_from_csv`.
    names : sequence of str
        Base names of the logs given; ``log_index`` counts only where a name repeats.
    option : str
        Option and file, for the error.

    Raises
    ------
    UsageError
        If a row names a log that was not given.

    Examples
    --------
    >>> rows = {"b.bag": (PressRow(1, 0, 9, "line 2"),)}
    >>> rows_of_logs(rows, ["b.bag", "a.bag"], "--truth hits.csv")["b.bag"][0].log_index is None
    True
    """
    unknown = sorted(set(rows) - set(names))
    if unknown:
        msg = f"{option}: names {', '.join(unknown)}, which is no log given"
        raise UsageError(msg)
    return {
        name: found
        if names.count(name) > 1
        else tuple(replace(row, log_index=None) for row in found)
        for name, found in rows.items()
    }
