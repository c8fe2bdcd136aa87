"""What a model says of a log, as an MCAP file that opens beside the log in Foxglove."""

import base64
import json
import math
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from mpap_cli.errors import UsageError
from mpap_cli.logs.writing.writer import LogWriter
from mpap_cli.observations import NS_PER_S

EVENTS_TOPIC = "/mpap/events"

Value = float | str | None


class EventLogWriter:
    """Writes images, values and events with the log times of their source.

    Messages are JSON with a JSON schema in zstd chunks, so that any reader of MCAP takes
    them. Used as a context manager: the file is written aside and takes its name when it
    is whole; after an error nothing is left. Events may come out of time order. Memory
    does not grow with what is written, but for the index of chunks.

    Parameters
    ----------
    path : Path
        File to write; must not exist.

    Raises
    ------
    OutputError
        If the path exists or cannot be written, at any moment.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "predicted.mcap"
    ...     with EventLogWriter(path) as log:
    ...         log.value("/mpap/decision", 12_000_000_000, {"action": "stop", "p": 0.9})
    ...     path.exists()
    True
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._log = LogWriter(path, "mcap-json", "zstd")
        self._kinds: dict[str, dict[str, str]] = {}

    def image(self, topic: str, stamp_ns: int, jpeg: bytes, frame_id: str = "") -> None:
        """Append a JPEG as foxglove.CompressedImage.

        Parameters
        ----------
        topic : str
            Name of the topic.
        stamp_ns : int
            Log time of the image that it was made from, nanoseconds.
        jpeg : bytes
            The image, encoded.
        frame_id : str
            Frame of the camera.
        """
        message = {
            "timestamp": _time(stamp_ns),
            "frame_id": frame_id,
            "data": base64.b64encode(jpeg).decode("ascii"),
            "format": "jpeg",
        }
        self._log.write(topic, "foxglove.CompressedImage", stamp_ns, message)

    def value(self, topic: str, stamp_ns: int, fields: Mapping[str, Value]) -> None:
        """Append named values; the first message of a topic makes its schema.

        Parameters
        ----------
        topic : str
            Name of the topic; the schema bears it too, with dots.
        stamp_ns : int
            Log time, nanoseconds.
        fields : mapping
            Numbers and texts by name. A field that is None, or a number that is not
            finite, is left out of the message: JSON has no word for it. Where the first
            message has it so, it is the field of a number.

        Raises
        ------
        UsageError
            If a field was not in the first message of the topic, or of another kind.
        """
        kinds = {name: _kind(value) for name, value in fields.items()}
        values = {name: _plain(value) for name, value in fields.items()}
        message = {name: value for name, value in values.items() if value is not None}
        if topic not in self._kinds:
            self._log.add_topic(topic, *_schema(topic, kinds))
            self._kinds[topic] = kinds
        _check_kinds(topic, {name: kinds[name] for name in message}, self._kinds[topic])
        self._log.write(topic, _schema_name(topic), stamp_ns, message)

    def event(self, stamp_ns: int, duration_ns: int, metadata: Mapping[str, str]) -> None:
        """Append a foxglove.Event, which viewers show on the timeline.

        Parameters
        ----------
        stamp_ns : int
            Log time at which it begins, nanoseconds.
        duration_ns : int
            How long it lasts, zero or more.
        metadata : mapping
            What it is, texts by name.

        Raises
        ------
        UsageError
            If it would end before it begins.
        """
        if duration_ns < 0:
            msg = f"duration of an event: found {duration_ns} ns, expected 0 or more"
            raise UsageError(msg)
        message = {
            "start_time": _time(stamp_ns),
            "end_time": _time(stamp_ns + duration_ns),
            "metadata": [{"key": key, "value": text} for key, text in metadata.items()],
        }
        self._log.write(EVENTS_TOPIC, "foxglove.Event", stamp_ns, message)

    def __enter__(self) -> Self:
        self._log.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._log.__exit__(kind, error, trace)


def _time(stamp_ns: int) -> dict[str, int]:
    """Return a stamp as Foxglove's schemas have it."""
    sec, nsec = divmod(stamp_ns, NS_PER_S)
    return {"sec": sec, "nsec": nsec}


def _kind(value: Value) -> str:
    """Return what a value is in a JSON schema."""
    return "string" if isinstance(value, str) else "number"


def _plain(value: Value) -> Value:
    """Return a value as JSON can hold it; None if it cannot."""
    if value is None or isinstance(value, str):
        return value
    return float(value) if math.isfinite(value) else None


def _check_kinds(topic: str, kinds: Mapping[str, str], expected: Mapping[str, str]) -> None:
    """Require every field to be as the schema of the topic says."""
    for name, kind in kinds.items():
        if expected.get(name) != kind:
            known = ", ".join(f"{field} ({kind})" for field, kind in expected.items())
            msg = f"{topic}: found {name} ({kind}), expected fields of the first message: {known}"
            raise UsageError(msg)


def _schema_name(topic: str) -> str:
    return topic.strip("/").replace("/", ".")


def _schema(topic: str, kinds: Mapping[str, str]) -> tuple[str, str]:
    """Return name and text of the JSON schema of a topic."""
    name = _schema_name(topic)
    properties = {field: {"type": kind} for field, kind in kinds.items()}
    return name, json.dumps({"title": name, "type": "object", "properties": properties})
