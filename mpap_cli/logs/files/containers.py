"""What kind of file a log is: its first bytes decide, not its name."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpap_cli.errors import LogError, require_finite
from mpap_cli.logs.files.chunked.compression import MAX_CHUNK_BYTES
from mpap_cli.logs.files.databases.sqlite import UNFINISHED, open_sqlite
from mpap_cli.logs.files.mcap_files import mcap_records
from mpap_cli.logs.files.mcap_files.mcap import open_mcap
from mpap_cli.logs.files.ros1_bags import bag_records
from mpap_cli.logs.files.ros1_bags.ros1 import open_bag
from mpap_cli.logs.raw import Damage, LogFile, Reading
from mpap_cli.logs.remote.copying import copy_beside, copy_whole
from mpap_cli.logs.remote.paths import LogPath
from mpap_cli.logs.remote.range_stream import NotInPlaceError

LFS_MAGIC = b"version https://git-lfs"
MAGICS: dict[str, bytes] = {
    "bag": bag_records.MAGIC,
    "mcap": mcap_records.MAGIC,
    "sqlite3": b"SQLite format 3\x00",
    "zstd": b"\x28\xb5\x2f\xfd",
}

READERS: dict[str, Callable[[Any, Reading], LogFile]] = {
    "bag": open_bag,
    "mcap": open_mcap,
    "sqlite3": open_sqlite,
}
"""How to open one file, by container."""

_WHOLE_ONLY = {"sqlite3": "a database is not read by pieces", "zstd": "it is packed as a whole"}
_PIECE_BYTES = 4096  # packed; so small that little comes out at once, whatever it is
_MOST_UNPACKED = 1000  # times the packed size


def container_of(path: LogPath) -> str:
    """Return the container of a file: bag, mcap, sqlite3 or zstd (a packed one of these).

    Raises
    ------
    LogError
        If the file is missing, empty, a Git LFS pointer or no log.
    """
    try:
        if isinstance(path, Path):
            require_finite(path)
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


def open_file(path: LogPath, reading: Reading) -> tuple[str, LogFile]:
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
    if kind in _WHOLE_ONLY or not (isinstance(path, Path) or path.facts.has_ranges):
        path = on_this_machine(path, kind, reading)
        if kind == "zstd":
            path = _unpack(path, reading)
            kind = container_of(path)
    if kind == "zstd":
        msg = f"{path.name}: packed twice; unpack it with 'zstd -d'"
        raise LogError(msg)
    try:
        return kind, READERS[kind](path, reading)
    except NotInPlaceError as err:
        if isinstance(path, Path):
            raise
        return kind, READERS[kind](copy_whole(path, reading, str(err)), reading)


def on_this_machine(path: LogPath, kind: str, reading: Reading) -> Path:
    """Return a file of a container that is not read by pieces, or a copy of it.

    Raises
    ------
    LogError
        If it cannot be copied.
    """
    if isinstance(path, Path):
        return path
    copy = copy_whole(path, reading, _WHOLE_ONLY.get(kind, "the server gives whole files only"))
    if kind == "sqlite3":
        copy_beside(path, reading, UNFINISHED)
    return copy


def _unpack(path: Path, reading: Reading) -> Path:
    """Unpack a file into the private folder; of a broken one, what comes out."""
    unpacked = reading.scratch() / (path.stem if path.suffix == ".zstd" else path.name)
    try:
        n_bytes, last, problem = _unpack_to(unpacked, path, None)
        if problem:
            # what comes before a broken place in the same piece is lost with it
            n_bytes, _, problem = _unpack_to(unpacked, path, last)
    except OSError as err:
        msg = f"{path.name}: cannot unpack it ({err.strerror}); name a folder with room in TMPDIR"
        raise LogError(msg) from err
    if problem and not n_bytes:
        msg = f"{path.name}: zstd cannot unpack it ({problem})"
        raise LogError(msg)
    reading.warn(f"{path.name}: unpacked to a temporary folder ({n_bytes / 1e6:.1f} MB)")
    if problem:
        text = f"{path.name}: broken off after {n_bytes:,} unpacked bytes ({problem})"
        reading.add_damage(Damage(path.name, "packed", n_bytes, text))
    return unpacked


def _unpack_to(unpacked: Path, path: Path, broken: int | None) -> tuple[int, int, str]:
    """Unpack piece by piece, the one that is known to be broken byte by byte.

    Returns
    -------
    int
        Bytes that came out.
    int
        Which piece was the last.
    str
        What is wrong with it; empty if nothing is.
    """
    import zstandard  # noqa: PLC0415  # few logs need it

    n_bytes = number = 0
    most = max(MAX_CHUNK_BYTES, _MOST_UNPACKED * path.stat().st_size)
    unpack = None
    with path.open("rb") as source, unpacked.open("wb") as target:
        try:
            for number, piece in enumerate(iter(lambda: source.read(_PIECE_BYTES), b"")):
                step = 1 if number == broken else _PIECE_BYTES
                parts = [piece[begin : begin + step] for begin in range(0, len(piece), step)]
                while parts:
                    unpack = unpack or zstandard.ZstdDecompressor().decompressobj()
                    n_bytes += target.write(unpack.decompress(parts.pop(0)))
                    if unpack.eof:  # another frame may follow
                        parts[:0] = [unpack.unused_data] if unpack.unused_data else []
                        unpack = None
                if n_bytes > most:
                    msg = f"{path.name}: unpacks to over {most:,} bytes, which no log does"
                    raise LogError(msg)
        except (zstandard.ZstdError, MemoryError) as err:
            return n_bytes, number, str(err) or "out of memory"
    return n_bytes, number, "" if unpack is None else "its end is missing"
