"""MCAP files for tests, and where their chunks are."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from mcap.writer import Writer


def chunk_offsets(path: Path) -> list[tuple[int, int]]:
    """Return offset and length of every chunk, by the summary."""
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return [(index.chunk_start_offset, index.chunk_length) for index in summary.chunk_indexes]


def write_mcap(path: Path, stamps_ns: Sequence[int], **options: Any) -> Path:
    """Write one topic of bytes, a message per stamp."""
    with path.open("wb") as stream:
        writer = Writer(stream, **options)
        writer.start()
        channel = writer.register_channel("/left", "cdr", 0)
        for stamp_ns in stamps_ns:
            writer.add_message(channel, stamp_ns, bytes(40), stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path
