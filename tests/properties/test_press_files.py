"""Files of presses are read or refused with file and line."""

from pathlib import Path

import pytest

from mpap_cli.errors import LogError, UsageError
from mpap_cli.observations import NS_PER_S, Press
from mpap_cli.properties.press_files import (
    PressRow,
    presses_from_csv,
    presses_of_log,
    rows_of_logs,
)


def write(folder: Path, text: str) -> Path:
    """Write a table."""
    path = folder / "hits.csv"
    path.write_text(text, encoding="utf-8")
    return path


def ns(seconds: float) -> int:
    """Return nanoseconds."""
    return round(seconds * NS_PER_S)


def test_rows_are_kept_by_base_name_with_exact_stamps(tmp_path: Path) -> None:
    """Columns may come in any order and others are left alone; seconds become exact."""
    table = "start_s,log,note,end_s\n100000.000000001,day/a.bag,x,100001\n2,b.mcap,,3.5\n"

    rows = presses_from_csv(write(tmp_path, table))

    assert rows == {
        "a.bag": (PressRow(None, 100_000_000_000_001, 100_001_000_000_000, "hits.csv line 2"),),
        "b.mcap": (PressRow(None, 2_000_000_000, 3_500_000_000, "hits.csv line 3"),),
    }


def test_a_table_without_rows_says_that_nothing_was_pressed(tmp_path: Path) -> None:
    """The header alone is a table."""
    assert presses_from_csv(write(tmp_path, "log,start_s,end_s\n")) == {}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "",
            r"hits.csv line 1: no log, start_s, end_s among no column; expected log,start_s,end_s",
        ),
        ("log,start_s\na,1\n", r"hits.csv line 1: no end_s among log, start_s"),
        ("log,start_s,end_s\na,1,2\na,x,2\n", r"hits.csv line 3: start_s is 'x'; expected seconds"),
        ("log,start_s,end_s\na,1\n", r"hits.csv line 2: end_s is ''; expected seconds"),
        ("log,start_s,end_s\na,-1,2\n", r"line 2: start_s is '-1'"),
        ("log,start_s,end_s\na,1,nan\n", r"line 2: end_s is 'nan'"),
        ("log,start_s,end_s\na,1,1e30\n", r"line 2: end_s is '1e30'"),
        ("log,start_s,end_s\na,3,3\n", r"line 2: end_s 3 is not after start_s 3"),
        ("log,start_s,end_s\n,1,2\n", r"line 2: log is empty"),
        ("log,log_index,start_s,end_s\na,-1,1,2\n", r"line 2: log_index is '-1'"),
        ('log,start_s,end_s\n"a,1,2\n', r"hits.csv: not a CSV file in UTF-8"),
    ],
)
def test_a_broken_table_is_refused_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    """What was found and what was expected is in the message."""
    with pytest.raises(UsageError, match=message):
        presses_from_csv(write(tmp_path, text))


def test_a_file_in_another_encoding_is_refused(tmp_path: Path) -> None:
    """Spreadsheets write such files."""
    path = tmp_path / "hits.csv"
    path.write_bytes("log,start_s,end_s\nä".encode("latin-1"))

    with pytest.raises(UsageError, match=r"hits.csv: not a CSV file in UTF-8"):
        presses_from_csv(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    """The message names the path."""
    with pytest.raises(LogError, match=r"none.csv: No such file or directory; give a CSV"):
        presses_from_csv(tmp_path / "none.csv")


def test_rows_of_the_other_log_of_the_same_name_are_left_out() -> None:
    """The log_index parts logs of one name; without it a row belongs to each of them."""
    rows = [
        PressRow(0, ns(1), ns(2), ""),
        PressRow(1, ns(5), ns(6), ""),
        PressRow(None, ns(8), ns(9), ""),
    ]

    presses = presses_of_log(rows, 1, ns(100), ns(200))

    assert presses == (Press(ns(105), ns(106)), Press(ns(108), ns(109)))


def test_presses_that_overlap_are_one() -> None:
    """Presses that only touch stay two."""
    rows = [PressRow(None, ns(start), ns(end), "") for start, end in ((5, 9), (2, 6), (9, 10))]

    presses = presses_of_log(rows, 0, ns(0), ns(200))

    assert presses == (Press(ns(2), ns(9)), Press(ns(9), ns(10)))


def test_a_press_beyond_the_end_is_not_released() -> None:
    """It is cut one nanosecond after the last message."""
    presses = presses_of_log([PressRow(None, ns(4), ns(80), "")], 0, ns(0), ns(20))

    assert presses == (Press(ns(4), ns(20) + 1, released=False),)


@pytest.mark.parametrize(("start_s", "held"), [(0, True), (0.34, True), (1, True), (1.01, False)])
def test_a_press_within_the_first_second_is_held_from_the_start(start_s: float, held: bool) -> None:
    """It has no onset, as in the log that it was written from; later presses have one."""
    rows = [PressRow(None, ns(start_s), ns(1.5), ""), PressRow(None, ns(2), ns(3), "")]

    presses = presses_of_log(rows, 0, ns(100), ns(200))

    assert [press.held_from_start for press in presses] == [held, False]
    assert presses[0].start_ns == ns(100 + start_s)


def test_only_the_first_press_can_be_held_from_the_start() -> None:
    """What comes after a release has an onset, however early it is."""
    rows = [PressRow(None, ns(start), ns(start + 0.2), "") for start in (0.1, 0.5)]

    presses = presses_of_log(rows, 0, ns(0), ns(20))

    assert [press.held_from_start for press in presses] == [True, False]


def test_a_press_after_the_end_is_refused() -> None:
    """It belongs to another log."""
    rows = [PressRow(None, 3_000_000_000, 4_000_000_000, "hits.csv line 7")]

    with pytest.raises(UsageError, match=r"line 7: the press begins at 3 s, but the log lasts 2 s"):
        presses_of_log(rows, 0, 0, 2_000_000_000)


def test_a_name_that_is_given_once_needs_no_index() -> None:
    """A table of other logs in another order keeps its presses."""
    rows = {"b.bag": (PressRow(1, 0, NS_PER_S, "line 2"),)}

    alone = rows_of_logs(rows, ["b.bag"], "--truth hits.csv")
    twice = rows_of_logs(rows, ["b.bag", "b.bag"], "--truth hits.csv")

    assert len(presses_of_log(alone["b.bag"], 0, 0, 9 * NS_PER_S)) == 1
    assert presses_of_log(twice["b.bag"], 0, 0, 9 * NS_PER_S) == ()


def test_a_log_that_was_not_given_is_named() -> None:
    """A row for another log is an error that names it."""
    rows = {"b.bag": (PressRow(None, 0, NS_PER_S, "line 2"),)}

    with pytest.raises(UsageError, match=r"hits\.csv: names b\.bag"):
        rows_of_logs(rows, ["a.bag"], "--truth hits.csv")


def test_what_is_no_file_is_not_read() -> None:
    """A device would never end."""
    with pytest.raises(LogError, match="no file"):
        presses_from_csv(Path("/dev/zero"))
