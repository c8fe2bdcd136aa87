"""Small logs of every container, with chunks so small that there are many, to be damaged."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter

from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.reader import open_log
from mpap_cli.simulation.scenario import simulate
from mpap_cli.simulation.settings import SimulationParams

CHUNK_BYTES = 16_384

_MCAP_SCHEMAS = {"cdr": "ros2msg", "ros1": "ros1msg", "json": "jsonschema"}


def _write_bag(path: Path, reader: LogReader, chunk_bytes: int, compression: str) -> None:
    """Write a .bag; compression: none, lz4 or bz2."""
    writer = BagWriter(path)
    writer.chunk_threshold = chunk_bytes
    if compression != "none":
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    with writer:
        numbers = {
            topic.name: writer.add_connection(
                topic.name, topic.msgtype, msgdef=topic.definition, md5sum="*"
            )
            for topic in reader.topics
        }
        for topic, stamp_ns, payload in reader.messages(list(numbers)):
            writer.write(numbers[topic.name], stamp_ns, payload)


def _write_mcap(  # noqa: PLR0913  # one word for each thing that differs
    path: Path,
    reader: LogReader,
    chunk_bytes: int,
    compression: str,
    *,
    chunked: bool = True,
    crcs: bool = True,
    most_bytes: int = 1 << 40,
) -> None:
    """Write an MCAP file; compression: none, lz4 or zstd."""
    chosen = CompressionType[compression.upper()]
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_bytes, chosen, use_chunking=chunked, enable_crcs=crcs)
        writer.start()
        numbers = {}
        for topic in reader.topics:
            form = topic.definition_format or _MCAP_SCHEMAS.get(topic.encoding, "")
            schema = writer.register_schema(topic.msgtype, form, topic.definition.encode())
            numbers[topic.name] = writer.register_channel(topic.name, topic.encoding, schema)
        for topic, stamp_ns, payload in reader.messages(list(numbers)):
            if stream.tell() + len(payload) > most_bytes:
                break
            writer.add_message(numbers[topic.name], stamp_ns, payload, stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type


Write = Callable[[Path, LogReader, int], None]


def _bag(compression: str) -> Write:
    return partial(_write_bag, compression=compression)


def _mcap(compression: str, *, chunked: bool = True, crcs: bool = True) -> Write:
    return partial(_write_mcap, compression=compression, chunked=chunked, crcs=crcs)


# By name: the log that the simulator writes, and how its messages are written anew.
_REWRITTEN: dict[str, tuple[str, Write]] = {
    "none.bag": ("bag", _bag("none")),
    "lz4.bag": ("bag", _bag("lz4")),
    "bz2.bag": ("bag", _bag("bz2")),
    "zstd.mcap": ("mcap", _mcap("zstd")),
    "lz4.mcap": ("mcap", _mcap("lz4")),
    "none.mcap": ("mcap", _mcap("none")),
    "no-crc.mcap": ("mcap", _mcap("none", crcs=False)),
    "unchunked.mcap": ("mcap", _mcap("none", chunked=False)),
    "json.mcap": ("mcap-json", _mcap("zstd")),
}
# By name: container and compression, as the simulator writes it.
_SIMULATED = {
    "sqlite3": ("rosbag2-sqlite3", "none"),
    "sqlite3-zstd-file": ("rosbag2-sqlite3", "zstd-file"),
    "sqlite3-zstd-message": ("rosbag2-sqlite3", "zstd-message"),
    "rosbag2-mcap": ("rosbag2-mcap", "zstd-storage"),
    "rosbag2-mcap-zstd-file": ("rosbag2-mcap", "zstd-file"),
}
KINDS = (*_REWRITTEN, *_SIMULATED)


def write_logs(
    folder: Path, seconds: float, kinds: tuple[str, ...] = KINDS, chunk_bytes: int = CHUNK_BYTES
) -> list[Path]:
    """Write one simulated drive in every container.

    Parameters
    ----------
    folder : Path
        Where the logs go, and those that they are made from.
    seconds : float
        Length of the drive.
    kinds : tuple of str
        Some of `KINDS`.
    chunk_bytes : int
        Size of chunks, where the container lets one choose.

    Returns
    -------
    list of Path
        Files and rosbag2 folders, named as the kinds are.
    """
    sources = folder / "sources"
    sources.mkdir()
    for kind in kinds:
        if kind in _SIMULATED:
            container, compression = _SIMULATED[kind]
            _simulate(folder / kind, seconds, container, compression)
            continue
        container, write = _REWRITTEN[kind]
        source = sources / container
        if not source.exists():
            _simulate(source, seconds, container, None)
        with open_log(source) as reader:
            write(folder / kind, reader, chunk_bytes)
    return [folder / kind for kind in kinds]


def write_plain(source: Path, path: Path, most_bytes: int) -> None:
    """Copy the first messages of a log into an MCAP file without compression and checksums.

    Raises
    ------
    MpapError
        If the source is no log.
    """
    with open_log(source) as reader:
        _write_mcap(path, reader, CHUNK_BYTES, "none", crcs=False, most_bytes=most_bytes)


def _simulate(path: Path, seconds: float, container: str, compression: str | None) -> None:
    """Write a log without its truth."""
    params = SimulationParams(
        seed=3, duration_s=seconds, container=container, compression=compression
    )
    simulate(path, params).truth_path.unlink()
