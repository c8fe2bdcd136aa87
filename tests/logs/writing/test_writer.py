"""Logs are written in every container, whole or not at all."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mpap_cli.errors import OutputError, SettingError, UsageError
from mpap_cli.logs.writing.encoding import JsonEncoder, RosEncoder
from mpap_cli.logs.writing.storages import CONTAINERS
from mpap_cli.logs.writing.writer import LogWriter, check_container

EVERY_WAY = [(name, how) for name, choices in CONTAINERS.items() for how in choices]
ROSBAGS_WAYS = [(name, how) for name, how in EVERY_WAY if name not in ("mcap-ros1", "mcap-json")]
SCAN = "sensor_msgs/msg/LaserScan"
START_NS = 1_577_836_800_000_000_001


def scan_of(i: int) -> dict[str, Any]:
    """Return the fields of a small scan."""
    ranges = np.round(np.linspace(0.1, 7.9, 5) + i / 1000, 3).astype(np.float32)
    ranges[0] = math.inf
    return {"header": {"stamp": {"sec": i}, "frame_id": "laser"}, "ranges": ranges}


def write_scans(path: Path, container: str, compression: str | None = None) -> None:
    """Write five scans, 100 ms apart, and announce a topic without messages."""
    with LogWriter(path, container, compression) as writer:
        for i in range(5):
            writer.write("/scan", SCAN, START_NS + i * 100_000_000, scan_of(i))
        writer.add_topic("/bump", "kobuki_msgs/msg/BumperEvent")


def write_then_fail(writer: LogWriter, bump: str) -> None:
    """Write one message, then one of a type that does not exist."""
    with writer:
        writer.write("/bump", bump, START_NS, {})
        writer.write("/other", "no/msg/Such", START_NS, {})


@pytest.mark.parametrize(("container", "compression"), ROSBAGS_WAYS)
def test_stamps_and_ranges_come_back_exactly(
    tmp_path: Path, container: str, compression: str
) -> None:
    """What rosbags reads from a bag, folder or MCAP file is what was written."""
    path = tmp_path / ("log.bag" if container == "bag" else "log.mcap")

    write_scans(path, container, compression)

    with AnyReader([path]) as reader:
        found = [
            (stamp, reader.deserialize(payload, connection.msgtype))
            for connection, stamp, payload in reader.messages()
        ]
        assert set(reader.topics) == {"/scan", "/bump"}
    assert [stamp for stamp, _ in found] == [START_NS + i * 100_000_000 for i in range(5)]
    for i, (_, scan) in enumerate(found):
        message: Any = scan
        assert message.header.stamp.sec == i
        assert message.ranges.tobytes() == scan_of(i)["ranges"].tobytes()


@pytest.mark.parametrize("compression", CONTAINERS["mcap-ros1"])
def test_mcap_with_ros1_messages_says_so_and_holds_them(tmp_path: Path, compression: str) -> None:
    """Profile ros1, schema encoding ros1msg, type names of ROS1, md5 sums on the channels."""
    path = tmp_path / "log.mcap"

    write_scans(path, "mcap-ros1", compression)

    store = get_typestore(Stores.ROS1_NOETIC)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        found = list(reader.iter_messages())
        assert reader.get_header().profile == "ros1"
    assert len(found) == 5
    schema, channel, message = found[3]
    assert schema is not None
    assert (schema.name, schema.encoding) == ("sensor_msgs/LaserScan", "ros1msg")
    assert channel.metadata["md5sum"] == "90c7ef2dc6895d81024acba2ac42f369"
    scan: Any = store.deserialize_ros1(message.data, SCAN)
    assert scan.ranges.tobytes() == scan_of(3)["ranges"].tobytes()
    assert message.log_time == START_NS + 300_000_000


@pytest.mark.parametrize("compression", CONTAINERS["mcap-json"])
def test_mcap_with_json_holds_text_and_schema(tmp_path: Path, compression: str) -> None:
    """A JSON message can be read with the json module; its schema is a JSON schema."""
    path = tmp_path / "log.mcap"

    with LogWriter(path, "mcap-json", compression) as writer:
        writer.write("/bump", "Bumper", START_NS, {"pressed": True})
        writer.write(
            "/scan", "foxglove.LaserScan", START_NS, {"ranges": np.array([0.123, 8], np.float32)}
        )

    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        found = {channel.topic: (schema, m) for schema, channel, m in reader.iter_messages()}
        assert reader.get_header().profile == ""
    assert json.loads(found["/bump"][1].data) == {"pressed": True}
    assert json.loads(found["/scan"][1].data) == {"ranges": [0.123, 8.0]}
    schema = found["/scan"][0]
    assert schema is not None
    assert schema.encoding == "jsonschema"
    assert json.loads(schema.data)["title"] == "foxglove.LaserScan"


@pytest.mark.parametrize(("container", "compression"), EVERY_WAY)
def test_nothing_is_left_after_an_error(tmp_path: Path, container: str, compression: str) -> None:
    """A log that could not be finished leaves neither the log nor anything beside it."""
    path = tmp_path / "log"
    bump = "Bumper" if container == "mcap-json" else "std_msgs/msg/Bool"

    with pytest.raises(UsageError):
        write_then_fail(LogWriter(path, container, compression), bump)

    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("container", CONTAINERS)
def test_existing_log_is_not_touched(tmp_path: Path, container: str) -> None:
    """A path that exists is refused and stays as it is."""
    path = tmp_path / "log.mcap"
    path.write_text("mine")

    with pytest.raises(OutputError, match=r"log\.mcap: exists already; remove it"):
        LogWriter(path, container).__enter__()

    assert path.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [path]


def test_missing_folder_is_named(tmp_path: Path) -> None:
    """A log in a folder that is not there cannot be written."""
    path = tmp_path / "nowhere" / "log.mcap"

    with pytest.raises(OutputError, match="cannot be written"):
        LogWriter(path).__enter__()


@pytest.mark.parametrize("container", CONTAINERS)
def test_same_messages_give_the_same_bytes(tmp_path: Path, container: str) -> None:
    """Containers hold no date: the same messages make the same file."""
    paths = [tmp_path / "a" / "log", tmp_path / "b" / "log"]
    bump = "Bumper" if container == "mcap-json" else "std_msgs/msg/Bool"

    for path in paths:
        path.parent.mkdir()
        with LogWriter(path, container) as writer:
            writer.write("/bump", bump, START_NS, {})

    files = [sorted(p for p in path.parent.rglob("*") if p.is_file()) for path in paths]
    assert [p.read_bytes() for p in files[0]] == [p.read_bytes() for p in files[1]]


def test_writing_outside_the_with_block_is_a_bug(tmp_path: Path) -> None:
    """A writer that was not entered has no file to write to."""
    writer = LogWriter(tmp_path / "log.mcap")

    with pytest.raises(RuntimeError, match="with-block"):
        writer.write("/bump", "std_msgs/msg/Bool", START_NS, {})


@pytest.mark.parametrize(
    ("container", "compression", "message"),
    [
        ("tar", None, "container: found tar, expected one of bag, rosbag2-sqlite3"),
        ("bag", "zstd", "compression: found zstd, expected one of lz4, bz2, none for bag"),
    ],
)
def test_unknown_container_names_the_choices(
    container: str, compression: str | None, message: str
) -> None:
    """A container or compression that does not exist is refused with those that do."""
    with pytest.raises(SettingError, match=message):
        check_container(container, compression)


@pytest.mark.parametrize("ros_version", [1, 2])
def test_fields_left_out_are_zero(ros_version: int) -> None:
    """An empty mapping is a message of zeros, empty texts and empty lists."""
    encoder = RosEncoder(ros_version)

    payload = encoder.encode("nav_msgs/msg/Odometry", {})

    store = encoder.store
    decode = store.deserialize_ros1 if ros_version == 1 else store.deserialize_cdr
    odometry: Any = decode(payload, "nav_msgs/msg/Odometry")
    assert odometry.child_frame_id == ""
    assert odometry.pose.covariance.tolist() == [0.0] * 36


@pytest.mark.parametrize("ros_version", [1, 2])
def test_lists_of_every_kind_come_back(ros_version: int) -> None:
    """Texts, numbers and messages in lists survive, of types inside types too."""
    encoder = RosEncoder(ros_version)
    state = {"collision1_name": "a", "depths": [0.5], "contact_normals": [{"x": 1.0}]}
    polygons = {"polygons": ["front", "rear"], "detections": [True, False]}

    contacts = encoder.encode("gazebo_msgs/msg/ContactsState", {"states": [state, {}]})
    monitor = encoder.encode("nav2_msgs/msg/CollisionDetectorState", polygons)

    store = encoder.store
    decode = store.deserialize_ros1 if ros_version == 1 else store.deserialize_cdr
    found: Any = decode(contacts, "gazebo_msgs/msg/ContactsState")
    assert [s.collision1_name for s in found.states] == ["a", ""]
    assert found.states[0].contact_normals[0].x == 1.0
    zones: Any = decode(monitor, "nav2_msgs/msg/CollisionDetectorState")
    assert zones.polygons == ["front", "rear"]
    assert list(zones.detections) == [True, False]


def test_definitions_come_with_what_they_contain() -> None:
    """The definition of a type holds the definitions of the types inside it."""
    text, digest = RosEncoder(2).definition("ros_gz_interfaces/msg/Contacts")

    types = get_types_from_msg(text, "ros_gz_interfaces/msg/Contacts")
    assert {"ros_gz_interfaces/msg/Contact", "ros_gz_interfaces/msg/Entity"} <= set(types)
    assert digest.startswith("RIHS01_")


def test_unknown_type_or_field_is_named() -> None:
    """A type without definition, a field that it does not have, infinity in JSON: one line."""
    with pytest.raises(UsageError, match="no/msg/Such: no definition"):
        RosEncoder(2).encode("no/msg/Such", {})
    with pytest.raises(UsageError, match="std_msgs/msg/Bool has no field on; it has data"):
        RosEncoder(2).encode("std_msgs/msg/Bool", {"on": True})
    with pytest.raises(UsageError, match="Such: no JSON schema"):
        JsonEncoder().definition("Such")
    with pytest.raises(UsageError, match="JSON cannot hold inf"):
        JsonEncoder().encode("foxglove.LaserScan", {"ranges": np.array([math.inf])})


@pytest.mark.parametrize("container", ["bag", "rosbag2-sqlite3"])
def test_a_log_that_appeared_meanwhile_stays(tmp_path: Path, container: str) -> None:
    """Of two writers of one name the faster one is kept; the other is told."""
    path = tmp_path / "log"
    with LogWriter(path, container) as writer:
        writer.write("/bump", "std_msgs/msg/Bool", 10**18, {"data": True})
        path.write_text("mine", encoding="utf-8")

        with pytest.raises(OutputError, match="exists already"):
            writer.__exit__(None, None, None)

    assert [one.name for one in tmp_path.iterdir()] == ["log"]
    assert path.read_text(encoding="utf-8") == "mine"
