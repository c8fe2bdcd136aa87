"""Every container gives the same messages; words become paths."""

import tempfile
from itertools import pairwise
from pathlib import Path

import pytest

from mpap_cli.errors import LogError, UsageError
from mpap_cli.logs.reader import expand_paths, open_log
from tests.logs.rows import IN_ORDER, SHUFFLED, WriteLog, read


def test_messages_come_in_time_order(write_log: WriteLog, log_kind: str) -> None:
    """All messages, each decoded, sorted by log time, although the file is not."""
    path = write_log(log_kind, SHUFFLED)

    with open_log(path) as reader:
        found = read(reader)

    assert found == IN_ORDER
    assert reader.damage == []


def test_runs_hold_the_same_messages(write_log: WriteLog, log_kind: str) -> None:
    """Group by group, within a window too, each topic in the order of its messages."""
    path = write_log(log_kind, SHUFFLED)
    names = {"/left", "/right", "/rare"}

    for window in ({}, {"start_ns": IN_ORDER[30][1], "end_ns": IN_ORDER[80][1]}):
        with open_log(path) as reader:
            groups = list(reader.runs(names, **window))
            messages = list(reader.messages(names, **window))
        runs = [run for group in groups for run in group.runs]
        for topic in names:
            found = [
                (stamp_ns, run.payload(number))
                for run in runs
                if run.topic.name == topic
                for number, stamp_ns in enumerate(run.stamps_ns.tolist())
            ]
            assert found == [(m.stamp_ns, m.payload) for m in messages if m.topic.name == topic]
        for one, other in pairwise(groups):
            assert max(run.stamps_ns[-1] for run in one.runs) < one.until_ns
            assert min(run.stamps_ns[0] for run in other.runs) >= one.until_ns
        assert reader.damage == []


def test_topics_tell_counts_and_times(write_log: WriteLog, log_kind: str) -> None:
    """The index, or what replaces it, is exact."""
    path = write_log(log_kind, SHUFFLED)

    with open_log(path) as reader:
        topics = {topic.name: topic for topic in reader.topics}

    assert {name: topic.n_messages for name, topic in topics.items()} == {
        name: sum(row[0] == name for row in SHUFFLED) for name in ("/left", "/rare", "/right")
    }
    assert list(topics) == sorted(topics)
    assert reader.n_messages == len(SHUFFLED)
    assert (reader.start_ns, reader.end_ns) == (IN_ORDER[0][1], IN_ORDER[-1][1])
    encodings = {"bag": "ros1", "mcap-ros1": "ros1", "mcap-json": "json"}
    kind = log_kind if log_kind in encodings else log_kind.split("-", maxsplit=1)[0]
    assert {topic.encoding for topic in topics.values()} == {encodings.get(kind, "cdr")}
    expected = "Text" if log_kind == "mcap-json" else "std_msgs/msg/String"
    assert {topic.msgtype for topic in topics.values()} == {expected}
    assert {bool(topic.definition) for topic in topics.values()} == {True}


def test_only_chosen_topics_come(write_log: WriteLog, log_kind: str) -> None:
    """Names that the log does not hold are passed over."""
    path = write_log(log_kind, SHUFFLED)

    with open_log(path) as reader:
        rare = read(reader, ["/rare", "/no/such/topic"])
        none = read(reader, ["/no/such/topic"])

    assert rare == [row for row in IN_ORDER if row[0] == "/rare"]
    assert none == []


def test_window_takes_its_start_and_leaves_its_end(write_log: WriteLog, log_kind: str) -> None:
    """Start <= t < end."""
    path = write_log(log_kind, SHUFFLED)
    start_ns, end_ns = IN_ORDER[30][1], IN_ORDER[80][1]

    with open_log(path) as reader:
        found = read(reader, start_ns=start_ns, end_ns=end_ns)
        before = read(reader, end_ns=IN_ORDER[0][1])
        after = read(reader, start_ns=IN_ORDER[-1][1] + 1)

    assert found == [row for row in IN_ORDER if start_ns <= row[1] < end_ns]
    assert before == after == []


def test_log_is_read_again_and_twice_at_once(write_log: WriteLog, log_kind: str) -> None:
    """Two streams do not disturb one another."""
    path = write_log(log_kind, SHUFFLED)

    with open_log(path) as reader:
        one, two = (reader.messages(["/left"]) for _ in range(2))
        pairs = list(zip(one, two, strict=True))

    assert len(pairs) == sum(row[0] == "/left" for row in SHUFFLED)
    assert all(first == second for first, second in pairs)


def test_log_and_its_folder_stay_as_they_are(
    write_log: WriteLog, log_kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is written beside the log, and no temporary file is left."""
    path = write_log(log_kind, SHUFFLED)
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    files = {file: file.read_bytes() for file in path.parent.rglob("*") if file.is_file()}

    with open_log(path) as reader:
        read(reader)

    assert files == {f: f.read_bytes() for f in path.parent.rglob("*") if f.is_file()}
    assert list(scratch.iterdir()) == []


def test_log_without_messages_is_no_error(write_log: WriteLog, log_kind: str) -> None:
    """It has no topics and no times; what to do is up to the caller."""
    path = write_log(log_kind, [])

    with open_log(path) as reader:
        found = read(reader)

    assert (found, reader.topics, reader.n_messages) == ([], (), 0)
    assert (reader.start_ns, reader.end_ns) == (0, 0)


def test_folder_of_definitions_must_exist(write_log: WriteLog, tmp_path: Path) -> None:
    """A wrong --msgs is a wrong use, not a wrong log."""
    path = write_log("mcap-zstd", SHUFFLED)

    with pytest.raises(UsageError, match=r"--msgs .*none: no such folder"):
        open_log(path, msgs=[tmp_path / "none"])


def test_words_become_paths(tmp_path: Path) -> None:
    """Globs are sorted, metadata.yaml is its folder, and no log comes twice."""
    for name in ("b.bag", "a.bag", "odd[1].bag"):
        (tmp_path / name).touch()
    folder = tmp_path / "drive"
    folder.mkdir()
    (folder / "metadata.yaml").touch()
    words = [folder / "metadata.yaml", tmp_path / "?.bag", tmp_path / "a.bag", folder]

    found = expand_paths([*map(str, words), str(tmp_path / "odd[1].bag")])

    assert [path.name for path in found] == ["drive", "a.bag", "b.bag", "odd[1].bag"]


@pytest.mark.parametrize(
    ("word", "text"),
    [("*.bag", r"\*\.bag: matches no file or folder"), ("a.bag", "no such file or folder")],
)
def test_word_that_matches_nothing(tmp_path: Path, word: str, text: str) -> None:
    """The word is named."""
    with pytest.raises(LogError, match=text):
        expand_paths([str(tmp_path / word)])
