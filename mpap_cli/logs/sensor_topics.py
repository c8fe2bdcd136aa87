"""Which topics carry scans, images and odometry: by type first, then by name."""

import re

from mpap_cli.errors import UsageError
from mpap_cli.logs.fields import LOCATED, SCAN_ENCODINGS
from mpap_cli.logs.frames import FRAME_READERS
from mpap_cli.logs.listing import DECODED, list_topics
from mpap_cli.logs.odometry import ODOMETRY_TYPE
from mpap_cli.logs.raw import Topic

SCAN_TYPES = ("sensor_msgs/msg/LaserScan", "foxglove.LaserScan")
_NO_APPEARANCE = re.compile(
    r"theora|ffmpeg|compresseddepth|parameter_updates|depth|infra|mask", re.IGNORECASE
)
_IMAGE_TYPES = {msgtype for msgtype, _ in FRAME_READERS}
_VIDEO = re.compile(r"CompressedVideo|FFMPEGPacket")

Choice = tuple[Topic | None, str, tuple[str, ...]]
"""The topic, why it or why none, and the names of those that would do."""


def choose_scan(topics: tuple[Topic, ...], asked: str | None, name: str) -> Choice:
    """Take the topic asked for, the only one, or the one named /scan.

    Parameters
    ----------
    topics : tuple of Topic
        All of the log.
    asked : str or None
        After ``--scan-topic``.
    name : str
        Base name of the log, for the error.

    Raises
    ------
    UsageError
        If the topic asked for is not there, or carries no scans.
    """
    found = [
        topic
        for topic in topics
        if topic.msgtype in SCAN_TYPES and topic.encoding in SCAN_ENCODINGS and topic.n_messages
    ]
    names = tuple(topic.name for topic in found)
    if asked is not None:
        return _asked_for(topics, found, asked, f"{name}: --scan-topic"), "asked for", names
    if len(found) == 1:
        return found[0], "the only LaserScan topic", names
    exact = [topic for topic in found if topic.name == "/scan"]
    if exact:
        return exact[0], f"named /scan, of {len(found)} LaserScan topics", names
    if not found:
        return None, "no topic carries LaserScan", ()
    return None, _ambiguous(names, "LaserScan", "--scan-topic"), names


def choose_image(topics: tuple[Topic, ...], asked: str | None, name: str) -> Choice:
    """Take the topic asked for, or the only camera: compressed before raw.

    Parameters and errors are those of `choose_scan`, for ``--image-topic``.
    """
    able = [
        topic
        for topic in topics
        if (topic.msgtype, topic.encoding) in FRAME_READERS and topic.n_messages
    ]
    if asked is not None:
        names = tuple(topic.name for topic in able)
        return _asked_for(topics, able, asked, f"{name}: --image-topic"), "asked for", names
    cameras: dict[str, list[Topic]] = {}
    for topic in able:
        if not _NO_APPEARANCE.search(topic.name):
            cameras.setdefault(topic.name.removesuffix("/compressed"), []).append(topic)
    best = [min(camera, key=_is_raw) for camera in cameras.values()]
    names = tuple(topic.name for topic in best)
    if len(best) == 1:
        return best[0], "the only camera", names
    if not best:
        return None, "no topic carries images of a camera", ()
    return None, _ambiguous(names, "images", "--image-topic"), names


def choose_odometry(topics: tuple[Topic, ...]) -> tuple[Topic | None, str]:
    """Take the only odometry, the one named /odom, or the one with most messages."""
    found = [
        topic
        for topic in topics
        if topic.msgtype == ODOMETRY_TYPE and topic.encoding in LOCATED and topic.n_messages
    ]
    if not found:
        return None, "no topic carries Odometry"
    if len(found) == 1:
        return found[0], "the only Odometry topic"
    exact = [topic for topic in found if topic.name == "/odom"]
    if exact:
        return exact[0], f"named /odom, of {len(found)} Odometry topics"
    most = max(found, key=lambda topic: topic.n_messages)
    return most, f"the one with most messages, of {len(found)} Odometry topics"


def find_unreadable(topics: tuple[Topic, ...]) -> tuple[str, ...]:
    """Name scans and images that are there in a form that is not read."""
    reasons = ((topic, _why_unread(topic)) for topic in topics)
    return tuple(
        f"{topic.name} ({topic.msgtype}) is not used: {reason}"
        for topic, reason in reasons
        if reason
    )


def _why_unread(topic: Topic) -> str:
    """Say why scans or images are not read; empty if they are, or it is another topic."""
    if _VIDEO.search(topic.msgtype):
        return "video; not read"
    if topic.msgtype in _IMAGE_TYPES:
        is_read = (topic.msgtype, topic.encoding) in FRAME_READERS
    else:
        is_read = topic.encoding in DECODED or "LaserScan" not in topic.msgtype
    return "" if is_read else f"encoding {topic.encoding or 'unknown'} cannot be read"


def _is_raw(topic: Topic) -> bool:
    return "Compressed" not in topic.msgtype


def _asked_for(topics: tuple[Topic, ...], able: list[Topic], asked: str, option: str) -> Topic:
    """Return the topic that was asked for by name."""
    for topic in able:
        if topic.name == asked:
            return topic
    there = next((topic for topic in topics if topic.name == asked), None)
    if there is None:
        msg = f"{option} {asked}: no such topic; the log holds {list_topics(topics)}"
        raise UsageError(msg)
    wanted = ", ".join(topic.name for topic in able) or "no topic that would do"
    msg = (
        f"{option} {asked}: {there.n_messages} messages of {there.msgtype} "
        f"({there.encoding or 'unknown encoding'}) cannot be used; there is {wanted}"
    )
    raise UsageError(msg)


def _ambiguous(names: tuple[str, ...], what: str, option: str) -> str:
    listed = ", ".join(names)
    return f"{len(names)} topics carry {what}: {listed}; choose one with {option} {names[0]}"
