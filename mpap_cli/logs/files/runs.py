"""Runs of messages: cut at a moment, joined, merged over files, made of single messages."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from mpap_cli.logs.raw import RawMessage, RawRun, RunGroup, Topic
from mpap_cli.observations import IntArray

MAX_STAMP_NS = 1 << 62
"""A later stamp (the year 2116) is taken for broken; it also keeps sums within int64."""

END_NS = MAX_STAMP_NS + 1
"""``until_ns`` of the last group."""

_GROUP_MESSAGES = 512
_GROUP_BYTES = 1 << 22


def cut_runs(runs: Sequence[RawRun], until_ns: int) -> tuple[list[RawRun], list[RawRun]]:
    """Part what is stamped before a moment from the rest.

    Of memory that holds little of the rest, that little is copied.
    """
    before: list[RawRun] = []
    rest: dict[int, list[RawRun]] = {}
    for run in runs:
        n_before = int(np.searchsorted(run.stamps_ns, until_ns))
        if n_before:
            before.append(run.rows(slice(n_before)))
        if n_before < len(run):
            rest.setdefault(id(run.records), []).append(run.rows(slice(n_before, None)))
    return before, [run for together in rest.values() for run in _compacted(together)]


def _compacted(runs: list[RawRun]) -> list[RawRun]:
    """Copy the payloads of runs that share their memory, if that frees half of it."""
    records = runs[0].records
    sizes = np.concatenate([run.sizes for run in runs])
    if 2 * sizes.sum() > len(records):
        return runs
    starts = np.concatenate([run.starts for run in runs])
    order = np.argsort(starts)
    copies = [
        records[start : start + size]
        for start, size in zip(starts[order], sizes[order], strict=True)
    ]
    starts[order] = np.cumsum(sizes[order]) - sizes[order]
    copied, ends = b"".join(copies), np.cumsum([len(run) for run in runs])
    return [
        RawRun(run.topic, run.stamps_ns, copied, starts[end - len(run) : end], run.sizes)
        for run, end in zip(runs, ends, strict=True)
    ]


def join_runs(runs: Sequence[RawRun]) -> RawRun:
    """Copy runs of one topic into one, in time order; equal stamps in the order of the runs."""
    stamps_ns = np.concatenate([run.stamps_ns for run in runs])
    payloads = [run.payload(number) for run in runs for number in range(len(run))]
    order = np.argsort(stamps_ns, kind="stable")
    return _pack(runs[0].topic, stamps_ns[order], [payloads[place] for place in order])


def _pack(topic: Topic, stamps_ns: IntArray, payloads: Sequence[bytes]) -> RawRun:
    """Put payloads behind one another."""
    sizes = np.fromiter(map(len, payloads), np.int64, len(payloads))
    return RawRun(topic, stamps_ns, b"".join(payloads), np.cumsum(sizes) - sizes, sizes)


def in_turn(runs: Sequence[RawRun]) -> list[RawRun]:
    """Make the runs of each topic follow one another; those that overlap in time are joined."""
    by_topic: dict[Topic, list[RawRun]] = {}
    for run in runs:
        by_topic.setdefault(run.topic, []).append(run)
    turned = []
    for same in by_topic.values():
        follow = all(one.stamps_ns[-1] <= other.stamps_ns[0] for one, other in pairwise(same))
        turned.extend(same if follow else [join_runs(same)])
    return turned


def merge_groups(streams: Sequence[Iterator[RunGroup]]) -> Iterator[RunGroup]:
    """Merge the groups of several files; equal stamps in the order of the files."""
    if len(streams) == 1:
        yield from streams[0]
        return
    untils = [-END_NS] * len(streams)
    waiting: list[list[RawRun]] = [[] for _ in streams]
    until_ns = -END_NS
    while until_ns < END_NS:
        behind = untils.index(until_ns)
        untils[behind], more = next(streams[behind], RunGroup(END_NS, ()))
        waiting[behind].extend(more)
        until_ns = min(untils)
        ready = []
        for place, runs in enumerate(waiting):
            before, waiting[place] = cut_runs(runs, until_ns)
            ready.extend(before)
        if ready:
            yield RunGroup(until_ns, in_turn(ready))


def group_messages(messages: Iterator[RawMessage]) -> Iterator[RunGroup]:
    """Make runs of messages that come in time order."""
    block: list[RawMessage] = []
    n_bytes = 0
    for message in messages:
        full = len(block) >= _GROUP_MESSAGES or n_bytes >= _GROUP_BYTES
        if full and message.stamp_ns > block[-1].stamp_ns:
            yield RunGroup(message.stamp_ns, _runs_of(block))
            block, n_bytes = [], 0
        block.append(message)
        n_bytes += len(message.payload)
    if block:
        yield RunGroup(END_NS, _runs_of(block))


def _runs_of(messages: Sequence[RawMessage]) -> list[RawRun]:
    """Put the payloads of each topic behind one another."""
    by_topic: dict[Topic, list[RawMessage]] = {}
    for message in messages:
        by_topic.setdefault(message.topic, []).append(message)
    return [
        _pack(
            topic,
            np.array([message.stamp_ns for message in same], dtype=np.int64),
            [message.payload for message in same],
        )
        for topic, same in by_topic.items()
    ]


def messages_in(runs: Sequence[RawRun]) -> Iterator[RawMessage]:
    """Yield the messages of runs in time order; equal stamps as they lie in memory."""
    if not runs:
        return
    memory = {id(run.records): place for place, run in reversed(list(enumerate(runs)))}
    sizes = np.concatenate([run.sizes for run in runs])
    starts = np.concatenate([run.starts for run in runs])
    stamps_ns = np.concatenate([run.stamps_ns for run in runs])
    which = np.repeat(np.arange(len(runs)), [len(run) for run in runs])
    pieces = np.array([memory[id(run.records)] for run in runs])[which]
    order = np.lexsort((starts, pieces, stamps_ns))
    columns = (which[order], stamps_ns[order], starts[order], sizes[order])
    for number, stamp_ns, start, size in zip(*(c.tolist() for c in columns), strict=True):
        run = runs[number]
        yield RawMessage(run.topic, stamp_ns, run.records[start : start + size])
