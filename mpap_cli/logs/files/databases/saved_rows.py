"""Messages of a broken database, found in its pages and read where they lie.

The tree that leads to the rows may hang on a page that is lost, so every page is looked at once:
https://www.sqlite.org/fileformat2.html, sections 1.6 and 2.1.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from io import BufferedReader
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mpap_cli.errors import LogError
from mpap_cli.logs.files.databases._kernels import (
    ID,
    SIZE,
    STAMP,
    START,
    TOPIC,
    check_chains,
    copy_payloads,
    find_rows,
    list_pages,
)
from mpap_cli.logs.files.databases.pages import Layout, read_layout
from mpap_cli.logs.files.runs import END_NS, MAX_STAMP_NS
from mpap_cli.logs.raw import RawRun, RunGroup, Topic
from mpap_cli.observations import IntArray

_BLOCK_BYTES = 1 << 20
_GROUP_MESSAGES = 1024
_GROUP_BYTES = 1 << 22


@dataclass(frozen=True, slots=True, eq=False)
class SavedRows:
    """Where in a broken database its messages are.

    ``rows`` (7, n) has the columns of `_kernels`, in the order of stamps and ids, each message
    once; ``nexts`` (n_pages,) is the page that follows each page; ``others`` are the leaves,
    from 1, that hold something else than messages.
    """

    path: Path
    layout: Layout
    rows: IntArray
    nexts: NDArray[np.uint32]
    others: list[int]

    @property
    def counts(self) -> dict[int, int]:
        """Return how many messages each topic has, by its id."""
        topics, n_messages = np.unique(self.rows[TOPIC], return_counts=True)
        return dict(zip(topics.tolist(), n_messages.tolist(), strict=True))

    @property
    def payload_bytes(self) -> dict[int, int]:
        """Return how large the payloads of each topic are, by its id."""
        topics, which = np.unique(self.rows[TOPIC], return_inverse=True)
        sizes = np.bincount(which, self.rows[SIZE], topics.size).astype(np.int64)
        return dict(zip(topics.tolist(), sizes.tolist(), strict=True))

    @property
    def stamps_ns(self) -> IntArray:
        """Return the stamps of all messages (n,), not decreasing."""
        stamps_ns: IntArray = self.rows[STAMP]
        return stamps_ns

    def only(self, topics: Collection[int]) -> "SavedRows":
        """Return what belongs to one of the topics and has a stamp that can be one."""
        stamps_ns = self.stamps_ns
        sound = np.isin(self.rows[TOPIC], np.array(list(topics), dtype=np.int64))
        sound &= (stamps_ns >= -MAX_STAMP_NS) & (stamps_ns < MAX_STAMP_NS)
        return self if sound.all() else replace(self, rows=self.rows[:, sound])

    def groups(self, wanted: Mapping[int, Topic], start_ns: int, end_ns: int) -> Iterator[RunGroup]:
        """Yield the messages of the wanted topics, start <= t < end; equal stamps by their ids."""
        begin, end = np.searchsorted(self.stamps_ns, [start_ns, end_ns])
        rows = self.rows[:, begin:end]
        rows = rows[:, np.isin(rows[TOPIC], np.array(list(wanted), dtype=np.int64))]
        stamps_ns, bytes_before = rows[STAMP], np.cumsum(rows[SIZE]) - rows[SIZE]
        begin, n_rows = 0, rows.shape[1]
        with self.path.open("rb") as stream:
            while begin < n_rows:
                full = np.searchsorted(bytes_before, bytes_before[begin] + _GROUP_BYTES)
                last = min(begin + _GROUP_MESSAGES, int(full), n_rows) - 1
                end = int(np.searchsorted(stamps_ns, stamps_ns[last], side="right"))
                until_ns = int(stamps_ns[end]) if end < n_rows else END_NS
                yield RunGroup(until_ns, self._runs(stream, rows[:, begin:end], wanted))
                begin = end

    def _runs(
        self, stream: BufferedReader, rows: IntArray, wanted: Mapping[int, Topic]
    ) -> list[RawRun]:
        """Read some messages, and part them by topic."""
        pages = list_pages(rows, self.nexts, self.layout)
        content = self._read(stream, pages)
        payloads = copy_payloads(content, pages, rows, self.nexts, self.layout)
        sizes = rows[SIZE]
        starts = np.cumsum(sizes) - sizes
        runs = []
        for topic in dict.fromkeys(wanted.values()):
            numbers = [number for number, its in wanted.items() if its == topic]
            of_topic = np.isin(rows[TOPIC], numbers)
            if of_topic.any():
                stamps_ns = rows[STAMP, of_topic]
                runs.append(RawRun(topic, stamps_ns, payloads, starts[of_topic], sizes[of_topic]))
        return runs

    def _read(self, stream: BufferedReader, pages: IntArray) -> NDArray[np.uint8]:
        """Read pages; those that follow one another at once."""
        n_bytes, file_bytes = self.layout.page_bytes, self.layout.file_bytes
        content = np.empty(pages.size * n_bytes, np.uint8)
        breaks = np.flatnonzero(np.diff(pages) > 1) + 1
        firsts, ends = [0, *breaks.tolist()], [*breaks.tolist(), pages.size]
        for first, end in zip(firsts, ends, strict=True):
            stream.seek(int(pages[first]) * n_bytes)
            target = content.data[first * n_bytes : end * n_bytes]
            expected = min(len(target), file_bytes - stream.tell())
            if stream.readinto(target[:expected]) != expected:
                msg = f"{self.path.name}: the file became shorter while it was read"
                raise LogError(msg)
        return content


def find_saved_rows(path: Path) -> SavedRows:
    """Find every whole message in a database.

    Parameters
    ----------
    path : Path
        The database, cut off or broken in whatever way.

    Returns
    -------
    SavedRows
        Of a message that stands there twice, the first.

    Raises
    ------
    BrokenRecordError
        If its header is broken.
    """
    parts, nexts, others = [], [], []
    with path.open("rb") as stream:
        layout = read_layout(stream)
        page = 2
        # the first page holds no messages
        block_bytes = max(_BLOCK_BYTES // layout.page_bytes, 1) * layout.page_bytes
        stream.seek(layout.page_bytes)
        while block := stream.read(block_bytes):
            found, following, is_other = find_rows(block, layout)
            found[START] += (page - 1) * layout.page_bytes
            parts.append(found)
            nexts.append(following)
            others.extend((np.flatnonzero(is_other) + page).tolist())
            page += following.size
    all_nexts = np.concatenate([np.zeros(1, np.uint32), *nexts])
    rows = np.concatenate([np.empty((7, 0), np.int64), *parts], axis=1)
    whole = check_chains(rows, all_nexts, layout)
    rows = _sorted_once(rows if whole.all() else rows[:, whole])
    return SavedRows(path, layout, rows, all_nexts, others)


def _sorted_once(rows: IntArray) -> IntArray:
    """Leave out what stands there twice, and sort by stamp, then id."""
    if (rows[ID, 1:] <= rows[ID, :-1]).any():
        order = np.lexsort((rows[STAMP], rows[TOPIC], rows[ID]))
        same = (rows[: STAMP + 1, order[1:]] == rows[: STAMP + 1, order[:-1]]).all(axis=0)
        rows = rows[:, np.sort(order[np.concatenate([[True], ~same])])]
    if (rows[STAMP, 1:] < rows[STAMP, :-1]).any() or (rows[ID, 1:] < rows[ID, :-1]).any():
        rows = rows[:, np.lexsort((rows[ID], rows[STAMP]))]
    return rows
