"""Rows of a database in groups: checked, cut between stamps, parted by topic."""

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager

import pytest

from mpap_cli.logs.files.databases.row_groups import (
    Row,
    row_groups,
    runs_of_rows,
    unsound_rows,
)
from mpap_cli.logs.files.runs import END_NS
from mpap_cli.logs.raw import Topic

ONE, OTHER = (Topic(name, "std_msgs/msg/Bool", "cdr", 0, "", "") for name in ("/a", "/b"))
WANTED = {1: ONE, 2: OTHER, 3: ONE}


@contextmanager
def rows_of(rows: Sequence[Row]) -> Iterator[sqlite3.Cursor]:
    """Give rows as a database gives them."""
    with closing(sqlite3.connect(":memory:")) as database:
        database.execute("CREATE TABLE r (a, b, c, d, e)")
        database.executemany("INSERT INTO r VALUES (?, ?, ?, ?, ?)", rows)
        yield database.execute("SELECT * FROM r ORDER BY rowid")


def row(stamp_ns: float, number: int = 1, topic: int = 1, payload: object = b"1") -> Row:
    """Return a row whose stamps agree."""
    return stamp_ns, number, topic, stamp_ns, payload


@pytest.mark.parametrize("n_same", [1, 5, 700])
def test_rows_of_one_stamp_stay_together(n_same: int) -> None:
    """Every row comes once, before the moment of its group and not before that of the last."""
    rows = [row(stamp, stamp * 1000 + n) for stamp in range(2100 // n_same) for n in range(n_same)]

    with rows_of(rows) as cursor:
        groups = list(row_groups(cursor, 0))

    assert [one for _, group in groups for one in group] == rows
    untils = [0, *(until_ns for until_ns, _ in groups)]
    assert len(groups) >= 3
    assert untils[-1] == END_NS
    for begin, (end, group) in zip(untils, groups, strict=False):
        assert begin <= group[0][0] <= group[-1][0] < end


def test_groups_end_early_where_payloads_are_large() -> None:
    """Memory holds a few megabytes, not five hundred images."""
    rows = [row(stamp, stamp, payload=bytes(1 << 20)) for stamp in range(40)]

    with rows_of(rows) as cursor:
        sizes = [len(group) for _, group in row_groups(cursor, 0)]

    assert sum(sizes) == 40
    assert max(sizes) < 20


@pytest.mark.parametrize(
    "bad",
    [(5, 1, 1, 6, b""), (5, None, None, None, None), row(3)],
    ids=["differs", "none", "falls"],
)
def test_an_index_that_contradicts_its_rows_is_refused(bad: Row) -> None:
    """It names another stamp, a row that is not there, or goes back in time."""
    with rows_of([row(4), bad]) as cursor, pytest.raises(sqlite3.DatabaseError, match="index"):
        list(row_groups(cursor, 0))


@pytest.mark.parametrize("bad", [row(5.5), row(5, payload="1"), row(5, topic=9)])
def test_rows_that_are_no_messages_are_told(bad: Row) -> None:
    """A stamp that is no integer, a payload that is text, a topic that is not known."""
    rows = [row(4, 7), (*bad[:1], 8, *bad[2:]), row(6, 9)]

    with rows_of(rows) as cursor:
        ((_, group),) = row_groups(cursor, 0)

    assert unsound_rows(group, WANTED) == [8]
    assert unsound_rows(rows[::2], WANTED) == []


def test_runs_hold_the_payloads_of_their_topic() -> None:
    """Two ids of one topic are one run, in the order of the rows."""
    rows = [row(n, n, 1 + n % 3, bytes([n] * n)) for n in range(1, 9)]

    runs = {run.topic: run for run in runs_of_rows(rows, WANTED)}

    assert runs.keys() == {ONE, OTHER}
    assert runs[OTHER].stamps_ns.tolist() == [1, 4, 7]
    assert runs[ONE].stamps_ns.tolist() == [2, 3, 5, 6, 8]
    for run in runs.values():
        expected = [bytes([n] * n) for n in run.stamps_ns.tolist()]
        assert [run.payload(place) for place in range(len(run))] == expected
