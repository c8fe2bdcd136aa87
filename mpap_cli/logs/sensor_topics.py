"""Which topics carry scans, images and odometry: by type first, then by name."""

import re
from collections.abc import Iterable
from importlib.util import find_spec

from mpap_cli.errors import UsageError
from mpap_cli.logs.fields import LOCATED, SCAN_ENCODINGS
from mpap_cli.logs.frames import FRAME_READERS
from mpap_cli.logs.listing import list_topics, not_used, unknown_encoding, why_unread
from mpap_cli.logs.odometry import ODOMETRY_TYPE
from mpap_cli.logs.raw import Topic
from mpap_cli.logs.video.packets import VIDEO_TYPES

SCAN_TYPES = ("sensor_msgs/msg/LaserScan", "foxglove.LaserScan")
_NO_APPEARANCE = re.compile(
    r"theora|compresseddepth|parameter_updates|depth|infra|mask", re.IGNORECASE
)
_IMAGE_TYPES = {msgtype for msgtype, _ in FRAME_READERS}
_VIDEO = re.compile(r"CompressedVideo|FFMPEGPacket")
_TRANSPORT = re.compile(r"/(compressed|ffmpeg)$")
_VIDEO_EXTRA = 'pip install "mpap[video]" to read it'

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
        if topic.msgtype in SCAN_TYPES
        and topic.encoding in SCAN_ENCODINGS
        and topic.n_messages
        and not why_unread(topic)
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
    """Take the topic asked for, or the only camera: compressed before raw, both before video.

    Parameters are those of `choose_scan`, for ``--image-topic``.

    Raises
    ------
    UsageError
        As `choose_scan`; also if video is asked for and PyAV is not installed.
    """
    able = [
        topic
        for topic in topics
        if (topic.msgtype, topic.encoding) in FRAME_READERS
        and topic.n_messages
        and not why_unread(topic)
    ]
    if asked is not None:
        option = f"{name}: --image-topic"
        topic = _asked_for(topics, able, asked, option)
        if topic.msgtype in VIDEO_TYPES and not _video_is_read():
            msg = f"{option} {asked}: this is video; {_VIDEO_EXTRA}"
            raise UsageError(msg)
        return topic, "asked for", tuple(topic.name for topic in able)
    seen = [topic for topic in able if not _NO_APPEARANCE.search(topic.name)]
    stills = _cameras(topic for topic in seen if topic.msgtype not in VIDEO_TYPES)
    videos = _cameras(topic for topic in seen if topic.msgtype in VIDEO_TYPES)
    best = [min(camera, key=_is_raw) for camera in (stills or videos).values()]
    names = tuple(topic.name for topic in best)
    if not best:
        return None, "no topic carries images of a camera", ()
    if not stills and not _video_is_read():
        return None, f"{names[0]} carries video; {_VIDEO_EXTRA}", names
    if len(best) > 1:
        return None, _ambiguous(names, "images", "--image-topic"), names
    only = stills and videos.keys() - stills.keys()
    return best[0], "the only camera without video" if only else "the only camera", names


def _cameras(topics: Iterable[Topic]) -> dict[str, list[Topic]]:
    """Put the topics of each camera together."""
    cameras: dict[str, list[Topic]] = {}
    for topic in topics:
        cameras.setdefault(_TRANSPORT.sub("", topic.name), []).append(topic)
    return cameras


def _video_is_read() -> bool:
    """Tell whether PyAV is installed, which decodes video."""
    return find_spec("av") is not None


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
    return tuple(not_used(topic, reason) for topic, reason in reasons if reason)


def _why_unread(topic: Topic) -> str:
    """Say why scans or images are not read; empty if they are, or it is another topic."""
    if topic.msgtype in _IMAGE_TYPES:
        is_known = (topic.msgtype, topic.encoding) in FRAME_READERS
        return why_unread(topic) or ("" if is_known else unknown_encoding(topic))
    if _VIDEO.search(topic.msgtype):
        return "video of a kind that is not read"
    return why_unread(topic) if "LaserScan" in topic.msgtype else ""


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
    if reason := why_unread(there):
        msg = f"{option} {asked}: {there.msgtype} is not read: {reason}"
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
