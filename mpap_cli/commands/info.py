"""``info``: what a log holds, what would be used and why, what could be learnt from it."""

import logging
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mpap_cli.commands.log_facts import (
    bump_facts,
    can_learn,
    image_facts,
    rate,
    role,
    scan_facts,
)
from mpap_cli.commands.models import load_model
from mpap_cli.commands.selection import LogSelection
from mpap_cli.commands.sources import DAMAGED, open_readable
from mpap_cli.errors import LogError
from mpap_cli.logs.reader import LogReader, expand_paths
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.survey import survey_log
from mpap_cli.logs.topics import choose_roles
from mpap_cli.observations import NS_PER_S, BoolArray, IntArray, Press
from mpap_cli.params import BumperParams
from mpap_cli.properties.presses import PressTracker
from mpap_cli.systems.collision import CollisionModel

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class LogInfo:
    """What one log holds; ``facts`` are the keys of ``--format json`` in their order."""

    name: str
    facts: dict[str, Any]
    reasons: dict[str, str]
    shares: dict[str, float]


@dataclass(frozen=True, slots=True)
class ModelInfo:
    """What a model knows, and from which logs."""

    path: Path
    model: CollisionModel


@dataclass(frozen=True, slots=True)
class Infos:
    """What was found, in the order asked for."""

    found: list[LogInfo | ModelInfo] = field(default_factory=list)
    unreadable: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        """0, or 3 if a log or part of one could not be read."""
        damaged = any(isinstance(one, LogInfo) and one.facts["damage"] for one in self.found)
        return DAMAGED if damaged or self.unreadable else 0


def info(selection: LogSelection, forward: str = "tf") -> Infos:
    """Look at logs, or at models and results folders.

    Parameters
    ----------
    selection : LogSelection
        Paths, and the topics to take.
    forward : str
        Direction of travel in degrees, or ``tf``.

    Returns
    -------
    Infos
        One entry a log or model.

    Raises
    ------
    LogError
        If nothing could be read, or with ``strict`` if one log cannot be.
    """
    infos = Infos()
    paths = [path for word in selection.logs for path in _paths(word)]
    for path in paths:
        if _is_model(path):
            infos.found.append(ModelInfo(path, load_model(path)))
            continue
        try:
            with open_readable(path, selection) as reader:
                infos.found.append(_log_info(reader, selection, forward))
        except LogError as error:
            if selection.strict or len(paths) == 1:
                raise
            LOGGER.warning("%s; left out", error)
            infos.unreadable.append(path.name)
    if not infos.found and len(infos.unreadable) > 0:
        msg = f"none of the logs can be read: {', '.join(infos.unreadable)}"
        raise LogError(msg)
    return infos


def _paths(word: str) -> list[Path]:
    """Return the model or the logs that a word names."""
    return [Path(word)] if _is_model(Path(word)) else expand_paths([word])


def _is_model(path: Path) -> bool:
    """Tell a model file or results folder from a log."""
    if path.is_dir():
        return any((path / place / "model.npz").is_file() for place in ("learn", "merge"))
    return path.suffix == ".npz"


def _log_info(reader: LogReader, selection: LogSelection, forward: str) -> LogInfo:
    """Read what a log holds: its topics, and the scans and bumps in full."""
    roles = choose_roles(reader, selection.topic_choice)
    survey = survey_log(reader, roles, forward)
    replay = Replay(reader, roles, BumperParams(), selection.replay_options)
    presses, stamps_ns = _replay(replay)
    pressed = _pressed(stamps_ns, presses)
    bump = bump_facts(roles, presses, pressed) if presses is not None else None
    facts = {
        "path": str(reader.path),
        "container": reader.container,
        "start_stamp_ns": reader.start_ns,
        "duration_s": (reader.end_ns - reader.start_ns) / NS_PER_S,
        "messages": reader.n_messages,
        "topics": [
            {
                "name": topic.name,
                "type": topic.msgtype,
                "messages": topic.n_messages,
                "hz": rate(topic.n_messages, reader.end_ns - reader.start_ns),
                "role": role(roles, topic.name),
            }
            for topic in reader.topics
        ],
        "bump": bump,
        "scan": scan_facts(roles, survey, len(stamps_ns)),
        "image": image_facts(reader, roles),
        "damage": [item.text for item in reader.damage],
        "warnings": [
            *reader.warnings,
            *roles.notes,
            *(f"{count} skipped: {reason}" for reason, count in replay.skipped.items()),
        ],
        "can_learn": can_learn(roles, presses, pressed),
    }
    reasons = {"scan": roles.scan_reason, "bump": roles.bump_reason, "image": roles.image_reason}
    reasons["forward"] = survey.forward_source
    return LogInfo(reader.path.name, facts, reasons, survey.no_return_shares)


def _replay(replay: Replay) -> tuple[tuple[Press, ...] | None, IntArray]:
    """Return the presses (None without a bumper) and the stamps of all scans."""
    tracker = None
    if replay.bump_kind is not None:
        tracker = PressTracker(replay.bump_kind, BumperParams(), replay.hold_s)
    stamps = [np.empty(0, dtype=np.int64)]
    for batch in replay:
        stamps.extend(block.stamps_ns for block in batch.scans)
        if tracker is not None:
            tracker.add(batch.bumps)
    if tracker is not None:
        tracker.end(replay.end_ns)
    return None if tracker is None else tracker.presses, np.concatenate(stamps)


def _pressed(stamps_ns: IntArray, presses: tuple[Press, ...] | None) -> BoolArray:
    """Tell which scans lie in a press."""
    pressed = np.zeros(len(stamps_ns), dtype=bool)
    for press in presses or ():
        pressed |= (stamps_ns >= press.start_ns) & (stamps_ns < press.end_ns)
    return pressed
