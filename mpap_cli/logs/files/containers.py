"""What kind of file a log is: its first bytes decide, not its name."""

from collections.abc import Callable
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.files import bag_records, mcap_records
from mpap_cli.logs.files.mcap import open_mcap
from mpap_cli.logs.files.ros1 import open_bag
from mpap_cli.logs.files.sqlite import open_sqlite
from mpap_cli.logs.raw import LogFile, Reading

LFS_MAGIC = b"version https://git-lfs"
MAGICS: dict[str, bytes] = {
    "bag": bag_records.MAGIC,
    "mcap": mcap_records.MAGIC,
    "sqlite3": b"SQLite format 3\x00",
    "zstd": b"\x28\xb5\x2f\xfd",
}

READERS: dict[str, Callable[[Path, Reading], LogFile]] = {
    "bag": open_bag,
    "mcap": open_mcap,
    "sqlite3": open_sqlite,
}
"""How to open one file, by container."""

_COPY_BYTES = 1 << 20


def container_of(path: Path) -> str:
    """Return the container of a file: bag, mcap, sqlite3 or zstd (a packed one of these).

    Raises
    ------
    LogError
        If the file is missing, empty, a Git LFS pointer or no log.
    """
    try:
        with path.open("rb") as stream:
            head = stream.read(64)
    except OSError as err:
        msg = f"{path}: {(err.strerror or str(err)).lower()}"
        raise LogError(msg) from err
    if not head:
        msg = f"{path.name}: the file is empty"
        raise LogError(msg)
    for kind, magic in MAGICS.items():
        if head.startswith(magic):
            return kind
    if head.startswith(LFS_MAGIC):
        msg = f"{path.name}: a Git LFS pointer, not the log; fetch the log with 'git lfs pull'"
        raise LogError(msg)
    msg = f"{path.name}: neither a ROS bag, a rosbag2 database nor an MCAP file"
    raise LogError(msg)


def open_file(path: Path, reading: Reading) -> tuple[str, LogFile]:
    """Open one file of a log, unpacking it first if it is packed as a whole.

    Returns
    -------
    str
        Its container: bag, mcap or sqlite3.
    LogFile
        Its messages.

    Raises
    ------
    LogError
        If it cannot be read at all, or is damaged and read strictly.
    """
    kind = container_of(path)
    if kind == "zstd":
        path = _unpack(path, reading)
        kind = container_of(path)
    if kind == "zstd":
        msg = f"{path.name}: packed twice; unpack it with 'zstd -d'"
        raise LogError(msg)
    return kind, READERS[kind](path, reading)


def _unpack(path: Path, reading: Reading) -> Path:
    """Unpack a file into the private folder; of a broken one, what comes out."""
    import zstandard  # noqa: PLC0415  # few logs need it

    unpacked = reading.scratch() / (path.stem if path.suffix == ".zstd" else path.name)
    try:
        with path.open("rb") as source, unpacked.open("wb") as target:
            reader = zstandard.ZstdDecompressor().stream_reader(source, read_across_frames=True)
            try:
                while block := reader.read(_COPY_BYTES):
                    target.write(block)
            except zstandard.ZstdError as err:
                if not target.tell():
                    msg = f"{path.name}: zstd cannot unpack it ({err})"
                    raise LogError(msg) from err
    except OSError as err:
        msg = f"{path.name}: cannot unpack it ({err.strerror}); name a folder with room in TMPDIR"
        raise LogError(msg) from err
    megabytes = unpacked.stat().st_size / 1e6
    reading.warn(f"{path.name}: unpacked to a temporary folder ({megabytes:.1f} MB)")
    return unpacked
