"""Logs whose definitions are bad, missing or few: what is not used never matters."""

import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter

from mpap_cli.errors import LogError
from mpap_cli.logs.reader import LogReader, open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.topics import TopicChoice, choose_roles
from mpap_cli.logs.writing.encoding import RosEncoder
from mpap_cli.params import BumperParams

SCAN, KOBUKI = "sensor_msgs/msg/LaserScan", "kobuki_msgs/msg/BumperEvent"
SCAN_FIELDS = {"angle_increment": 0.1, "range_max": 5.0, "ranges": [1.0] * 4}
PRESSED = {"bumper": 1, "state": 1}
ROS1, ROS2 = RosEncoder(1), RosEncoder(2)

# what drivers have written; each hides a whole bag from libraries that parse all types first
BAD_TYPES = {
    "no text": ("rosserial_arduino/msg/Adc", "", "6d7853a614e2e821319068311f2af25b"),
    "no definition but words": ("odd_msgs/msg/Pair", "Definition of odd_msgs/Pair", "*"),
    "lower-case constants": (
        "naoqi_bridge_msgs/msg/Bumper",
        "uint8 right=0\nuint8 left=1\nuint8 bumper\nuint8 statePressed=1\nuint8 state\n",
        "40f6fbb5f8aa4a8a1db1c8d5bee64faf",
    ),
    "a field of no type": ("odd_msgs/msg/Lost", "gone_msgs/Thing thing\n", "*"),
    "no language at all": ("odd_msgs/msg/Noise", "\x00\xff{[(", "*"),
    "a type in itself": ("odd_msgs/msg/Ring", "odd_msgs/Ring ring\n", "*"),
}
Write = Callable[[Path, str, str, str], Path]


def write_bag(path: Path, msgtype: str, text: str, digest: str) -> Path:
    """Write scans and bumps beside a topic of a bad type, as a ROS 1 bag."""
    with BagWriter(path / "log.bag") as writer:
        odd = writer.add_connection("/odd", msgtype, msgdef=text, md5sum=digest)
        for name, own, fields in (("/scan", SCAN, SCAN_FIELDS), ("/bump", KOBUKI, PRESSED)):
            definition, own_digest = ROS1.definition(own)
            added = writer.add_connection(name, own, msgdef=definition, md5sum=own_digest)
            writer.write(added, 10, ROS1.encode(own, fields))
        writer.write(odd, 11, b"\1")
    return path / "log.bag"


def write_mcap(path: Path, msgtype: str, text: str, _: str) -> Path:
    """Write the same as MCAP without a profile and without chunks."""
    with (path / "log.mcap").open("wb") as stream:
        writer = McapWriter(stream, use_chunking=False)
        writer.start("")
        rows = [("/odd", msgtype, text, b"\0\1\0\0\1\2")]
        for name, own, fields in (("/scan", SCAN, SCAN_FIELDS), ("/bump", KOBUKI, PRESSED)):
            rows.append((name, own, ROS2.definition(own)[0], ROS2.encode(own, fields)))
        for name, own, definition, payload in rows:
            schema = writer.register_schema(own, "ros2msg", definition.encode("utf-8"))
            channel = writer.register_channel(name, "cdr", schema)
            writer.add_message(channel, 10, payload, 10)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path / "log.mcap"


def write_database(path: Path, msgtype: str, text: str, _: str) -> Path:
    """Write the same as a database that has definitions of the bad and of one good type."""
    with closing(sqlite3.connect(path / "log.db3")) as database, database:
        database.executescript(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);"
            "CREATE TABLE message_definitions(topic_type, encoding, encoded_message_definition);"
        )
        rows = [("/odd", msgtype, b"\0\1\0\0\1\2")]
        for name, own, fields in (("/scan", SCAN, SCAN_FIELDS), ("/bump", KOBUKI, PRESSED)):
            rows.append((name, own, ROS2.encode(own, fields)))
        for number, (name, own, payload) in enumerate(rows, 1):
            topic = (number, name, own, "cdr")
            database.execute("INSERT INTO topics VALUES (?, ?, ?, ?)", topic)
            database.execute("INSERT INTO messages VALUES (?, ?, 10, ?)", (number, number, payload))
        for own, definition in ((msgtype, text), (SCAN, ROS2.definition(SCAN)[0])):
            told = (own, "ros2msg", definition)
            database.execute("INSERT INTO message_definitions VALUES (?, ?, ?)", told)
    return path / "log.db3"


WRITERS: dict[str, Write] = {"bag": write_bag, "mcap": write_mcap, "db3": write_database}


def read(reader: LogReader) -> tuple[int, list[bool]]:
    """Return how many scans there are, and the states of the bumper."""
    batches = list(Replay(reader, choose_roles(reader), BumperParams()))
    n_scans = sum(len(block.ranges) for batch in batches for block in batch.scans)
    return n_scans, [bump.pressed for batch in batches for bump in batch.bumps]


@pytest.mark.parametrize("bad", BAD_TYPES)
@pytest.mark.parametrize("container", WRITERS)
def test_bad_type_of_an_unused_topic_does_not_matter(
    tmp_path: Path, container: str, bad: str
) -> None:
    """Types are parsed when their first message is decoded; the topic is listed."""
    path = WRITERS[container](tmp_path, *BAD_TYPES[bad])

    with open_log(path, strict=True) as reader:
        found = read(reader)

    assert found == (1, [True])
    assert {topic.name for topic in reader.topics} == {"/scan", "/bump", "/odd"}
    assert reader.warnings == []


@pytest.mark.parametrize("bad", sorted(BAD_TYPES.keys() - {"lower-case constants"}))
@pytest.mark.parametrize("container", WRITERS)
def test_bad_type_that_is_asked_for_is_named(tmp_path: Path, container: str, bad: str) -> None:
    """One line: which type of which topic."""
    path = WRITERS[container](tmp_path, *BAD_TYPES[bad])

    with open_log(path) as reader, pytest.raises(LogError) as caught:
        choose_roles(reader, TopicChoice(bumps=("/odd:state",)))

    assert str(caught.value).startswith(f"{path.name}: ")
    assert BAD_TYPES[bad][0] in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("suffix", "text"), [
    (".msg", "bool hit\n"),
    (".idl", "module odd_msgs { module msg { struct Noise { boolean hit; }; }; };"),
])  # fmt: skip
@pytest.mark.parametrize("container", WRITERS)
def test_definition_of_the_user_mends_a_bad_one(
    tmp_path: Path, container: str, suffix: str, text: str
) -> None:
    """--msgs DIR, for one type; the others are taken from where they were."""
    path = WRITERS[container](tmp_path, *BAD_TYPES["no language at all"])
    folder = tmp_path / "ws" / "odd_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / f"Noise{suffix}").write_text(text, encoding="utf-8")

    with open_log(path, msgs=[tmp_path / "ws"]) as reader:
        roles = choose_roles(reader, TopicChoice(bumps=("/odd:hit",)))
        (batch,) = Replay(reader, roles, BumperParams())

    assert [bump.pressed for bump in batch.bumps] == [True]
    assert len(batch.scans) == 1


@pytest.mark.parametrize("distro", ["jazzy", "humble", ""])
def test_distribution_of_the_log_gives_its_standard_types(tmp_path: Path, distro: str) -> None:
    """service_msgs is younger than humble, which is taken where the log names none."""
    path = write_database(tmp_path, "service_msgs/msg/ServiceEventInfo", "", "")
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro)")
        database.execute("INSERT INTO schema VALUES (4, ?)", (distro,))
        event = b"\0\1\0\0\1" + bytes(39)
        database.execute("UPDATE messages SET data = ? WHERE topic_id = 1", (event,))

    with open_log(path) as reader:
        (message,) = reader.messages({"/odd"})
        if distro == "jazzy":
            assert vars(reader.decode(message))["event_type"] == 1
        else:
            with pytest.raises(LogError, match=r"name the folder of its \.msg file"):
                reader.decode(message)
