"""Topics in words, and the messages of one topic."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator

from mpap_cli.logs.protobuf import (
    NO_SCHEMA,
    PROTOBUF,
    PROTOBUF_EXTRA,
    has_schema,
    protobuf_is_read,
)
from mpap_cli.logs.raw import LogReader, RawMessage, Topic

_DECODED = ("ros1", "cdr", "json")

_MOST_LISTED = 30


def why_unread(topic: Topic) -> str:
    """Say why the messages of a topic cannot be read; empty if they can.

    >>> why_unread(Topic("/a", "pkg.Type", "cbor", 1, "", ""))
    'encoding cbor cannot be read'
    """
    if topic.encoding == PROTOBUF:
        if not protobuf_is_read():
            return f"it is protobuf; {PROTOBUF_EXTRA}"
        return "" if has_schema(topic.definition, topic.msgtype) else NO_SCHEMA
    return "" if topic.encoding in _DECODED else unknown_encoding(topic)


def unknown_encoding(topic: Topic) -> str:
    """Say that an encoding is not read."""
    return f"encoding {topic.encoding or 'unknown'} cannot be read"


def not_used(topic: Topic, reason: str) -> str:
    """Say why a topic that looks useful is not used."""
    return f"{topic.name} ({topic.msgtype}) is not used: {reason}"


def other_encodings(topics: Iterable[Topic], notes: Collection[str]) -> tuple[str, ...]:
    """Count by encoding the topics that cannot be read and that no note names.

    >>> other_encodings([Topic("/a", "pkg.Type", "cbor", 1, "", "")], ())
    ('1 other topic is not used: encoding cbor cannot be read',)
    """
    unnamed = (t for t in topics if not any(note.startswith(f"{t.name} (") for note in notes))
    reasons = Counter(why_unread(topic) for topic in unnamed if topic.n_messages)
    return tuple(
        f"{n} other {'topic is' if n == 1 else 'topics are'} not used: {reason}"
        for reason, n in reasons.items()
        if reason
    )


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
