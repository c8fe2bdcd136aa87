"""What ``info`` says of each sensor of a log, and of what could be learnt from it."""

from collections import Counter

import numpy as np

from mpap_cli.commands.describing.facts import BumpFacts, ImageFacts, ScanFacts, TopicFacts
from mpap_cli.commands.inputs.sources import Source
from mpap_cli.errors import LogError
from mpap_cli.features.images.image_decode import Image
from mpap_cli.logs.frames import read_frame
from mpap_cli.logs.listing import messages_of
from mpap_cli.logs.reader import LogReader
from mpap_cli.logs.survey import Survey
from mpap_cli.logs.topics import Roles
from mpap_cli.logs.video.links import PacketLinks, linked_frames
from mpap_cli.logs.video.packets import VIDEO_TYPES
from mpap_cli.observations import NS_PER_S, BoolArray, Frame, Press
from mpap_cli.outputs.text_table import count

RETURNS = "valid"
_MOST_NAMED = 5
_LEAST_DURATION_NS = NS_PER_S // 1000


def role(roles: Roles, name: str) -> str | None:
    """Return which role a topic plays."""
    if any(role.topic.name == name for role in roles.bumps):
        return "bump"
    for role, topic in (("scan", roles.scan), ("image", roles.image)):
        if topic is not None and topic.name == name:
            return role
    return None


def rate(n_messages: int, duration_ns: int) -> float | None:
    """Return messages per second of the log; None if it is shorter than a millisecond."""
    if duration_ns < _LEAST_DURATION_NS:
        return None
    return round(n_messages * NS_PER_S / duration_ns, 2)


def count_lost(reader: LogReader) -> Counter[tuple[str, str]]:
    """Count by name and type of the topic what broken chunks and rows have lost so far."""
    lost: Counter[tuple[str, str]] = Counter()
    for damage in reader.damage:
        lost.update(damage.lost)
    return lost


def topic_facts(reader: LogReader, roles: Roles) -> list[TopicFacts]:
    """Describe every topic; messages that are lost do not count, but their bytes do."""
    duration_ns = reader.end_ns - reader.start_ns
    lost, sizes = count_lost(reader), reader.topic_bytes()
    facts: list[TopicFacts] = []
    for topic in reader.topics:
        key = topic.name, topic.msgtype
        n_messages = topic.n_messages - min(lost[key], topic.n_messages)
        facts.append(
            {
                "name": topic.name,
                "type": topic.msgtype,
                "messages": n_messages,
                "hz": rate(n_messages, duration_ns),
                "role": role(roles, topic.name),
                "bytes": None if sizes is None else sizes.get(key, 0),
            }
        )
    return facts


def undefined_facts(reader: LogReader) -> list[str]:
    """Say which types cannot be read for want of a definition."""
    types = reader.undefined_types()
    if not types:
        return []
    names = ", ".join(types[:_MOST_NAMED])
    more = f" and {len(types) - _MOST_NAMED} more" if len(types) > _MOST_NAMED else ""
    return [f"no definition of {names}{more}; to use them name their folder with --msgs DIR"]


def bump_facts(source: Source, presses: tuple[Press, ...], pressed: BoolArray) -> BumpFacts:
    """Describe the bumper; of presses from scans or a file the semantics only."""
    roles = source.roles.bumps
    return {
        "topic": ", ".join(role.topic.name for role in roles) or None,
        "type": roles[0].topic.msgtype if roles else None,
        "semantics": roles[0].rule.kind if roles else source.start.bump_source.partition(" ")[0],
        "presses": len(presses),
        "scans_pressed": int(pressed.sum()),
        "pressed_s": sum(press.end_ns - press.start_ns for press in presses) / NS_PER_S,
    }


def scan_facts(roles: Roles, survey: Survey, n_scans: int) -> ScanFacts | None:
    """Describe the laser scans."""
    if roles.scan is None or survey.geometry is None:
        return None
    return {
        "topic": roles.scan.name,
        "scans": n_scans,
        "beams": survey.geometry.n_beams,
        "no_return_share": round(1 - survey.no_return_shares[RETURNS], 4),
        "forward_deg": round(float(np.degrees(survey.forward_rad)), 3),
    }


def first_frame(reader: LogReader, roles: Roles) -> Frame | None:
    """Return the first image of the camera, None if there is none or it is broken.

    Of video it is the first that needs no other.
    """
    topic = roles.image
    message = next(messages_of(reader, topic), None) if topic is not None else None
    if topic is None or message is None:
        return None
    if topic.msgtype in VIDEO_TYPES:
        links = PacketLinks()
        frames = linked_frames(reader, topic, links)
        return next((frame for frame in frames if links.opened), None)
    try:
        return read_frame(reader, message)
    except LogError:
        return None


def image_facts(
    roles: Roles, frame: Frame | None, image: Image | None, lost: Counter[tuple[str, str]]
) -> ImageFacts | None:
    """Describe the camera by its first image; no size if that is broken."""
    if roles.image is None:
        return None
    height, width = (frame.height or None, frame.width or None) if frame else (None, None)
    if image is not None:
        height, width = image.shape[:2]
    n_lost = lost[roles.image.name, roles.image.msgtype]
    return {
        "topic": roles.image.name,
        "images": roles.image.n_messages - min(n_lost, roles.image.n_messages),
        "width": width,
        "height": height,
        "encoding": frame.encoding if frame is not None else None,
    }


def can_learn(source: Source, presses: tuple[Press, ...] | None, pressed: BoolArray) -> str:
    """Say in words what could be learnt from the log; ``pressed`` has one entry a scan."""
    roles = source.roles
    if roles.scan is None:
        several = f"choose one of {', '.join(roles.scan_candidates)}"
        laser = f"laser model: {several if roles.scan_candidates else 'no scans'}"
    elif not pressed.size:
        laser = "laser model: no scan was read"
    elif presses is None:
        laser = "laser model: clusters only (no bumper; --bump-topic or --bump-from give labels)"
    elif not presses:
        laser = "laser model: clusters only (no positive: the bumper is never pressed)"
    elif pressed.all():
        laser = f"laser model: yes, {count(len(presses), 'press')}, but no scan without collision"
    else:
        laser = f"laser model: yes, {count(len(presses), 'press')}"
    parts = [laser, f"held-out AUC: {_held_out(source, presses, pressed)}"]
    if roles.image is not None:
        parts.append("camera: yes" if presses else "camera: no presses, novelty only")
    return "; ".join(parts)


def _held_out(source: Source, presses: tuple[Press, ...] | None, pressed: BoolArray) -> str:
    """Say whether a press can be scored by a model that never saw it."""
    if source.bump_distance_m is not None:
        return "not from presses that are made of the scans themselves"
    if pressed.any() and not pressed.all() and presses is not None:
        return "possible" if len(presses) > 1 else "with other logs (one press only)"
    return "not from this log alone"
