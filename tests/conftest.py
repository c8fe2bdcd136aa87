"""Logs for tests: recorded ones that MPAP_SHARED names, and small ones written on the spot."""

import json
import logging
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as FolderWriter
from rosbags.typesys import Stores, get_typestore

Rows = Sequence[tuple[str, int, str]]
WriteLog = Callable[[str, Rows], Path]

CHUNK_BYTES = 300

# make test tries the same examples everywhere, make soak others each time; slow is no failure
settings.register_profile("default", deadline=None, derandomize=True)
settings.register_profile("soak", deadline=None, max_examples=5000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))
_STRING = "std_msgs/msg/String"
_STORES = {"ros1": get_typestore(Stores.ROS1_NOETIC), "cdr": get_typestore(Stores.ROS2_HUMBLE)}


@pytest.fixture
def shared_logs() -> Path:
    """Return the folder of recorded logs; without MPAP_SHARED the test is left out."""
    folder = os.environ.get("MPAP_SHARED")
    if folder is None:
        pytest.skip("MPAP_SHARED is not set")
    logs = Path(folder) / "data" / "logs"
    if not logs.is_dir():
        pytest.fail(f"MPAP_SHARED: {logs} is missing")
    return logs


@pytest.fixture(autouse=True)
def fresh_talk() -> Iterator[None]:
    """Undo what a command line has set for the talk on stderr."""
    yield
    logger = logging.getLogger("mpap_cli")
    logger.setLevel(logging.NOTSET)
    logger.handlers = []


def encode(encoding: str, text: str) -> bytes:
    """Return a string message in an encoding."""
    if encoding == "json":
        return json.dumps({"data": text}).encode()
    store = _STORES[encoding]
    message = store.types[_STRING](text)
    if encoding == "ros1":
        return bytes(store.serialize_ros1(message, _STRING))
    return bytes(store.serialize_cdr(message, _STRING))


def _write_bag(path: Path, rows: Rows, compression: str) -> Path:
    path = path / "log.bag"
    writer = BagWriter(path)
    writer.chunk_threshold = CHUNK_BYTES
    if compression != "none":
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    with writer:
        topics = {
            name: writer.add_connection(name, _STRING, typestore=_STORES["ros1"])
            for name in dict.fromkeys(row[0] for row in rows)
        }
        for name, stamp_ns, text in rows:
            writer.write(topics[name], stamp_ns, encode("ros1", text))
    return path


def _write_folder(path: Path, rows: Rows, storage: str, mode: str = "none") -> Path:
    path = path / "log"
    writer = FolderWriter(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
    writer.set_compression(CompressionMode[mode.upper()], CompressionFormat.ZSTD)
    with writer:
        topics = {
            name: writer.add_connection(name, _STRING, typestore=_STORES["cdr"])
            for name in dict.fromkeys(row[0] for row in rows)
        }
        for name, stamp_ns, text in rows:
            writer.write(topics[name], stamp_ns, encode("cdr", text))
    return path


def _write_mcap(path: Path, rows: Rows, compression: str, encoding: str, **options: Any) -> Path:
    path = path / "log.mcap"
    with path.open("wb") as stream:
        chosen = CompressionType[compression.upper()]
        writer = McapWriter(stream, CHUNK_BYTES, chosen, **options)
        writer.start({"cdr": "ros2", "ros1": "ros1"}.get(encoding, ""))
        form = {"cdr": "ros2msg", "ros1": "ros1msg", "json": "jsonschema"}[encoding]
        definition = b'{"type": "object"}' if encoding == "json" else b"string data\n"
        name = "Text" if encoding == "json" else _STRING
        schema = writer.register_schema(
            name.replace("/msg", "") if encoding == "ros1" else name, form, definition
        )
        topics = {
            topic: writer.register_channel(topic, encoding, schema)
            for topic in dict.fromkeys(row[0] for row in rows)
        }
        for topic, stamp_ns, text in rows:
            writer.add_message(topics[topic], stamp_ns, encode(encoding, text), stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path


WRITERS: dict[str, Callable[[Path, Rows], Path]] = {
    "bag-none": lambda path, rows: _write_bag(path, rows, "none"),
    "bag-bz2": lambda path, rows: _write_bag(path, rows, "bz2"),
    "bag-lz4": lambda path, rows: _write_bag(path, rows, "lz4"),
    "sqlite3": lambda path, rows: _write_folder(path, rows, "sqlite3"),
    "sqlite3-file": lambda path, rows: _write_folder(path, rows, "sqlite3", "file"),
    "sqlite3-message": lambda path, rows: _write_folder(path, rows, "sqlite3", "message"),
    "folder-mcap": lambda path, rows: _write_folder(path, rows, "mcap"),
    "folder-mcap-file": lambda path, rows: _write_folder(path, rows, "mcap", "file"),
    "folder-mcap-message": lambda path, rows: _write_folder(path, rows, "mcap", "message"),
    "folder-mcap-storage": lambda path, rows: _write_folder(path, rows, "mcap", "storage"),
    "mcap-none": lambda path, rows: _write_mcap(path, rows, "none", "cdr"),
    "mcap-lz4": lambda path, rows: _write_mcap(path, rows, "lz4", "cdr"),
    "mcap-zstd": lambda path, rows: _write_mcap(path, rows, "zstd", "cdr"),
    "mcap-ros1": lambda path, rows: _write_mcap(path, rows, "zstd", "ros1"),
    "mcap-json": lambda path, rows: _write_mcap(path, rows, "zstd", "json"),
    "mcap-unchunked": lambda path, rows: _write_mcap(path, rows, "none", "cdr", use_chunking=False),
    "mcap-no-index": lambda path, rows: _write_mcap(
        path, rows, "zstd", "cdr", index_types=IndexType.NONE
    ),
    "mcap-no-summary": lambda path, rows: _write_mcap(
        path,
        rows,
        "lz4",
        "cdr",
        index_types=IndexType.NONE,
        repeat_channels=False,
        repeat_schemas=False,
        use_statistics=False,
        use_summary_offsets=False,
    ),
}


@pytest.fixture(params=list(WRITERS))
def log_kind(request: pytest.FixtureRequest) -> str:
    """Return the name of every kind of log, one after the other."""
    kind: str = request.param
    return kind


@pytest.fixture
def write_log(tmp_path: Path) -> WriteLog:
    """Return a function that writes (topic, stamp, text) rows as a log of a kind."""

    def write(kind: str, rows: Rows) -> Path:
        folder = tmp_path / f"written-{len(list(tmp_path.iterdir()))}"
        folder.mkdir()
        return WRITERS[kind](folder, rows)

    return write
