"""Topics in words, and the messages of one topic."""

from collections.abc import Iterator

from mpap_cli.logs.raw import LogReader, RawMessage, Topic

DECODED = ("ros1", "cdr", "json")
"""Encodings whose messages can be read."""

_MOST_LISTED = 30


def list_topics(topics: tuple[Topic, ...]) -> str:
    """List topics with their types in one line.

    >>> list_topics((Topic("/cmd_vel", "geometry_msgs/msg/Twist", "ros1", 9, "", ""),))
    '/cmd_vel (geometry_msgs/msg/Twist)'
    """
    words = [f"{topic.name} ({topic.msgtype})" for topic in topics[:_MOST_LISTED]]
    if len(topics) > _MOST_LISTED:
        words.append(f"and {len(topics) - _MOST_LISTED} more")
    return ", ".join(words) or "no topic"


def messages_of(reader: LogReader, topic: Topic) -> Iterator[RawMessage]:
    """Yield the messages of a topic; another type under the same name is left out."""
    for message in reader.messages({topic.name}):
        if message.topic.msgtype == topic.msgtype:
            yield message
