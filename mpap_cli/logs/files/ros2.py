"""rosbag2 folders: metadata.yaml and the files beside it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from mpap_cli.errors import LogError
from mpap_cli.logs.files.containers import container_of, on_this_machine, open_file
from mpap_cli.logs.files.databases.sqlite import open_sqlite
from mpap_cli.logs.raw import Damage, LogFile, Reading, ros2_name
from mpap_cli.logs.remote.paths import LogPath, first_bytes

METADATA = "metadata.yaml"
_MAX_METADATA_BYTES = 1 << 26


@dataclass(frozen=True, slots=True)
class Metadata:
    """What metadata.yaml says: base names of the files, and messages by topic and type."""

    files: tuple[str, ...] = ()
    counts: Mapping[tuple[str, str], int] = field(default_factory=dict)
    ros_distro: str = ""


@dataclass(frozen=True, slots=True)
class Folder:
    """A folder opened: its files, and counts by topic and type where the files have none."""

    container: str
    files: tuple[LogFile, ...]
    counts: Mapping[tuple[str, str], int]
    ros_distro: str


def storage_files(folder: LogPath) -> tuple[list[LogPath], str]:
    """Find the files of a rosbag2 folder that hold messages.

    Returns
    -------
    list of Path or RemotePath
        What metadata.yaml names, where all of it is there; else every storage file.
    str
        What is wrong with metadata.yaml; empty if nothing is.

    Raises
    ------
    LogError
        If there is no such file, or there are several kinds and nothing tells which to read.
    """
    metadata, problem = read_metadata(folder)
    named = [folder / name for name in metadata.files]
    if named and all(path.is_file() for path in named):
        return named, problem
    found = sorted(path for path in folder.iterdir() if _is_storage(path))
    if not found:
        msg = f"{folder.name}: no .db3 or .mcap file in this folder; name a log file or its folder"
        raise LogError(msg)
    kinds = {_suffix(path) for path in found}
    if len(kinds) > 1:
        msg = (
            f"{folder.name}: holds both {' and '.join(sorted(kinds))} files; name one of the files"
        )
        raise LogError(msg)
    if named:
        lost = next(path.name for path in named if not path.is_file())
        names = ", ".join(path.name for path in found)
        problem = f"{METADATA} names {lost}, which is not there"
        problem += f"; reading {names}"
    return found, problem


def _suffix(path: LogPath) -> str:
    """Return .db3 or .mcap, also of a packed file; other names as they end."""
    return Path(path.stem).suffix if path.suffix == ".zstd" else path.suffix


def _is_storage(path: LogPath) -> bool:
    """Tell whether a file looks like one that rosbag2 wrote, even if it is empty."""
    if not path.is_file():
        return False
    if _suffix(path) in {".db3", ".mcap"}:
        return True
    try:
        return container_of(path) in {"sqlite3", "mcap"}
    except LogError:
        return False


def read_metadata(folder: LogPath) -> tuple[Metadata, str]:
    """Read metadata.yaml.

    Returns
    -------
    Metadata
        Empty where there is no such file, or none that can be understood.
    str
        What is wrong with it; empty if nothing is.
    """
    parsed, problem = load_metadata(folder)
    if problem:
        return Metadata(), problem
    try:
        return _parse_metadata(parsed), ""
    except (LookupError, TypeError, ValueError, AttributeError):
        return Metadata(), f"{METADATA} cannot be understood"


def load_metadata(folder: LogPath) -> tuple[dict[str, Any], str]:
    """Load metadata.yaml as it stands.

    Returns
    -------
    dict
        Empty where there is no such file, or none that can be understood.
    str
        What is wrong with it; empty if nothing is.
    """
    path = folder / METADATA
    try:
        content = first_bytes(path, _MAX_METADATA_BYTES + 1)
        if len(content) > _MAX_METADATA_BYTES:
            return {}, f"{METADATA} is too large"
        text = content.decode()
    except FileNotFoundError:
        return {}, f"{METADATA} is missing"
    except (OSError, UnicodeDecodeError) as err:
        return {}, f"{METADATA} cannot be read ({err})"
    from ruamel.yaml import YAML  # noqa: PLC0415  # only folders need it
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    try:
        parsed = YAML(typ="safe", pure=True).load(text)["rosbag2_bagfile_information"]
    except (YAMLError, LookupError, TypeError, ValueError, AttributeError, RecursionError):
        parsed = None
    return (parsed, "") if isinstance(parsed, dict) else ({}, f"{METADATA} cannot be understood")


def _parse_metadata(parsed: Any) -> Metadata:
    """Take what is needed out of the parsed file."""
    counts: dict[tuple[str, str], int] = {}
    for entry in parsed.get("topics_with_message_count") or []:
        topic = entry["topic_metadata"]
        key = (str(topic["name"]), ros2_name(str(topic["type"])))
        counts[key] = counts.get(key, 0) + int(entry["message_count"])
    files = tuple(PurePosixPath(str(name)).name for name in parsed["relative_file_paths"])
    return Metadata(files, counts, str(parsed.get("ros_distro") or ""))


def open_folder(folder: LogPath, reading: Reading) -> Folder:
    """Open every file of a rosbag2 folder.

    Parameters
    ----------
    folder : Path or RemotePath
        Folder with or without a metadata.yaml.
    reading : Reading
        Gets damage and warnings.

    Returns
    -------
    Folder
        The files that can be read.

    Raises
    ------
    LogError
        If none can be read; read strictly, if one cannot.
    """
    paths, problem = storage_files(folder)
    metadata, _ = read_metadata(folder)
    if problem:
        reading.warn(f"{folder.name}: {problem}")
    counted = _open_uncounted(paths, metadata, reading)
    if counted is not None:
        return Folder("rosbag2/sqlite3", counted, metadata.counts, metadata.ros_distro)
    kinds, files, errors = [], [], []
    for path in paths:
        try:
            kind, opened = open_file(path, reading)
        except LogError as err:
            errors.append(err)
            continue
        kinds.append(kind)
        files.append(opened)
    if not files:
        raise errors[0]
    if errors:
        text = f"{folder.name}: {len(errors)} of {len(paths)} files left out ({errors[0]})"
        reading.add_damage(Damage(folder.name, "file", len(errors), text))
    stated, held = sum(metadata.counts.values()), sum(opened.n_messages for opened in files)
    if metadata.counts and stated != held and not reading.damage and not problem:
        text = f"{folder.name}: {METADATA} counts {stated:,} messages, the files hold {held:,}"
        reading.warn(text)
    return Folder(f"rosbag2/{kinds[0]}", tuple(files), {}, metadata.ros_distro)


def _open_uncounted(
    paths: list[LogPath], metadata: Metadata, reading: Reading
) -> tuple[LogFile, ...] | None:
    """Open databases without counting messages by topic, if metadata.yaml counts all of them."""
    if not metadata.counts or [path.name for path in paths] != list(metadata.files):
        return None
    try:
        if any(container_of(path) != "sqlite3" for path in paths):
            return None
        files = tuple(
            open_sqlite(on_this_machine(path, "sqlite3", reading), reading, count=False)
            for path in paths
        )
    except LogError:
        return None
    return files if sum(f.n_messages for f in files) == sum(metadata.counts.values()) else None
