"""rosbag2 folders written record by record: one storage file, and its metadata.yaml."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any, Protocol

from mpap_cli.logs.files.ros2 import METADATA
from mpap_cli.logs.passthrough.records import (
    McapChannel,
    Origin,
    RawChannel,
    Record,
    TableChannel,
)

_ZSTD = b"\x28\xb5\x2f\xfd"
_NAMED_QOS = re.compile(r"\bhistory:\s*[a-z]")
_OLD, _NEW = 5, 9  # with numbers for the kinds of QoS, with names
_PIECE_BYTES = 1 << 20


class RawStorage(Protocol):
    """A storage file that is being written."""

    def add_channel(self, stored: Any) -> int:
        """Announce a channel; return its number."""
        ...

    def write(self, number: int, record: Record) -> None:
        """Append a record."""
        ...

    def close(self) -> None:
        """Finish the file."""
        ...

    def abort(self) -> None:
        """Let go of the file."""
        ...


class RawFolderWriter:
    """Writes a rosbag2 folder; memory does not grow with its messages.

    Parameters
    ----------
    path : Path
        Folder that is there, and empty.
    origin : Origin
        Version, distribution, compression and so on are those of the log that is copied.
    open_storage : callable
        Opens the storage file.
    """

    def __init__(
        self, path: Path, origin: Origin, open_storage: Callable[[Path], RawStorage]
    ) -> None:
        self._origin = origin
        self._suffix = ".mcap" if origin.container == "rosbag2/mcap" else ".db3"
        self._file = path / f"{path.name}_0{self._suffix}"
        self._storage = open_storage(self._file)
        self._channels: list[tuple[RawChannel, int]] = []
        self._counts: list[int] = []
        self._bounds_ns: tuple[int, int] | None = None
        self._told: dict[tuple[str, str], dict[str, Any]] = {}
        for entry in origin.metadata.get("topics_with_message_count") or []:
            topic = entry.get("topic_metadata") or {}
            self._told[str(topic.get("name")), str(topic.get("type"))] = topic
        self._mode = str(origin.metadata.get("compression_mode") or "").lower()

    def add_channel(self, channel: RawChannel) -> int:
        """Announce a channel; return its number."""
        channel = self._with_told_qos(channel)
        self._channels.append((channel, self._storage.add_channel(channel.stored)))
        self._counts.append(0)
        return len(self._channels) - 1

    def _with_told_qos(self, channel: RawChannel) -> RawChannel:
        """Fill in the QoS that only metadata.yaml still tells; readers compare the two."""
        stored = channel.stored
        told = self._told.get((channel.topic, channel.msgtype), {}).get("offered_qos_profiles")
        if not isinstance(stored, TableChannel) or _qos(channel) or not isinstance(told, str):
            return channel
        topic = {**stored.topic, "offered_qos_profiles": told}
        return replace(channel, stored=replace(stored, topic=topic))

    def write(self, number: int, record: Record) -> None:
        """Append a record."""
        if self._bounds_ns is None and not self._origin.metadata:
            # CDR begins with a zero
            self._mode = "message" if record.payload.startswith(_ZSTD) else ""
        self._storage.write(self._channels[number][1], record)
        self._counts[number] += 1
        first_ns, last_ns = self._bounds_ns or (record.stamp_ns, record.stamp_ns)
        self._bounds_ns = min(first_ns, record.stamp_ns), max(last_ns, record.stamp_ns)

    def close(self) -> None:
        """Finish the storage file, pack it if its origin was, and write metadata.yaml."""
        self._storage.close()
        if self._mode == "file":
            self._file = _packed(self._file)
        from ruamel.yaml import YAML  # noqa: PLC0415  # only folders need it

        text, yaml = StringIO(), YAML(typ="safe", pure=True)
        yaml.default_flow_style = False
        yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]  # typed as None
        yaml.dump({"rosbag2_bagfile_information": self._metadata()}, text)
        (self._file.parent / METADATA).write_text(text.getvalue(), encoding="utf-8")

    def abort(self) -> None:
        """Let go of the file."""
        self._storage.abort()

    def _metadata(self) -> dict[str, Any]:
        """Return what metadata.yaml says."""
        told = self._origin.metadata
        first_ns, last_ns = self._bounds_ns or (0, 0)
        is_packed = self._mode in {"file", "message"}
        span = {
            "duration": {"nanoseconds": last_ns - first_ns},
            "starting_time": {"nanoseconds_since_epoch": first_ns},
            "message_count": sum(self._counts),
        }
        version = told.get("version") or (_NEW if self._has_named_qos() else _OLD)
        metadata = {
            "version": version,
            "storage_identifier": "mcap" if self._suffix == ".mcap" else "sqlite3",
            "relative_file_paths": [self._file.name],
            **span,
            "topics_with_message_count": self._topics(version),
            "compression_format": "zstd" if is_packed else "",
            "compression_mode": str(told.get("compression_mode") or self._mode)
            if is_packed
            else "",
            "files": [{"path": self._file.name, **span}],
        }
        kept = {key: told[key] for key in ("custom_data", "ros_distro") if key in told}
        return {**metadata, **kept}

    def _has_named_qos(self) -> bool:
        """Tell whether QoS is written as newer distributions do."""
        return any(_NAMED_QOS.search(_qos(channel)) for channel, _ in self._channels)

    def _topics(self, version: int) -> list[dict[str, Any]]:
        """List the topics with their counts; channels of one topic and type are one."""
        counted: dict[tuple[str, str], dict[str, Any]] = {}
        for (channel, _), count in zip(self._channels, self._counts, strict=True):
            key = channel.topic, channel.msgtype
            own = self._told.get(key) or _topic_metadata(channel, version)
            entry = counted.setdefault(key, {"topic_metadata": own, "message_count": 0})
            entry["message_count"] += count
        return list(counted.values())


def _qos(channel: RawChannel) -> str:
    """Return the offered profiles of a channel as text."""
    stored = channel.stored
    if isinstance(stored, TableChannel):
        return stored.topic.get("offered_qos_profiles", "")
    if isinstance(stored, McapChannel):
        return stored.channel.metadata.get("offered_qos_profiles", "")
    return ""


def _topic_metadata(channel: RawChannel, version: int) -> dict[str, Any]:
    """Say of a channel what metadata.yaml would, where there was none."""
    stored, encoding, digest = channel.stored, "cdr", ""
    if isinstance(stored, TableChannel):
        encoding = stored.topic["serialization_format"]
        digest = stored.topic.get("type_description_hash", "")
    elif isinstance(stored, McapChannel):
        encoding = stored.channel.message_encoding
        digest = stored.channel.metadata.get("topic_type_hash", "")
    found: Mapping[str, Any] = {
        "name": channel.topic,
        "type": channel.msgtype,
        "serialization_format": encoding,
        "offered_qos_profiles": _as_version(_qos(channel), version),
    }
    return {**found, "type_description_hash": digest} if version >= _NEW else dict(found)


def _as_version(qos: str, version: int) -> object:
    """Return profiles as text, or from version 9 on as the list that the text holds."""
    if version < _NEW:
        return qos
    from ruamel.yaml import YAML  # noqa: PLC0415  # only folders need it
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    try:
        return YAML(typ="safe", pure=True).load(qos) or []
    except (YAMLError, RecursionError):
        return []


def _packed(path: Path) -> Path:
    """Pack a file as a whole, in place of it."""
    from zstandard import ZstdCompressor  # noqa: PLC0415  # few logs need it

    packed = path.with_name(f"{path.name}.zstd")
    with path.open("rb") as source, packed.open("xb") as target:
        ZstdCompressor().copy_stream(source, target, read_size=_PIECE_BYTES)
    path.unlink()
    return packed
