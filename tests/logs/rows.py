"""Rows that tests write into logs of every kind, and read back."""

from collections.abc import Callable, Sequence
from pathlib import Path

from mpap_cli.logs.reader import LogReader

Rows = Sequence[tuple[str, int, str]]
WriteLog = Callable[[str, Rows], Path]

ROWS = [("/left" if number % 3 else "/right", 10**18 + number, f"{number}") for number in range(60)]

START_NS = 1_700_000_000_000_000_000
# Stamps go back now and then, by less and by more than a chunk.
SHUFFLED = [
    (
        ("/left", "/right", "/rare")[0 if number % 7 else 2 if number % 2 else 1],
        START_NS + 1_000 * number - (20_000 if number % 11 == 5 else 0),
        f"message number {number}",
    )
    for number in range(120)
]
IN_ORDER = sorted(SHUFFLED, key=lambda row: row[1])


def storage(folder: Path) -> Path:
    """Return the file that holds the messages of a rosbag2 folder."""
    return next(path for path in folder.iterdir() if path.suffix in {".db3", ".mcap"})


def stamps(reader: LogReader) -> list[int]:
    """Return the stamps of all messages."""
    names = [topic.name for topic in reader.topics]
    return [message.stamp_ns for message in reader.messages(names)]


def read(
    reader: LogReader, topics: Sequence[str] | None = None, **window: int
) -> list[tuple[str, int, str]]:
    """Return the rows that were written."""
    names = [topic.name for topic in reader.topics] if topics is None else topics
    return [
        (message.topic.name, message.stamp_ns, text_of(reader.decode(message)))
        for message in reader.messages(names, **window)
    ]


def text_of(decoded: object) -> str:
    """Return the text of a decoded string message."""
    found: str = decoded["data"] if isinstance(decoded, dict) else vars(decoded)["data"]
    return found
