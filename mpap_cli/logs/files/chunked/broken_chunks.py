"""Broken chunks of one file: told once each, with the messages that are lost in them."""

from collections import Counter
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from mpap_cli.logs.raw import Damage, Reading, Topic, TopicKey
from mpap_cli.observations import IntArray

_EVERY = np.empty(0, np.int64)


class _Walk(Protocol):
    """`ChunkFormat.walk`."""

    def __call__(self, records: bytes, wanted: IntArray) -> tuple[IntArray, bool]: ...


class BrokenChunks:
    """What is broken in one file of chunks."""

    def __init__(
        self, name: str, n_chunks: int, channels: Mapping[int, Topic], reading: Reading
    ) -> None:
        self._name = name
        self._n_chunks = n_chunks
        self._channels = channels
        self._reading = reading
        self._offsets: set[int] = set()
        self._lost: Counter[TopicKey] = Counter()
        self._is_all_known = True

    def note(self, offset: int, problem: str, lost: Mapping[int, int] | None) -> None:
        """Report a broken chunk once, however often the log is read.

        Parameters
        ----------
        offset : int
            Where it begins.
        problem : str
            What is wrong with it.
        lost : mapping of int to int, optional
            How many messages are lost by channel, where that is known.

        Raises
        ------
        LogError
            If the log is read strictly.
        """
        if offset in self._offsets:
            return
        self._offsets.add(offset)
        self._is_all_known &= lost is not None
        for number, n_messages in (lost or {}).items():
            topic = self._channels.get(number)
            self._lost[(topic.name, topic.msgtype) if topic else ("", "")] += n_messages
        n_broken, n_lost = len(self._offsets), self._lost.total()
        words = f"{n_lost:,} message{'s' if n_lost != 1 else ''} lost"
        words = words if self._is_all_known else f"at least {words}"
        told = f", {words}" if self._is_all_known or n_lost else ""
        text = (
            f"{self._name}: {n_broken} of {self._n_chunks} chunks damaged and left out{told} "
            f"(at byte {offset:,}: {problem})"
        )
        self._reading.add_damage(Damage(self._name, "chunk", n_broken, text, dict(self._lost)))


def lost_in(
    records: bytes, walk: _Walk, n_messages: Mapping[int, int] | None, first_ns: int, last_ns: int
) -> dict[int, int] | None:
    """Return by channel how many of its messages a chunk does not give any more.

    Parameters
    ----------
    records : bytes
        What could be unpacked.
    walk : callable
        Finds the messages in it.
    n_messages : mapping of int to int, optional
        What the index says that it holds; without it nothing is known.
    first_ns, last_ns : int
        Messages outside these stamps are not given.
    """
    if n_messages is None:
        return None
    found, _ = walk(records, _EVERY)
    given = Counter(found[0, (first_ns <= found[1]) & (found[1] <= last_ns)].tolist())
    lost = {number: n - given[number] for number, n in n_messages.items()}
    return {number: n for number, n in lost.items() if n > 0}
