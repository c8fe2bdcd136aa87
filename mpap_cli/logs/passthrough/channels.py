"""What a log of any container says about itself and its channels."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from mpap_cli.logs.files.chunked.chunks import ChunkedFile
from mpap_cli.logs.files.ros1_bags.bag_records import BagFormat
from mpap_cli.logs.files.ros2 import Folder, load_metadata
from mpap_cli.logs.passthrough.chunked_channels import (
    bag_channels,
    chunk_compression,
    mcap_channels,
    mcap_header,
)
from mpap_cli.logs.passthrough.records import (
    BagChannel,
    McapChannel,
    Origin,
    RawChannel,
    Stored,
    TableChannel,
    is_latched,
)
from mpap_cli.logs.passthrough.table_channels import read_tables, table_channels
from mpap_cli.logs.raw import LogFile, ros2_name
from mpap_cli.logs.remote.paths import LogPath

Numbers = dict[str, dict[int, int]]
_Key = tuple[Any, ...]


def channels_of(files: Sequence[LogFile]) -> tuple[tuple[RawChannel, ...], Numbers]:
    """Describe the channels of a log.

    Returns
    -------
    tuple of RawChannel
        Each once, however many files it runs through.
    Numbers
        By path and by the file's own id, the place of a channel among these.
    """
    places: dict[_Key, int] = {}
    channels: list[RawChannel] = []
    numbers: Numbers = {}
    for file in files:
        seen: Counter[_Key] = Counter()
        own = numbers.setdefault(str(file.path), {})
        for number, stored in sorted(_stored_channels(file).items()):
            key = _key_of(stored)
            seen[key] += 1
            # two channels of one file stay two, even if nothing tells them apart
            place = places.setdefault((seen[key], *key), len(channels))
            if place == len(channels):
                channels.append(_describe(stored))
            own[number] = place
    return tuple(channels), numbers


def _stored_channels(file: LogFile) -> Mapping[int, Stored]:
    """Return what one file says of its channels."""
    if not isinstance(file, ChunkedFile):
        return table_channels(file, read_tables(file))
    return bag_channels(file) if isinstance(file.layout, BagFormat) else mcap_channels(file)


def _key_of(stored: Stored) -> _Key:
    """Return all that tells channels apart."""
    if isinstance(stored, BagChannel):
        return (stored.topic, *sorted(stored.fields.items()))
    if isinstance(stored, TableChannel):
        return (*sorted(stored.topic.items()), *sorted(stored.definition.items()))
    channel, schema = stored.channel, stored.schema
    described = (schema.name, schema.encoding, schema.data) if schema else ()
    metadata = sorted(channel.metadata.items())
    return (channel.topic, channel.message_encoding, described, *metadata)


def _describe(stored: Stored) -> RawChannel:
    """Name topic and type of a channel, and tell whether its messages go on to hold."""
    if isinstance(stored, BagChannel):
        topic = stored.topic.decode(errors="replace")
        msgtype = stored.fields.get(b"type", b"").decode(errors="replace")
        latched = is_latched(topic, latching=stored.fields.get(b"latching", b""))
    elif isinstance(stored, McapChannel):
        topic = stored.channel.topic
        msgtype = stored.schema.name if stored.schema else ""
        latched = is_latched(topic, qos=stored.channel.metadata.get("offered_qos_profiles", ""))
    else:
        topic, msgtype = stored.topic["name"], stored.topic["type"]
        latched = is_latched(topic, qos=stored.topic.get("offered_qos_profiles", ""))
    return RawChannel(topic, ros2_name(msgtype), latched, stored)


def origin_of(path: LogPath, folder: Folder) -> Origin:
    """Return what a log says about itself as a whole; of several files, the first tells."""
    metadata = load_metadata(path)[0] if path.is_dir() else {}
    file = folder.files[0]
    if isinstance(file, ChunkedFile):
        is_bag = isinstance(file.layout, BagFormat)
        profile, library = ("", "") if is_bag else mcap_header(file.path)
        return Origin(
            container=folder.container,
            compression=chunk_compression(file),
            profile=profile,
            library=library,
            metadata=metadata,
        )
    tables = read_tables(file)
    row = next(iter(tables["schema"].rows), {}) if "schema" in tables else {}
    if not row or "topics" not in tables:
        # what is broken is written as the oldest databases are
        tables.pop("schema", None)
    return Origin(
        container=folder.container,
        metadata=metadata,
        tables={name: table.columns for name, table in tables.items()},
        schema_row=row,
    )
