"""Rows that kernels find in the pages of a database, against a plain walk over its cells."""

import sqlite3
from collections.abc import Sequence
from contextlib import closing
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.robustness.mutations import mutated
from mpap_cli.errors import LogError
from mpap_cli.logs.files.databases import _kernels as kernels
from mpap_cli.logs.files.databases import saved_rows
from mpap_cli.logs.files.databases.saved_rows import find_saved_rows
from mpap_cli.logs.files.runs import messages_in
from mpap_cli.logs.raw import Topic
from tests.logs.files.databases.row_reference import Row, rows_in_pages

MOST = 1 << 62
TOPIC = Topic("/a", "std_msgs/msg/String", "cdr", 0, "", "")

integers = st.integers(-(1 << 61), 1 << 61) | st.integers(-200, 200)
rows = st.lists(
    st.tuples(integers, integers, st.integers(0, 40) | st.integers(0, 9_000)), max_size=30
)
pages = st.sampled_from([512, 1024, 4096, 65_536])


def write_database(path: Path, page_bytes: int, rows: Sequence[tuple[int, int, int]]) -> list[Row]:
    """Write messages (topic, stamp, size of the payload), some of them in pages set free."""
    path.unlink(missing_ok=True)
    with closing(sqlite3.connect(path)) as database:
        database.execute(f"PRAGMA page_size = {page_bytes}")
        database.executescript(
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);"
            "CREATE TABLE others(id INTEGER PRIMARY KEY, a, b, c);"
            "INSERT INTO others VALUES (1, 5, 2.5, x'01'), (2, 'a', 3, x'01'), (3, 5, 6, 'text');"
        )
        written = [
            (number, topic, stamp_ns, bytes(np.arange(size) % (97 + number % 7)))
            for number, (topic, stamp_ns, size) in enumerate(rows, 1)
        ]
        database.executemany("INSERT INTO messages VALUES (?, ?, ?, ?)", written)
        database.commit()
    return written


def found_in(path: Path) -> list[Row]:
    """Return what is found, in the order given: id, topic, stamp, payload."""
    found = find_saved_rows(path)
    topics = dict.fromkeys(found.counts, TOPIC)
    runs = [run for group in found.groups(topics, -MOST, MOST) for run in group.runs]
    payloads = [message.payload for message in messages_in(runs)]
    ids, numbers, stamps_ns = found.rows[: kernels.STAMP + 1].tolist()
    return list(zip(ids, numbers, stamps_ns, payloads, strict=True))


def reference(path: Path) -> list[Row]:
    """Return the same by the plain walk."""
    once = {row[:3]: row for row in reversed(list(rows_in_pages(path)))}
    return sorted(once.values(), key=lambda row: (row[2], row[0], row[1]))


@given(page_bytes=pages, rows=rows)
def test_rows_of_pages_are_the_rows_of_the_table(
    tmp_path_factory: pytest.TempPathFactory,
    page_bytes: int,
    rows: list[tuple[int, int, int]],
) -> None:
    """Whatever the size of pages and payloads; nothing else is taken for a message."""
    path = tmp_path_factory.getbasetemp() / "table.db3"
    written = write_database(path, page_bytes, rows)

    found = found_in(path)

    assert found == sorted(written, key=lambda row: (row[2], row[0]))


@given(page_bytes=pages, rows=rows, seed=st.integers(0, 1 << 30))
def test_rows_of_changed_pages_are_those_of_the_reference(
    tmp_path_factory: pytest.TempPathFactory,
    page_bytes: int,
    rows: list[tuple[int, int, int]],
    seed: int,
) -> None:
    """Cut, overwritten, with numbers changed, pages moved: both find the same."""
    path = tmp_path_factory.getbasetemp() / "changed.db3"
    write_database(path, page_bytes, rows)
    content = path.read_bytes()
    path.write_bytes(content[:100] + mutated(np.random.default_rng(seed), content[100:]))

    found = found_in(path)

    assert found == reference(path)


def test_rows_are_found_without_compiling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernels are plain Python, too."""
    path = tmp_path / "log.db3"
    written = write_database(path, 512, [(3, -5, 4), (3, 1 << 40, 3_000), (300, 7, 0)])
    names = [name for name in vars(kernels) if hasattr(vars(kernels)[name], "py_func")]
    for name in names:
        monkeypatch.setattr(kernels, name, vars(kernels)[name].py_func)

    found = found_in(path)

    assert len(names) > 5
    assert found == sorted(written, key=lambda row: row[2])


def test_more_rows_than_expected_in_a_block(tmp_path: Path) -> None:
    """Tables are made larger where rows are small."""
    path = tmp_path / "log.db3"
    written = write_database(path, 4096, [(1, number, 1) for number in range(30_000)])

    found = found_in(path)

    assert found == written


def test_groups_of_few_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Large messages come in groups of their own, equal stamps together; none is lost."""
    monkeypatch.setattr(saved_rows, "_GROUP_BYTES", 1_000)
    path = tmp_path / "log.db3"
    write_database(path, 1024, [(1, number // 3, 800) for number in range(30)])
    saved = find_saved_rows(path)

    groups = list(saved.groups({1: TOPIC}, 2, 9))

    stamps_ns = [run.stamps_ns.tolist() for group in groups for run in group.runs]
    assert [stamp for group in stamps_ns for stamp in group] == sorted([*range(2, 9)] * 3)
    assert len(groups) == 7
    assert all(one.until_ns == other[0] for one, other in zip(groups, stamps_ns[1:], strict=False))


def test_chains_that_turn_in_circles(tmp_path: Path) -> None:
    """Rows that say they share one chain of pages take no more time than sound ones."""
    path = tmp_path / "log.db3"
    write_database(path, 512, [(1, number, 100_000) for number in range(200)])
    saved = find_saved_rows(path)
    nexts = np.full_like(saved.nexts, 2)

    whole = kernels.check_chains(np.tile(saved.rows, 50), nexts, saved.layout)

    assert whole[: 10 * saved.rows.shape[1]].all()
    assert not whole[20 * saved.rows.shape[1] :].any()


def test_file_that_shrinks_while_it_is_read(tmp_path: Path) -> None:
    """That is one sentence."""
    path = tmp_path / "log.db3"
    write_database(path, 512, [(1, number, 10_000) for number in range(20)])
    saved = find_saved_rows(path)
    path.write_bytes(path.read_bytes()[:-5_000])

    with pytest.raises(LogError, match=r"log\.db3: the file became shorter"):
        list(saved.groups({1: TOPIC}, 0, MOST))


def test_stamps_are_sorted(tmp_path: Path) -> None:
    """Rows are recorded as they come, and given in order."""
    path = tmp_path / "log.db3"
    write_database(path, 4096, [(1, -(number % 7), 5) for number in range(500)])

    found = found_in(path)

    assert all((a[2], a[0]) < (b[2], b[0]) for a, b in pairwise(found))
