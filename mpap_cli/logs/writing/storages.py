"""Containers a log is written into: payloads and definitions become files."""

from collections.abc import Callable
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from mcap.writer import CompressionType
from mcap.writer import Writer as McapFile
from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer as Bag1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2
from rosbags.typesys.msg import denormalize_msgtype

from mpap_cli.logs.writing.encoding import JsonEncoder, RosEncoder

Bag = TypeVar("Bag", Bag1, Bag2)

CONTAINERS: dict[str, tuple[str, ...]] = {
    "bag": ("lz4", "bz2", "none"),
    "rosbag2-sqlite3": ("none", "zstd-file", "zstd-message"),
    "rosbag2-mcap": ("zstd-storage", "zstd-file", "zstd-message", "none"),
    "mcap": ("zstd", "lz4", "none"),
    "mcap-ros1": ("zstd", "lz4", "none"),
    "mcap-json": ("zstd", "lz4", "none"),
}
"""Compressions of each container, the default first."""

_MCAP_COMPRESSIONS = {
    "none": CompressionType.NONE,
    "lz4": CompressionType.LZ4,
    "zstd": CompressionType.ZSTD,
}
_MCAP_PROFILES = {"mcap": "ros2", "mcap-ros1": "ros1", "mcap-json": ""}
_MESSAGE_ENCODINGS = {"mcap": "cdr", "mcap-ros1": "ros1", "mcap-json": "json"}
_SCHEMA_ENCODINGS = {"mcap": "ros2msg", "mcap-ros1": "ros1msg", "mcap-json": "jsonschema"}


class Storage(Protocol):
    """An open log of one container."""

    def add_topic(self, topic: str, msgtype: str, definition: str, digest: str) -> int:
        """Announce a topic; return its number."""
        ...

    def write(self, topic_id: int, stamp_ns: int, payload: bytes) -> None:
        """Append the bytes of one message."""
        ...

    def close(self, *, whole: bool) -> None:
        """Write the index; or, if the log is not whole, only let go of the file."""
        ...


class _RosbagsStorage(Generic[Bag]):
    """A log that rosbags writes."""

    def __init__(self, bag: Bag) -> None:
        self._bag: Bag = bag
        self._bag.open()
        self._connections: list[Connection] = []

    def _number(self, connection: Connection) -> int:
        self._connections.append(connection)
        return len(self._connections) - 1

    def write(self, topic_id: int, stamp_ns: int, payload: bytes) -> None:
        self._bag.write(self._connections[topic_id], stamp_ns, payload)

    def close(self, *, whole: bool) -> None:
        try:
            if whole:
                self._bag.close()
        finally:
            self._bag.abort()  # whatever the disk refused, the file is let go of


class _BagStorage(_RosbagsStorage[Bag1]):
    """A ROS1 .bag."""

    def __init__(self, path: Path, container: str, compression: str) -> None:
        del container  # the class is the container
        bag = Bag1(path)
        if compression != "none":
            bag.set_compression(Bag1.CompressionFormat[compression.upper()])
        super().__init__(bag)

    def add_topic(self, topic: str, msgtype: str, definition: str, digest: str) -> int:
        latching = 1 if topic == "/tf_static" else None
        return self._number(
            self._bag.add_connection(
                topic, msgtype, msgdef=definition, md5sum=digest, latching=latching
            )
        )


class _Rosbag2Storage(_RosbagsStorage[Bag2]):
    """A rosbag2 folder with its metadata.yaml."""

    def __init__(self, path: Path, container: str, compression: str) -> None:
        plugin = StoragePlugin[container.removeprefix("rosbag2-").upper()]
        bag = Bag2(path, version=9, storage_plugin=plugin)
        if compression != "none":
            mode = CompressionMode[compression.removeprefix("zstd-").upper()]
            bag.set_compression(mode, CompressionFormat.ZSTD)
        super().__init__(bag)

    def add_topic(self, topic: str, msgtype: str, definition: str, digest: str) -> int:
        return self._number(
            self._bag.add_connection(topic, msgtype, msgdef=definition, rihs01=digest)
        )


class _McapStorage:
    """A bare MCAP file."""

    def __init__(self, path: Path, container: str, compression: str) -> None:
        self._container = container
        self._file = path.open("xb")
        self._mcap = McapFile(self._file, compression=_MCAP_COMPRESSIONS[compression])
        self._mcap.start(_MCAP_PROFILES[container], "mpap")

    def add_topic(self, topic: str, msgtype: str, definition: str, digest: str) -> int:
        is_ros1 = self._container == "mcap-ros1"
        name = denormalize_msgtype(msgtype) if is_ros1 else msgtype
        encoding = _SCHEMA_ENCODINGS[self._container]
        schema = self._mcap.register_schema(name, encoding, definition.encode())
        metadata = {"md5sum": digest} if is_ros1 else {}
        return self._mcap.register_channel(
            topic, _MESSAGE_ENCODINGS[self._container], schema, metadata
        )

    def write(self, topic_id: int, stamp_ns: int, payload: bytes) -> None:
        self._mcap.add_message(topic_id, stamp_ns, payload, stamp_ns)

    def close(self, *, whole: bool) -> None:
        try:
            if whole:
                self._mcap.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
        finally:
            self._file.close()


STORAGES: dict[str, Callable[[Path, str, str], Storage]] = {
    "bag": _BagStorage,
    "rosbag2-sqlite3": _Rosbag2Storage,
    "rosbag2-mcap": _Rosbag2Storage,
    "mcap": _McapStorage,
    "mcap-ros1": _McapStorage,
    "mcap-json": _McapStorage,
}
ENCODERS: dict[str, Callable[[], RosEncoder | JsonEncoder]] = {
    "bag": lambda: RosEncoder(1),
    "rosbag2-sqlite3": lambda: RosEncoder(2),
    "rosbag2-mcap": lambda: RosEncoder(2),
    "mcap": lambda: RosEncoder(2),
    "mcap-ros1": lambda: RosEncoder(1),
    "mcap-json": JsonEncoder,
}
