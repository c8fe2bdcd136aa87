"""Cuts of logs of every container: bytes, stamps, windows, and what is repeated."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer as McapWriter
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter

from mpap_cli.logs.passthrough.cuts import MOST_TRANSFORMS, Cut, cut_records
from mpap_cli.logs.passthrough.reader import PassthroughLog, chosen_channels
from mpap_cli.logs.passthrough.records import is_latched
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.writing.raw_log import SUFFIXES, RawLogWriter
from tests.logs.rows import SHUFFLED, START_NS, WriteLog

CUTS = [Cut(START_NS + 10_000, START_NS + 30_000), Cut(START_NS + 70_000, START_NS + 90_000)]
Read = list[tuple[str, str, int, bytes]]


def cut_log(path: Path, cuts: Sequence[Cut], topics: Sequence[str] = ()) -> Path:
    """Cut a log; return the new one."""
    with PassthroughLog(path) as log:
        target = path.parent / f"cut{SUFFIXES.get(log.origin.container, '')}"
        chosen = chosen_channels(log.channels, topics)
        channels = {number: log.channels[number] for number in chosen}
        with RawLogWriter(target, log.origin, channels) as writer:
            for _, record in cut_records(log, chosen, cuts):
                writer.write(record)
    return target


def messages(path: Path) -> Read:
    """Return topic, type, stamp and bytes of all messages."""
    with open_log(path) as log:
        found = list(log.messages([topic.name for topic in log.topics]))
        assert not log.damage
    return [(one.topic.name, one.topic.msgtype, one.stamp_ns, one.payload) for one in found]


def within(read: Read, cuts: Sequence[Cut]) -> Read:
    """Return what lies in one of the cuts."""
    return [row for row in read if any(cut.start_ns <= row[2] < cut.end_ns for cut in cuts)]


def test_a_cut_holds_the_same_messages_in_every_container(
    log_kind: str, write_log: WriteLog
) -> None:
    """What lies in the windows comes back byte by byte; container and definitions are kept."""
    path = write_log(log_kind, SHUFFLED)

    cut = cut_log(path, CUTS)

    expected = within(messages(path), CUTS)
    assert len(expected) > 20
    assert messages(cut) == expected
    with open_log(path) as whole, open_log(cut) as part:
        assert part.container == whole.container
        described = [(t.name, t.msgtype, t.encoding, t.definition) for t in part.topics]
        assert described == [(t.name, t.msgtype, t.encoding, t.definition) for t in whole.topics]
        assert not [text for text in part.warnings if "unpacked" not in text]


def test_the_libraries_read_a_cut(log_kind: str, write_log: WriteLog) -> None:
    """Rosbags opens it, or where it takes no such profile mcap's own reader does."""
    path = write_log(log_kind, SHUFFLED)

    cut = cut_log(path, CUTS)

    expected = within(messages(path), CUTS)
    if log_kind in {"mcap-ros1", "mcap-json"} or cut.suffix == ".mcap":
        with cut.open("rb") as stream:
            read = make_reader(stream, validate_crcs=True).iter_messages()
            found = [(c.topic, m.log_time, m.data) for _, c, m in read]
        assert found == [(topic, stamp_ns, payload) for topic, _, stamp_ns, payload in expected]
    if log_kind not in {"mcap-ros1", "mcap-json"}:
        with AnyReader([cut]) as reader:
            rows = [(c.topic, c.msgtype, t, bytes(raw)) for c, t, raw in reader.messages()]
        assert rows == expected


def test_the_messages_of_a_packed_folder_stay_packed(write_log: WriteLog) -> None:
    """What stands in the database is what stood there, and metadata.yaml says how."""
    path = write_log("sqlite3-message", SHUFFLED)

    cut = cut_log(path, CUTS)

    with PassthroughLog(path) as whole, PassthroughLog(cut) as part:
        kept = [record for record in whole.records([0, 1, 2]) if within_any(record.stamp_ns)]
        assert [r.payload for r in part.records([0, 1, 2])] == [r.payload for r in kept]
        assert part.origin.metadata["compression_mode"] == "message"


def within_any(stamp_ns: int) -> bool:
    """Tell whether a stamp lies in a cut."""
    return any(cut.start_ns <= stamp_ns < cut.end_ns for cut in CUTS)


@pytest.mark.parametrize("kind", ["bag-lz4", "bag-bz2", "bag-none", "mcap-zstd", "mcap-lz4"])
def test_chunks_are_packed_as_they_were(kind: str, write_log: WriteLog) -> None:
    """The compression of the chunks is that of the log."""
    path = write_log(kind, SHUFFLED)

    cut = cut_log(path, CUTS)

    with PassthroughLog(cut) as log:
        assert log.origin.compression == kind.partition("-")[2]


def test_topics_are_chosen_by_name_and_glob(write_log: WriteLog) -> None:
    """Only what was asked for is in the cut, and announced in it."""
    path = write_log("bag-none", SHUFFLED)

    cut = cut_log(path, CUTS, ["/left", "/ra*"])

    expected = [row for row in within(messages(path), CUTS) if row[0] != "/right"]
    assert messages(cut) == expected
    with open_log(cut) as log:
        assert [topic.name for topic in log.topics] == ["/left", "/rare"]


@pytest.mark.parametrize("kind", ["bag-lz4", "sqlite3", "folder-mcap", "mcap-zstd"])
def test_latched_messages_are_repeated_at_each_cut(kind: str, write_log: WriteLog) -> None:
    """Every static transform, and the last camera info, bear the stamp of the cut."""
    rows = [("/tf_static", 5, "a"), ("/tf_static", 6, "b"), ("/cam/camera_info", 7, "old")]
    rows += [("/cam/camera_info", 8, "new"), ("/scan", 9, "early")]
    rows += [("/scan", n, f"{n}") for n in range(20, 30)] + [("/tf_static", 24, "c")]
    path = write_log(kind, [(name, START_NS + at, text) for name, at, text in rows])
    cuts = [Cut(START_NS + 22, START_NS + 25), Cut(START_NS + 27, START_NS + 29)]

    cut = cut_log(path, cuts)

    with open_log(cut) as log:
        read = [
            (m.topic.name, m.stamp_ns - START_NS, vars(log.decode(m))["data"])
            for m in log.messages([topic.name for topic in log.topics])
        ]
    first = {("/tf_static", 22, "a"), ("/tf_static", 22, "b"), ("/cam/camera_info", 22, "new")}
    assert set(read[:4]) == {*first, ("/scan", 22, "22")}
    assert set(read[4:7]) == {("/scan", 23, "23"), ("/scan", 24, "24"), ("/tf_static", 24, "c")}
    again = {(name, 27, text) for name, _, text in first}
    assert set(read[7:12]) == {*again, ("/tf_static", 27, "c"), ("/scan", 27, "27")}
    assert read[12:] == [("/scan", 28, "28")]


def test_so_many_transforms_are_repeated_and_no_more(write_log: WriteLog) -> None:
    """A topic of static transforms that never repeats itself does not fill the memory."""
    rows = [("/tf_static", START_NS + n, f"{n}") for n in range(MOST_TRANSFORMS + 10)]
    path = write_log("mcap-none", rows)
    cut = Cut(START_NS + 1000, START_NS + 1001)

    with PassthroughLog(path) as log:
        repeated = [record for _, record in cut_records(log, [0], [cut])]

    assert len(repeated) == MOST_TRANSFORMS
    assert {record.stamp_ns for record in repeated} == {START_NS + 1000}


def test_what_mcap_says_of_channels_and_messages_is_kept(tmp_path: Path) -> None:
    """Profile, metadata, schemas, publish times and sequences are those of the log."""
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream:
        writer = McapWriter(stream)
        writer.start("ros2", "recorder")
        schema = writer.register_schema("pkg/msg/Odd", "omgidl", b"struct \xff")
        qos = {"offered_qos_profiles": "- durability: 1", "more": "kept"}
        first = writer.register_channel("/plan", "cdr", schema, qos)
        second = writer.register_channel("/plan", "cdr", schema, qos)
        bare = writer.register_channel("/bare", "cbor", 0)
        writer.add_message(first, 10, b"\0one", 7, 41)
        writer.add_message(second, 11, b"\0two", 8, 42)
        writer.add_message(bare, 20, b"three", 9, 43)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type

    cut = cut_log(path, [Cut(15, 30)])

    with cut.open("rb") as stream:
        reader = make_reader(stream)
        found = list(reader.iter_messages())
        header = reader.get_header()
    assert (header.profile, header.library) == ("ros2", "recorder")
    assert [(m.log_time, m.publish_time, m.sequence, m.data) for _, _, m in found] == [
        (15, 7, 41, b"\0one"),
        (15, 8, 42, b"\0two"),
        (20, 9, 43, b"three"),
    ]
    assert found[0][0] is not None
    assert (found[0][0].encoding, found[0][0].data) == ("omgidl", b"struct \xff")
    assert found[0][1].metadata == qos
    assert found[0][1].id != found[1][1].id
    assert found[2][0] is None


def test_what_a_bag_says_of_connections_is_kept(tmp_path: Path) -> None:
    """Caller, latching and a checksum that fits no definition are those of the log."""
    path = tmp_path / "log.bag"
    with BagWriter(path) as writer:
        plan = writer.add_connection(
            "/plan", "pkg/msg/Odd", msgdef="odd", md5sum="0" * 32, callerid="/node", latching=1
        )
        other = writer.add_connection("/other", "pkg/msg/Odd", msgdef="odd", md5sum="0" * 32)
        writer.write(plan, 10, b"plan")
        writer.write(other, 20, b"other")

    cut = cut_log(path, [Cut(15, 30)])

    with BagReader(cut) as reader:
        found = [(c.topic, c.digest, c.ext, t, raw) for c, t, raw in reader.messages()]
    assert found == [
        ("/plan", "0" * 32, plan.ext, 15, b"plan"),
        ("/other", "0" * 32, other.ext, 20, b"other"),
    ]


def test_a_damaged_log_gives_what_can_be_read(write_log: WriteLog) -> None:
    """Of a bag that is cut off the whole messages are cut out, and the damage is told."""
    path = write_log("bag-none", SHUFFLED)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) * 7 // 10])

    with PassthroughLog(path) as log:
        numbers = range(len(log.channels))
        whole = list(log.records(numbers))
        found = [record for _, record in cut_records(log, numbers, CUTS)]

    assert log.damage
    assert [r.payload for r in found] == [r.payload for r in whole if within_any(r.stamp_ns)]
    assert found


@pytest.mark.parametrize("name", ["/tf_static", "/a/robot_description", "/map", "/x/camera_info"])
def test_topics_are_latched_by_name(name: str) -> None:
    """What is published once by custom holds on."""
    assert is_latched(name)


def test_topics_are_latched_by_what_is_offered() -> None:
    """Transient local holds on, as a number and as a name; volatile does not."""
    named = is_latched("/plan", qos="- history: keep_last\n  durability: transient_local\n")
    volatile = is_latched("/plan", qos="- durability: 2\n  depth: 1\n")

    assert named
    assert not volatile
