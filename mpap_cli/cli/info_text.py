"""The page that ``mpap info`` prints for a log."""

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated

from mpap_cli.commands.describing.facts import ImageFacts, LogFacts
from mpap_cli.commands.info import LogInfo
from mpap_cli.logs.times import is_date
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.text_table import aligned, count, printable
from mpap_cli.systems.columns import LogName

CONTAINERS = {
    "bag": "ROS 1 bag",
    "sqlite3": "sqlite3 file",
    "mcap": "MCAP",
    "rosbag2/sqlite3": "rosbag2 folder, sqlite3",
    "rosbag2/mcap": "rosbag2 folder, MCAP",
}

_UNITS = (("GB", 10**9), ("MB", 10**6), ("kB", 10**3))


@dataclass(frozen=True, slots=True)
class TopicRow:
    """What ``--format csv`` prints of a topic."""

    name: LogName
    topic: Annotated[str, "name of the topic"]
    type: Annotated[str, "type of its messages"]
    messages: Annotated[int, "number of its messages"]
    hz: Annotated[float | None, "messages per second of the log"]
    role: Annotated[str | None, "`scan`, `image` or `bump`; empty for others"]
    bytes: Annotated[int | None, "size of its messages; empty where no index tells"]


def topic_rows(log: LogInfo) -> list[TopicRow]:
    """Return the topics of a log."""
    return [
        TopicRow(
            name=log.name,
            topic=topic["name"],
            type=topic["type"],
            messages=topic["messages"],
            hz=topic["hz"],
            role=topic["role"],
            bytes=topic["bytes"],
        )
        for topic in log.facts["topics"]
    ]


def log_facts(log: LogInfo) -> LogFacts:
    """Return what ``--format json`` prints of a log."""
    return log.facts


def log_text(log: LogInfo) -> str:
    """Lay out what a log holds."""
    facts = log.facts
    lines = [
        (
            f"{log.name}: {CONTAINERS[facts['container']]}, {facts['duration_s']:.1f} s from "
            f"{_date(facts['start_stamp_ns'])}, {count(facts['messages'], 'message')}"
        ),
        *aligned(
            [
                ("  topic", "type", "messages", "hz", "role", "size"),
                *(
                    (
                        f"  {t['name']}",
                        t["type"],
                        f"{t['messages']:,}",
                        _number(t["hz"]),
                        t["role"] or "",
                        _size(t["bytes"]),
                    )
                    for t in facts["topics"]
                ),
            ],
            right={2, 3, 5},
        ),
        _scan_line(log),
        _bump_line(log),
        *([_image_line(facts["image"], log.reasons["image"])] if facts["image"] else []),
        *(f"  damaged: {text}" for text in facts["damage"]),
        *(f"  note: {text}" for text in facts["warnings"]),
        f"  {facts['can_learn']}",
    ]
    return "".join(f"{printable(line)}\n" for line in lines)


def _scan_line(log: LogInfo) -> str:
    """Say which scans would be used and why."""
    scan = log.facts["scan"]
    if scan is None:
        return f"  scan: none; {log.reasons['scan']}"
    shares = sorted(log.shares.items(), key=lambda item: -item[1])
    codes = ", ".join(f"{name} {share:.0%}" for name, share in shares if share > 0)
    return (
        f"  scan: {scan['topic']} ({log.reasons['scan']}): {count(scan['scans'], 'scan')} of "
        f"{scan['beams']} beams, forward {scan['forward_deg']:g} deg ({log.reasons['forward']}); "
        f"beams: {codes}"
    )


def _bump_line(log: LogInfo) -> str:
    """Say which bumper would be used and why."""
    bump = log.facts["bump"]
    if bump is None:
        return f"  bump: none; {log.reasons['bump']}"
    reason, topic = log.reasons["bump"], bump["topic"]
    origin = f"{topic} ({reason}): {bump['semantics']}, " if topic else f"{reason}: "
    return (
        f"  bump: {origin}{count(bump['presses'], 'press')}, "
        f"{count(bump['scans_pressed'], 'scan')} pressed, {bump['pressed_s']:.1f} s"
    )


def _image_line(image: ImageFacts, reason: str) -> str:
    """Say which camera would be used and why."""
    size = f"{image['width']} x {image['height']}" if image["width"] else "size unknown"
    return (
        f"  image: {image['topic']} ({reason}): {count(image['images'], 'image')}, "
        f"{size}, {image['encoding'] or 'encoding unknown'}"
    )


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:g}"


def _size(n_bytes: int | None) -> str:
    """Return a size for people; a dash where no index tells."""
    if n_bytes is None:
        return "-"
    for unit, divisor in _UNITS:
        if n_bytes >= divisor:
            return f"{n_bytes / divisor:,.1f} {unit}"
    return f"{n_bytes} B"


def _date(stamp_ns: int) -> str:
    """Return a stamp as a date, or as seconds where it is none (simulated time)."""
    if not is_date(stamp_ns):
        return f"{stamp_ns / NS_PER_S:.1f} s (no date: its clock starts at 0)"
    try:
        return f"{datetime.fromtimestamp(stamp_ns / NS_PER_S, UTC):%Y-%m-%d %H:%M:%S} UTC"
    except (OverflowError, OSError, ValueError):
        return f"{stamp_ns / NS_PER_S:g} s"
