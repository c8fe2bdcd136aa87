"""Writing logs: one interface for every container that the readers know."""

import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from mpap_cli.errors import OutputError, SettingError
from mpap_cli.logs.scratch import ScratchFolder
from mpap_cli.logs.writing.storages import CONTAINERS, ENCODERS, STORAGES, Storage


def check_container(container: str, compression: str | None) -> str:
    """Return the compression to use.

    Parameters
    ----------
    container : str
        One of the keys of ``CONTAINERS``.
    compression : str or None
        One of its compressions; None takes the first.

    Raises
    ------
    SettingError
        If there is no such container, or no such compression of it.

    Examples
    --------
    >>> check_container("bag", None)
    'lz4'
    """
    if container not in CONTAINERS:
        msg = f"container: found {container}, expected one of {', '.join(CONTAINERS)}"
        raise SettingError(msg)
    choices = CONTAINERS[container]
    if compression is not None and compression not in choices:
        expected = ", ".join(choices)
        msg = f"compression: found {compression}, expected one of {expected} for {container}"
        raise SettingError(msg)
    return compression or choices[0]


class LogWriter:
    """Writes one new log, message by message; memory does not grow with its length.

    Used as a context manager. The log is written aside and takes its name when it is
    whole; after an error nothing is left.

    Parameters
    ----------
    path : Path
        File, or folder for the containers ``rosbag2-*``; must not exist.
    container : str
        One of the keys of ``CONTAINERS``.
    compression : str, optional
        One of the container's compressions; None takes its first.

    Raises
    ------
    SettingError
        If there is no such container or compression.
    OutputError
        If the path exists or cannot be written.
    """

    def __init__(self, path: Path, container: str = "mcap", compression: str | None = None) -> None:
        self.path = path
        self.container = container
        self.compression = check_container(container, compression)
        self._aside: ScratchFolder | None = None
        self._storage: Storage | None = None
        self._encoder = ENCODERS[container]()
        self._topics: dict[str, tuple[str, int]] = {}

    def add_topic(self, topic: str, msgtype: str, schema: str | None = None) -> None:
        """Announce a topic, so that the log names it even if no message follows.

        Parameters
        ----------
        topic, msgtype : str
            Name and type.
        schema : str, optional
            JSON schema of a type that is not built in, for the container ``mcap-json``.

        Raises
        ------
        UsageError
            If there is no definition of the type.
        """
        text, digest = (schema, "") if schema else self._encoder.definition(msgtype)
        with self._writing():
            number = self._open_storage.add_topic(topic, msgtype, text, digest)
        self._topics[topic] = (msgtype, number)

    def write(self, topic: str, msgtype: str, stamp_ns: int, message: Mapping[str, Any]) -> None:
        """Append one message; messages are expected in time order.

        Parameters
        ----------
        topic, msgtype : str
            Name and type (ROS2 form, or the name of a JSON schema).
        stamp_ns : int
            Log time, nanoseconds.
        message : mapping
            Fields by name; those left out are zero or empty.

        Raises
        ------
        UsageError
            If the type has no definition, or not such a field.
        """
        if topic not in self._topics:
            self.add_topic(topic, msgtype)
        payload = self._encoder.encode(msgtype, message)
        with self._writing():
            self._open_storage.write(self._topics[topic][1], stamp_ns, payload)

    @property
    def _open_storage(self) -> Storage:
        if self._storage is None:
            msg = "LogWriter is used outside its with-block"
            raise RuntimeError(msg)
        return self._storage

    def __enter__(self) -> Self:
        self._require_free()
        try:
            with self._writing():
                self._aside = ScratchFolder(".mpap-", self.path.parent)
                aside = self._aside.path / self.path.name
                self._storage = STORAGES[self.container](aside, self.container, self.compression)
        except BaseException:
            self._remove_aside()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        storage, self._storage = self._storage, None
        try:
            if storage is not None and self._aside is not None:
                with self._writing():
                    storage.close(whole=kind is None)
                    if kind is None:
                        self._require_free()  # another run may have been faster
                        (self._aside.path / self.path.name).rename(self.path)
        finally:
            self._remove_aside()

    def _require_free(self) -> None:
        if self.path.exists():
            msg = f"{self.path}: exists already; remove it or choose another name"
            raise OutputError(msg)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Turn an error of the disk into one line."""
        try:
            yield
        except (OSError, sqlite3.Error) as err:
            found = (err.strerror if isinstance(err, OSError) else None) or str(err)
            msg = f"{self.path}: cannot be written ({found.lower()}); choose another place"
            raise OutputError(msg) from err

    def _remove_aside(self) -> None:
        if self._aside is not None:
            self._aside.remove()
            self._aside = None
