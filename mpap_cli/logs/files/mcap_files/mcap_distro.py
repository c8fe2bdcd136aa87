"""Which ROS distribution recorded an MCAP file, as rosbag2 writes it down there."""

import re
import struct
from collections.abc import Iterable
from io import BytesIO
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Metadata, MetadataIndex

from mpap_cli.logs.files.chunked.chunks import BrokenRecordError, read_up_to, seek_to
from mpap_cli.logs.files.mcap_files.mcap_records import RECORD

_NAME = "rosbag2"
_KEY = "ROS_DISTRO"
_SERIALIZED = "serialized_metadata"
_DISTRO = re.compile(r"^\s*ros_distro:\s*['\"]?(\w+)", re.MULTILINE)
_MOST_BYTES = 1 << 24


def read_distro(stream: BinaryIO, indexes: Iterable[bytes]) -> str:
    """Return the name of the distribution.

    Parameters
    ----------
    stream : BinaryIO
        The file.
    indexes : iterable of bytes
        Contents of the records of its summary that say where metadata are.

    Returns
    -------
    str
        Empty where it is not recorded, or broken.
    """
    for content in indexes:
        try:
            index = MetadataIndex.read(ReadDataStream(BytesIO(content)))
            if index.name != _NAME or index.length > _MOST_BYTES:
                continue
            seek_to(stream, index.offset)
            record = read_up_to(stream, index.length)
            if record[:1] != bytes([Opcode.METADATA]):
                continue
            told = Metadata.read(ReadDataStream(BytesIO(record[RECORD.size :]))).metadata
        except (BrokenRecordError, McapError, struct.error, ValueError):
            continue
        found = _DISTRO.search(told.get(_SERIALIZED, ""))
        distro = told.get(_KEY, "") or (found[1] if found else "")
        if distro:
            return distro
    return ""
