"""Which topic plays which role: scan, image, bump.

By type first, then by name, then by what the topic holds; and always with a reason.
"""

import re
from dataclasses import dataclass

from mpap_cli.errors import UsageError
from mpap_cli.logs.bumps.bump_topics import BumpRole, BumpsFound, ask_for_bumps, find_bumps
from mpap_cli.logs.fields import SCAN_ENCODINGS
from mpap_cli.logs.listing import DECODED, list_topics
from mpap_cli.logs.raw import LogReader, Topic

SCAN_TYPES = ("sensor_msgs/msg/LaserScan", "foxglove.LaserScan")
IMAGE_TYPES = (
    "sensor_msgs/msg/CompressedImage",
    "sensor_msgs/msg/Image",
    "foxglove.CompressedImage",
    "foxglove.RawImage",
)
_NO_APPEARANCE = re.compile(
    r"theora|ffmpeg|compresseddepth|parameter_updates|depth|infra|mask", re.IGNORECASE
)


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicChoice:
    """What the command line says of topics.

    Parameters
    ----------
    scan, image : str, optional
        After ``--scan-topic`` and ``--image-topic``.
    bumps : tuple of str
        After each ``--bump-topic``.
    bump_from : str
        ``topic``; anything else (``scan``, ``none``, ``file``) needs no bump topic.
    """

    scan: str | None = None
    image: str | None = None
    bumps: tuple[str, ...] = ()
    bump_from: str = "topic"


@dataclass(frozen=True, slots=True)
class Roles:
    """The topics to use, why these, and what else there would be.

    ``scan`` and ``image`` are None where there is none or the choice is the user's (then
    there are candidates); ``bumps`` is empty without a bumper. A reason is half a sentence
    to print behind the topic, or in its place where there is none. Candidates are names,
    best first. ``notes`` are whole sentences about topics that look useful but are not used.
    """

    topics: tuple[Topic, ...]
    scan: Topic | None
    image: Topic | None
    bumps: tuple[BumpRole, ...]
    scan_reason: str
    image_reason: str
    bump_reason: str
    scan_candidates: tuple[str, ...]
    image_candidates: tuple[str, ...]
    bump_candidates: tuple[str, ...]
    notes: tuple[str, ...]


def choose_roles(reader: LogReader, choice: TopicChoice | None = None) -> Roles:
    """Find the scan, image and bump topics of a log.

    Parameters
    ----------
    reader : LogReader
        An open log; messages are read only if two bump topics are equally good, or to
        try an expression that was asked for.
    choice : TopicChoice, optional
        What was asked for; the rest is found.

    Returns
    -------
    Roles
        Nothing is chosen where the choice is ambiguous.

    Raises
    ------
    UsageError
        If a topic that was asked for is not there, or cannot play the role.
    """
    asked = choice or TopicChoice()
    name = reader.path.name
    scan, scan_reason, scans = _choose_scan(reader.topics, asked.scan, name)
    image, image_reason, images = _choose_image(reader.topics, asked.image, name)
    if asked.bump_from != "topic":
        if asked.bumps:
            msg = f"--bump-topic and --bump-from {asked.bump_from} exclude each other; give one"
            raise UsageError(msg)
        found: BumpsFound = ((), f"not looked for (--bump-from {asked.bump_from})", (), ())
    elif asked.bumps:
        found = ask_for_bumps(reader, asked.bumps)
    else:
        found = find_bumps(reader)
    bumps, bump_reason, bump_candidates, notes = found
    return Roles(
        topics=reader.topics,
        scan=scan,
        image=image,
        bumps=bumps,
        scan_reason=scan_reason,
        image_reason=image_reason,
        bump_reason=bump_reason,
        scan_candidates=scans,
        image_candidates=images,
        bump_candidates=bump_candidates,
        notes=(*_unreadable(reader.topics), *notes),
    )


def require_scan(roles: Roles, name: str) -> Topic:
    """Return the scan topic, or say how to get one.

    Parameters
    ----------
    roles : Roles
        What was found.
    name : str
        Base name of the log, for the error.

    Raises
    ------
    UsageError
        If there is no scan topic, or several.
    """
    if roles.scan is not None:
        return roles.scan
    if roles.scan_candidates:
        msg = f"{name}: {roles.scan_reason}"
        raise UsageError(msg)
    others = roles.image or roles.image_candidates or roles.bumps or roles.bump_candidates
    missing = "no scan topic (LaserScan)" if others else "no scan, image or bump topic"
    msg = f"{name}: {missing}; the log holds {list_topics(roles.topics)}"
    raise UsageError(msg)


def _choose_scan(
    topics: tuple[Topic, ...], asked: str | None, name: str
) -> tuple[Topic | None, str, tuple[str, ...]]:
    """Take the topic asked for, the only one, or the one named /scan."""
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


def _choose_image(
    topics: tuple[Topic, ...], asked: str | None, name: str
) -> tuple[Topic | None, str, tuple[str, ...]]:
    """Take the topic asked for, or the only camera: compressed before raw."""
    able = [
        topic
        for topic in topics
        if topic.msgtype in IMAGE_TYPES and topic.encoding in DECODED and topic.n_messages
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


def _unreadable(topics: tuple[Topic, ...]) -> tuple[str, ...]:
    """Name scans and images that are there in a form that is not read."""
    return tuple(
        f"{topic.name} ({topic.msgtype}) is not used: encoding "
        f"{topic.encoding or 'unknown'} cannot be read"
        for topic in topics
        if re.search(r"LaserScan|CompressedImage|RawImage|msg/Image", topic.msgtype)
        and topic.encoding not in DECODED
    )
