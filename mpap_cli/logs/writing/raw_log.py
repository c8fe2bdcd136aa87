"""Writing a log of the same container as another, record by record."""

import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Self

from mpap_cli.errors import OutputError
from mpap_cli.logs.passthrough.records import Origin, RawChannel, Record
from mpap_cli.logs.writing.raw_bag import RawBagWriter
from mpap_cli.logs.writing.raw_folder import RawFolderWriter, RawStorage
from mpap_cli.logs.writing.raw_mcap import RawMcapWriter
from mpap_cli.logs.writing.raw_tables import RawTablesWriter

SUFFIXES = {"bag": ".bag", "mcap": ".mcap"}
"""How the names of logs end that are one file; others are folders."""


class RawLogWriter:
    """Writes one new log as its origin is: container, profile, compression, channels.

    Used as a context manager; after an error the file is let go of as it is. Memory does
    not grow with the number of messages.

    Parameters
    ----------
    path : Path
        File or folder that is not there yet.
    origin : Origin
        What the log that is copied says about itself.
    channels : mapping of int to RawChannel
        Its channels by the numbers in its records; those without a message are announced too.

    Raises
    ------
    OutputError
        If the path cannot be written.
    """

    def __init__(self, path: Path, origin: Origin, channels: Mapping[int, RawChannel]) -> None:
        self.path = path
        with self._writing():
            if origin.container not in SUFFIXES:
                path.mkdir()
                writer: RawStorage = RawFolderWriter(path, origin, partial(_open_storage, origin))
                self._numbers = {n: writer.add_channel(one) for n, one in channels.items()}
            else:
                writer = _open_storage(origin, path)
                self._numbers = {n: writer.add_channel(one.stored) for n, one in channels.items()}
        self._writer = writer

    def write(self, record: Record) -> None:
        """Append a record; they are expected in time order.

        Raises
        ------
        OutputError
            If the disk is full.
        """
        with self._writing():
            self._writer.write(self._numbers[record.channel], record)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._writing():
            try:
                if kind is None:
                    self._writer.close()
            finally:
                self._writer.abort()  # whatever the disk refused, the file is let go of

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Turn an error of the disk into one line."""
        try:
            yield
        except (OSError, sqlite3.Error) as err:
            found = (err.strerror if isinstance(err, OSError) else None) or str(err)
            msg = f"{self.path}: cannot be written ({found.lower()}); choose another --out"
            raise OutputError(msg) from err


def _open_storage(origin: Origin, path: Path) -> RawStorage:
    """Open the file that holds the messages."""
    if origin.container == "bag":
        return RawBagWriter(path, origin.compression)
    if origin.container.endswith("mcap"):
        return RawMcapWriter(path, origin.compression, origin.profile, origin.library)
    return RawTablesWriter(path, origin.tables, origin.schema_row)
