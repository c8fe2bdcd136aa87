"""Rows of a rosbag2 database: checked, grouped by time, put behind one another in runs."""

import math
import operator
import sqlite3
from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from mpap_cli.logs.files.databases.content import BROKEN_INDEX
from mpap_cli.logs.files.runs import END_NS
from mpap_cli.logs.raw import RawRun, Topic

_BLOCK_ROWS = 16  # a row may be an image of a megabyte
_GROUP_ROWS = 512
_GROUP_BYTES = 1 << 22

Row = tuple[Any, Any, Any, Any, Any]
"""Stamp in the index, id, topic, stamp in the table, payload; what they are is not known yet."""


def row_groups(rows: sqlite3.Cursor, first_ns: int) -> Iterator[tuple[int, list[Row]]]:
    """Yield rows that are stamped before a moment, with that moment.

    Parameters
    ----------
    rows : Cursor
        Gives each `Row` in the order of the index; without a row in the table the rest is None.
    first_ns : int
        No row is stamped before this.

    Yields
    ------
    tuple of int and list of Row
        Rows of one stamp stay together.

    Raises
    ------
    sqlite3.DatabaseError
        If the index contradicts the table, or its stamps fall.
    """
    waiting: list[Row] = []
    n_bytes, last_ns = 0, first_ns
    while block := rows.fetchmany(_BLOCK_ROWS):
        indexed_ns, numbers, _, stamps_ns, payloads = zip(*block, strict=True)
        falls = any(map(operator.gt, (last_ns, *indexed_ns), indexed_ns))
        if falls or None in numbers or indexed_ns != stamps_ns:
            raise sqlite3.DatabaseError(BROKEN_INDEX)
        last_ns = indexed_ns[-1]
        waiting += block
        n_bytes += _sum_bytes(payloads)
        if len(waiting) >= _GROUP_ROWS or n_bytes >= _GROUP_BYTES:
            end = bisect_left(waiting, last_ns, key=operator.itemgetter(0))
            if end:
                yield math.ceil(last_ns), waiting[:end]
                waiting, n_bytes = waiting[end:], 0
    if waiting:
        yield END_NS, waiting


def _sum_bytes(payloads: Sequence[Any]) -> int:
    """Add up the sizes of those that are payloads."""
    if {*map(type, payloads)} == {bytes}:
        return sum(map(len, payloads))
    return sum(len(payload) for payload in payloads if isinstance(payload, bytes))


def unsound_rows(rows: Sequence[Row], wanted: Mapping[int, Topic]) -> list[int]:
    """Return the numbers of rows that are no messages of the wanted topics.

    One flipped bit makes a blob a text, a stamp a float or a topic another one.
    """
    _, numbers, topics, stamps_ns, payloads = zip(*rows, strict=True)
    is_sound = {*map(type, stamps_ns)} == {int} and {*map(type, payloads)} == {bytes}
    if is_sound and wanted.keys() >= {*topics}:
        return []
    return [
        number
        for number, topic, stamp_ns, payload in zip(
            numbers, topics, stamps_ns, payloads, strict=True
        )
        if not (topic in wanted and isinstance(payload, bytes) and isinstance(stamp_ns, int))
    ]


def runs_of_rows(rows: Sequence[Row], wanted: Mapping[int, Topic]) -> list[RawRun]:
    """Put the payloads of sound rows, one at least, behind one another; part them by topic."""
    _, _, numbers, stamps, payloads = zip(*rows, strict=True)
    stamps_ns = np.array(stamps, dtype=np.int64)
    sizes = np.fromiter(map(len, payloads), np.int64, len(payloads))
    starts, records = np.cumsum(sizes) - sizes, b"".join(payloads)
    places: dict[Topic, list[int]] = {}
    for number in dict.fromkeys(numbers):
        places.setdefault(wanted[number], []).append(number)
    if len(places) == 1:
        return [RawRun(topic, stamps_ns, records, starts, sizes) for topic in places]
    topic_of, runs = np.array(numbers, dtype=np.int64), []
    for topic, its in places.items():
        of_topic = np.isin(topic_of, its)
        columns = (stamps_ns[of_topic], records, starts[of_topic], sizes[of_topic])
        runs.append(RawRun(topic, *columns))
    return runs
