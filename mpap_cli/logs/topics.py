"""Which topic plays which role: scan, image, odometry, bump.

By type first, then by name, then by what the topic holds; and always with a reason.
"""

from dataclasses import dataclass

from mpap_cli.errors import UsageError
from mpap_cli.logs.bumps.bump_topics import BumpRole, BumpsFound, ask_for_bumps, find_bumps
from mpap_cli.logs.listing import list_topics, other_encodings
from mpap_cli.logs.raw import LogReader, Topic
from mpap_cli.logs.sensor_topics import choose_image, choose_odometry, choose_scan, find_unreadable


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
    there are candidates); ``odometry`` is None where there is none; ``bumps`` is empty
    without a bumper. A reason is half a sentence to print behind the topic, or in its place
    where there is none. Candidates are names, best first. ``notes`` are whole sentences
    about topics that look useful but are not used.
    """

    topics: tuple[Topic, ...]
    scan: Topic | None
    image: Topic | None
    odometry: Topic | None
    bumps: tuple[BumpRole, ...]
    scan_reason: str
    image_reason: str
    odometry_reason: str
    bump_reason: str
    scan_candidates: tuple[str, ...]
    image_candidates: tuple[str, ...]
    bump_candidates: tuple[str, ...]
    notes: tuple[str, ...]


def choose_roles(reader: LogReader, choice: TopicChoice | None = None) -> Roles:
    """Find the scan, image, odometry and bump topics of a log.

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
    scan, scan_reason, scans = choose_scan(reader.topics, asked.scan, name)
    image, image_reason, images = choose_image(reader.topics, asked.image, name)
    odometry, odometry_reason = choose_odometry(reader.topics)
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
    notes = tuple(dict.fromkeys((*find_unreadable(reader.topics), *notes)))
    return Roles(
        topics=reader.topics,
        scan=scan,
        image=image,
        odometry=odometry,
        bumps=bumps,
        scan_reason=scan_reason,
        image_reason=image_reason,
        odometry_reason=odometry_reason,
        bump_reason=bump_reason,
        scan_candidates=scans,
        image_candidates=images,
        bump_candidates=bump_candidates,
        notes=(*notes, *other_encodings(reader.topics, notes)),
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
    if roles.scan is None:
        missing = _missing(roles, "no scan topic (LaserScan)")
        msg = f"{name}: {roles.scan_reason if roles.scan_candidates else missing}"
        raise UsageError(msg)
    return roles.scan


def require_image(roles: Roles, name: str) -> Topic:
    """Return the image topic, or say how to get one, as `require_scan` does."""
    if roles.image is None:
        missing = _missing(roles, "no image topic (CompressedImage, Image)")
        msg = f"{name}: {roles.image_reason if roles.image_candidates else missing}"
        raise UsageError(msg)
    return roles.image


def _missing(roles: Roles, missing: str) -> str:
    """Say what a log lacks, and what it holds."""
    found = (roles.scan, *roles.scan_candidates, roles.image, *roles.image_candidates)
    if not any((*found, *roles.bumps, *roles.bump_candidates)):
        missing = "no scan, image or bump topic"
    return f"{missing}; the log holds {list_topics(roles.topics)}"
