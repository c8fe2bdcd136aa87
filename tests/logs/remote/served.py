"""Logs that are served, and what is read of them."""

from mpap_cli.logs.reader import LogPath, expand_paths, open_log
from tests.file_server import FileServer

ROWS = [
    (topic, 1_000 * number, f"{topic} {number} " + "x" * 40)
    for number in range(1, 200)
    for topic in ("/scan", "/bump")
]


def big_rows() -> list[tuple[str, int, str]]:
    """Return some scans, many images, and some scans again."""
    scans = [[("/scan", begin + n, f"scan {n}") for n in range(5)] for begin in (0, 10**6)]
    images = [("/image", 1000 + n, "x" * 100_000) for n in range(40)]
    return [*scans[0], *images, *scans[1]]


def messages_of(path: LogPath, *topics: str) -> list[tuple[str, int, bytes]]:
    """Return all that a log holds of some topics, and require that it is whole."""
    with open_log(path) as reader:
        found = [
            (message.topic.name, message.stamp_ns, message.payload)
            for message in reader.messages(topics or {topic.name for topic in reader.topics})
        ]
        assert not reader.damage
    return found


def remote(server: FileServer, words: str) -> LogPath:
    """Return the one log that a URL names."""
    (path,) = expand_paths([f"{server.url}/{words}"])
    return path
