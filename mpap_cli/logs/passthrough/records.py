"""What is copied from one log into another without being understood."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from mcap.records import Channel, Schema

LATCHED_NAMES = ("tf_static", "camera_info", "robot_description", "map")
"""Last parts of the names of topics that are published once, or whose last message goes on."""

_TRANSIENT_LOCAL = re.compile(r"\bdurability[\"']?:\s*[\"']?(1\b|transient_local)")
_NO_TEXT: Mapping[str, str] = {}


class Record(NamedTuple):
    """One message: number of its channel, its stamps and its bytes.

    ``published_ns`` and ``sequence`` are those of an MCAP file; elsewhere the log time and 0.
    """

    channel: int
    stamp_ns: int
    published_ns: int
    sequence: int
    payload: bytes


@dataclass(frozen=True, slots=True)
class BagChannel:
    """A connection of a bag: the topic of its record, and the fields of its header."""

    topic: bytes
    fields: Mapping[bytes, bytes]


@dataclass(frozen=True, slots=True)
class McapChannel:
    """A channel of an MCAP file and its schema, if it has one; the ids are the file's own."""

    channel: Channel
    schema: Schema | None


@dataclass(frozen=True, slots=True)
class TableChannel:
    """Rows of a rosbag2 database by column: the topic, and the definition of its type."""

    topic: Mapping[str, str]
    definition: Mapping[str, str] = field(default_factory=dict)


Stored = BagChannel | McapChannel | TableChannel


@dataclass(frozen=True, slots=True)
class RawChannel:
    """One channel of a log; ``latched`` ones are repeated wherever a log is cut."""

    topic: str
    msgtype: str
    latched: bool
    stored: Stored


@dataclass(frozen=True, slots=True)
class Origin:
    """What a log says about itself as a whole.

    ``container`` is that of :class:`~mpap_cli.logs.raw.LogReader`; ``compression`` is that of
    its chunks (none, bz2, lz4, zstd). ``profile`` and ``library`` stand at the head of an MCAP
    file. ``metadata`` is what metadata.yaml says, empty where there is none. ``tables`` are
    the columns of the tables of a database, ``schema_row`` is the one row of its table schema.
    """

    container: str
    compression: str = "none"
    profile: str = ""
    library: str = ""
    metadata: Mapping[str, Any] = field(default_factory=dict)
    tables: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    schema_row: Mapping[str, Any] = field(default_factory=dict)


def is_latched(topic: str, *, latching: bytes = b"", qos: str = "") -> bool:
    """Tell whether the last message of a topic goes on to hold.

    Parameters
    ----------
    topic : str
        Its name.
    latching : bytes
        What the connection of a bag says.
    qos : str
        Offered profiles of ROS 2 as YAML.

    Examples
    --------
    >>> is_latched("/left/camera_info"), is_latched("/scan")
    (True, False)
    >>> is_latched("/plan", latching=b"1"), is_latched("/plan", qos="- durability: 1")
    (True, True)
    """
    named = topic.rsplit("/", 1)[-1] in LATCHED_NAMES
    return named or latching == b"1" or _TRANSIENT_LOCAL.search(qos) is not None
