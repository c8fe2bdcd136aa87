"""Open a log of any container; find logs by the words of a command line."""

import glob
from collections.abc import Sequence
from pathlib import Path

from mpap_cli.errors import LogError
from mpap_cli.logs.files.containers import READERS, open_file
from mpap_cli.logs.files.definitions_store import DefinitionsStore
from mpap_cli.logs.files.log_stream import LogStream
from mpap_cli.logs.files.ros2 import METADATA, Folder, open_folder
from mpap_cli.logs.raw import Damage, LogReader, PayloadError, RawMessage, Reading, Topic
from mpap_cli.logs.remote.paths import LogPath, RemotePath, paths_of_url
from mpap_cli.logs.remote.urls import is_url, local_path

__all__ = [
    "READERS",
    "Damage",
    "LogPath",
    "LogReader",
    "PayloadError",
    "RawMessage",
    "Topic",
    "expand_paths",
    "open_log",
]


def open_log(path: LogPath, *, msgs: Sequence[Path] = (), strict: bool = False) -> LogReader:
    """Open a log; nothing but its index is read, where it has one.

    Parameters
    ----------
    path : Path or RemotePath
        A .bag, .mcap or .db3 file (also packed with zstd), a rosbag2 folder, or its
        metadata.yaml. The first bytes decide, not the name.
    msgs : sequence of Path
        Folders with message definitions.
    strict : bool
        The first damage is an error; otherwise it is noted and the rest is used.

    Returns
    -------
    LogReader
        Use it in a ``with`` statement: a log that had to be unpacked or repaired lies in a
        temporary folder until then.

    Raises
    ------
    LogError
        If the log is missing, empty, no log, or beyond repair.
    UsageError
        If a folder of ``msgs`` does not exist.
    """
    reading = Reading(strict=strict)
    path, folder = open_files(path, reading)
    try:
        distro = folder.ros_distro or folder.files[0].ros_distro
        return LogStream(path, folder, reading, DefinitionsStore(path.name, msgs, distro))
    except BaseException:
        reading.close()
        raise


def open_files(path: LogPath, reading: Reading) -> tuple[LogPath, Folder]:
    """Open the files of a log.

    Parameters
    ----------
    path : Path or RemotePath
        As for :func:`open_log`.
    reading : Reading
        Gets damage and warnings; closed if the log cannot be opened.

    Returns
    -------
    Path or RemotePath
        The log: the folder of a metadata.yaml.
    Folder
        Its files.

    Raises
    ------
    LogError
        If the log is missing, empty, no log, or beyond repair.
    """
    path = _log_path(path)
    try:
        if path.is_dir():
            return path, open_folder(path, reading)
        kind, file = open_file(path, reading)
        return path, Folder(kind, (file,), {}, "")
    except OSError as err:
        reading.close()
        msg = f"{path.name}: cannot be read ({err.strerror or err})"
        raise LogError(msg) from err
    except BaseException:
        reading.close()
        raise


def _log_path(path: LogPath) -> LogPath:
    """Return the folder of a metadata.yaml, other paths as they are."""
    if path.name == METADATA and (isinstance(path, RemotePath) or path.is_file()):
        return path.absolute().parent
    return path


def expand_paths(words: Sequence[str]) -> list[LogPath]:
    """Turn the words of a command line into paths of logs.

    Parameters
    ----------
    words : sequence of str
        Paths, globs (``**`` goes through subfolders), or the metadata.yaml of a folder;
        each may be a URL.

    Returns
    -------
    list of Path or RemotePath
        In the order given, the matches of a glob by name; each log once.

    Raises
    ------
    LogError
        If a word matches nothing; a URL without a pattern is not asked for yet.
    """
    found: dict[LogPath, None] = {}
    for given in words:
        word = str(local_path(given) or given)
        if is_url(word):
            found.update(dict.fromkeys(_log_path(path) for path in paths_of_url(word)))
            continue
        path = Path(word)
        # Path.glob takes no absolute patterns.
        names = [] if path.exists() else sorted(glob.glob(word, recursive=True))  # noqa: PTH207
        matches = [path] if path.exists() else [Path(name) for name in names]
        if not matches:
            what = "matches no file or folder" if glob.has_magic(word) else "no such file or folder"
            msg = f"{word}: {what}"
            raise LogError(msg)
        found.update(dict.fromkeys(_log_path(match) for match in matches))
    return list(found)
