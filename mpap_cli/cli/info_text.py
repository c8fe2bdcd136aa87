"""The page that ``mpap info`` prints for a log."""

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from mpap_cli.commands.info import LogInfo
from mpap_cli.logs.times import is_date
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.text_table import aligned, count, printable

CONTAINERS = {
    "bag": "ROS 1 bag",
    "sqlite3": "sqlite3 file",
    "mcap": "MCAP",
    "rosbag2/sqlite3": "rosbag2 folder, sqlite3",
    "rosbag2/mcap": "rosbag2 folder, MCAP",
}


@dataclass(frozen=True, slots=True)
class TopicRow:
    """What ``--format csv`` prints of a topic."""

    name: str
    topic: str
    type: str
    messages: int
    hz: float | None
    role: str | None


def topic_rows(log: LogInfo) -> list[TopicRow]:
    """Return the topics of a log."""
    return [TopicRow(log.name, *topic.values()) for topic in log.facts["topics"]]


def log_facts(log: LogInfo) -> dict[str, Any]:
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
                ("  topic", "type", "messages", "hz", "role"),
                *(
                    (
                        f"  {t['name']}",
                        t["type"],
                        f"{t['messages']:,}",
                        _number(t["hz"]),
                        t["role"] or "",
                    )
                    for t in facts["topics"]
                ),
            ],
            right={2, 3},
        ),
        _scan_line(log),
        _bump_line(log),
        *([_image_line(log)] if facts["image"] else []),
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


def _image_line(log: LogInfo) -> str:
    """Say which camera would be used and why."""
    image = log.facts["image"]
    size = f"{image['width']} x {image['height']}" if image["width"] else "size unknown"
    return (
        f"  image: {image['topic']} ({log.reasons['image']}): {count(image['images'], 'image')}, "
        f"{size}, {image['encoding'] or 'encoding unknown'}"
    )


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:g}"


def _date(stamp_ns: int) -> str:
    """Return a stamp as a date, or as seconds where it is none (simulated time)."""
    if not is_date(stamp_ns):
        return f"{stamp_ns / NS_PER_S:.1f} s (no date: its clock starts at 0)"
    try:
        return f"{datetime.fromtimestamp(stamp_ns / NS_PER_S, UTC):%Y-%m-%d %H:%M:%S} UTC"
    except (OverflowError, OSError, ValueError):
        return f"{stamp_ns / NS_PER_S:g} s"
