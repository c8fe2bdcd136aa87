"""Runs of messages: cut, joined, merged."""

from collections.abc import Iterator, Sequence

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.files.runs import (
    END_NS,
    cut_runs,
    group_messages,
    in_turn,
    join_runs,
    merge_groups,
    messages_in,
)
from mpap_cli.logs.raw import RawMessage, RawRun, RunGroup, Topic

TOPICS = [Topic(name, "std_msgs/msg/String", "cdr", 1, "", "") for name in ("/a", "/b")]

rows = st.lists(st.tuples(st.sampled_from([0, 1]), st.integers(0, 9)), min_size=1, max_size=12)


def messages_of(texts: Sequence[tuple[int, int]], mark: str = "") -> list[RawMessage]:
    """Return messages in time order, each with a payload of its own."""
    messages = [
        RawMessage(TOPICS[topic], stamp_ns, f"{mark}{number}-{topic}".encode())
        for number, (topic, stamp_ns) in enumerate(texts)
    ]
    return sorted(messages, key=lambda message: message.stamp_ns)


def runs_of(messages: Sequence[RawMessage]) -> list[RawRun]:
    """Lay messages into one piece of memory, as a chunk has them."""
    records = b"head" + b"".join(message.payload for message in messages)
    sizes = np.array([len(message.payload) for message in messages])
    starts = 4 + np.cumsum(sizes) - sizes
    stamps_ns = np.array([message.stamp_ns for message in messages])
    runs = []
    for topic in TOPICS:
        of_topic = np.array([message.topic == topic for message in messages])
        if of_topic.any():
            columns = stamps_ns[of_topic], records, starts[of_topic], sizes[of_topic]
            runs.append(RawRun(topic, *columns))
    return runs


def groups_of(messages: Sequence[RawMessage], cuts: Sequence[int]) -> Iterator[RunGroup]:
    """Cut messages into groups."""
    rest = runs_of(messages)
    for until_ns in [*sorted(set(cuts)), END_NS]:
        before, rest = cut_runs(rest, until_ns)
        yield RunGroup(until_ns, before)


@given(texts=rows, until_ns=st.integers(0, 10))
def test_a_cut_parts_messages_by_their_stamps(texts: list[tuple[int, int]], until_ns: int) -> None:
    """Both parts keep the order, also where the rest has moved to memory of its own."""
    messages = messages_of(texts)

    before, rest = cut_runs(runs_of(messages), until_ns)

    assert list(messages_in(before)) == [m for m in messages if m.stamp_ns < until_ns]
    assert list(messages_in(rest)) == [m for m in messages if m.stamp_ns >= until_ns]


def test_little_that_is_left_does_not_hold_much_memory() -> None:
    """The rest of a large chunk is copied, that of a small one is not."""
    messages = messages_of([(number % 2, number) for number in range(50)])

    _, few = cut_runs(runs_of(messages), 44)
    _, most = cut_runs(runs_of(messages), 5)

    assert [len(run.records) for run in few] == [24, 24]
    assert few[0].records is few[1].records
    assert most[0].records is most[1].records
    assert len(most[0].records) == 194


@given(one=rows, other=rows)
def test_runs_that_overlap_are_joined(
    one: list[tuple[int, int]], other: list[tuple[int, int]]
) -> None:
    """The runs of a topic follow one another; equal stamps keep the order of the runs."""
    first, second = messages_of(one, "first"), messages_of(other, "second")

    turned = in_turn([*runs_of(first), *runs_of(second)])

    for topic in TOPICS:
        found = [
            (run.stamps_ns[n], run.payload(n))
            for run in turned
            if run.topic == topic
            for n in range(len(run))
        ]
        both = [m for m in [*first, *second] if m.topic == topic]
        expected = sorted(both, key=lambda message: message.stamp_ns)
        assert found == [(m.stamp_ns, m.payload) for m in expected]


def test_runs_that_follow_are_left_as_they_are() -> None:
    """Nothing is copied where nothing overlaps."""
    (early,), (late,) = (runs_of(messages_of([(0, t), (0, t + 1)])) for t in (0, 1))

    turned = in_turn([early, late])
    joined = join_runs([late, early])

    assert turned == [early, late]
    assert joined.stamps_ns.tolist() == [0, 1, 1, 2]
    assert [joined.payload(n) for n in range(4)] == [b"0-0", b"0-0", b"1-0", b"1-0"]


@given(
    files=st.lists(st.tuples(rows, st.lists(st.integers(0, 9), max_size=3)), min_size=1, max_size=3)
)
def test_files_are_merged_by_time(files: list[tuple[list[tuple[int, int]], list[int]]]) -> None:
    """All messages come, each group before its moment; equal stamps in the order of files."""
    parts = [messages_of(texts, f"file {number} ") for number, (texts, _) in enumerate(files)]
    streams = [groups_of(part, cuts) for part, (_, cuts) in zip(parts, files, strict=True)]

    groups = list(merge_groups(streams))

    begin_ns = -1
    for until_ns, runs in groups:
        stamps_ns = [stamp_ns for run in runs for stamp_ns in run.stamps_ns]
        assert all(begin_ns <= stamp_ns < until_ns for stamp_ns in stamps_ns)
        begin_ns = until_ns
    messages = sorted((m for part in parts for m in part), key=lambda message: message.stamp_ns)
    for topic in TOPICS:
        runs = [run for group in groups for run in group.runs if run.topic == topic]
        found = [run.payload(n) for run in runs for n in range(len(run))]
        assert found == [message.payload for message in messages if message.topic == topic]


def test_messages_become_groups_that_do_not_part_equal_stamps() -> None:
    """A group ends after many messages, or many bytes, where the stamp rises."""
    many = [RawMessage(TOPICS[0], stamp_ns // 600, b"x") for stamp_ns in range(1300)]
    large = [RawMessage(TOPICS[stamp_ns % 2], stamp_ns, bytes(1 << 21)) for stamp_ns in range(5)]

    of_many, of_large = list(group_messages(iter(many))), list(group_messages(iter(large)))

    assert [group.until_ns for group in of_many] == [1, 2, END_NS]
    assert [len(run) for group in of_many for run in group.runs] == [600, 600, 100]
    assert [group.until_ns for group in of_large] == [2, 4, END_NS]
    assert list(group_messages(iter([]))) == []
    assert list(messages_in([])) == []
