"""MCAP files written record by record: channels and schemas as they were, stamps too."""

from pathlib import Path

from mcap.writer import CompressionType
from mcap.writer import Writer as McapFile

from mpap_cli.logs.passthrough.records import McapChannel, Record

_COMPRESSIONS = {
    "none": CompressionType.NONE,
    "lz4": CompressionType.LZ4,
    "zstd": CompressionType.ZSTD,
}


class RawMcapWriter:
    """Writes an MCAP file; memory grows with its chunks, not with its messages.

    Parameters
    ----------
    path : Path
        File that is not there yet.
    compression : str
        none, lz4 or zstd.
    profile, library : str
        As at the head of the file that is copied.
    """

    def __init__(self, path: Path, compression: str, profile: str, library: str) -> None:
        self._stream = path.open("xb")
        self._mcap = McapFile(self._stream, compression=_COMPRESSIONS[compression])
        self._mcap.start(profile, library)
        self._schemas: dict[tuple[str, str, bytes], int] = {}

    def add_channel(self, stored: McapChannel) -> int:
        """Announce a channel and its schema; return its number."""
        channel, schema = stored.channel, stored.schema
        schema_id = 0
        if schema is not None:
            key = (schema.name, schema.encoding, schema.data)
            if key not in self._schemas:
                self._schemas[key] = self._mcap.register_schema(*key)
            schema_id = self._schemas[key]
        return self._mcap.register_channel(
            channel.topic, channel.message_encoding, schema_id, dict(channel.metadata)
        )

    def write(self, number: int, record: Record) -> None:
        """Append a message."""
        self._mcap.add_message(
            number, record.stamp_ns, record.payload, record.published_ns, record.sequence
        )

    def close(self) -> None:
        """Write the summary."""
        self._mcap.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
        self._stream.close()

    def abort(self) -> None:
        """Let go of the file."""
        self._stream.close()
