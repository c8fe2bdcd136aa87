"""Single images of logs that have been read, found again by their stamps."""

import logging
from collections.abc import Collection, Iterator

from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.errors import LogError
from mpap_cli.logs.reader import LogReader, RawMessage, Topic, expand_paths, open_log
from mpap_cli.logs.topics import choose_roles
from mpap_cli.logs.video.links import read_linked
from mpap_cli.observations import NS_PER_S, Frame

LOGGER = logging.getLogger(__name__)
SAME_MOMENT_NS = NS_PER_S // 5


def frames_at(
    selection: LogSelection, stamps_ns: Collection[int]
) -> Iterator[tuple[str, int, Frame]]:
    """Yield the image of each log that is nearest to each stamp, within a fifth of a second.

    Parameters
    ----------
    selection : LogSelection
        The logs, and their image topic.
    stamps_ns : collection of int
        Moments, of whichever log.

    Yields
    ------
    tuple of str, int, Frame
        Base name of the log, the stamp, the image.
    """
    for path in {path.resolve(): path for path in expand_paths(selection.logs)}.values():
        try:
            reader = open_log(path, msgs=selection.msgs)
        except LogError:
            continue  # told when it was read
        with reader:
            topic = choose_roles(reader, selection.topic_choice).image
            if topic is None:
                continue
            for stamp_ns in sorted(stamps_ns):
                message = _message_at(reader, topic, stamp_ns)
                frame = _frame(reader, message) if message is not None else None
                if frame is not None:
                    yield path.name, stamp_ns, frame


def _message_at(reader: LogReader, topic: Topic, stamp_ns: int) -> RawMessage | None:
    """Return the image message nearest to a stamp, if one is near."""
    window = (stamp_ns - SAME_MOMENT_NS, stamp_ns + SAME_MOMENT_NS)
    messages = [
        message
        for message in reader.messages([topic.name], *window)
        if message.topic.msgtype == topic.msgtype
    ]
    return min(messages, key=lambda message: abs(message.stamp_ns - stamp_ns), default=None)


def _frame(reader: LogReader, message: RawMessage) -> Frame | None:
    """Return the image of a message, None if it does not fit its type."""
    try:
        return read_linked(reader, message)
    except LogError:
        return None
