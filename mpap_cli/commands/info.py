"""``info``: what a log holds, what would be used and why, what could be learnt from it."""

import logging
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeGuard

import numpy as np

from mpap_cli.commands.describing.facts import LogFacts
from mpap_cli.commands.describing.log_facts import (
    bump_facts,
    can_learn,
    count_lost,
    first_frame,
    image_facts,
    scan_facts,
    topic_facts,
    undefined_facts,
)
from mpap_cli.commands.inputs.press_file import presses_by_hand
from mpap_cli.commands.inputs.press_tracking import LogPresses
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import DAMAGED, Source, open_readable, survey_source
from mpap_cli.errors import LogError
from mpap_cli.features.images.image_decode import decode_frame
from mpap_cli.logs.reader import LogPath, expand_paths
from mpap_cli.observations import NS_PER_S, BoolArray, IntArray, Press
from mpap_cli.outputs.model_file import has_model
from mpap_cli.params import BumperParams, make_settings

if TYPE_CHECKING:
    from mpap_cli.commands.inputs.models import Models

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class LogInfo:
    """What one log holds; ``facts`` are the keys of ``--format json`` in their order."""

    name: str
    facts: LogFacts
    reasons: dict[str, str]
    shares: dict[str, float]


@dataclass(frozen=True, slots=True)
class ModelInfo:
    """What a model knows, and from which logs."""

    path: Path
    models: "Models"


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


def info(selection: LogSelection, progress: Progress = no_progress) -> Infos:
    """Look at logs, or at models and results folders.

    Parameters
    ----------
    selection : LogSelection
        Paths, the topics to take, and what makes a press.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Infos
        One entry a log or model.

    Raises
    ------
    LogError
        If nothing could be read, or with ``strict`` if one log cannot be.
    UsageError
        If the selection does not fit a log.
    """
    infos = Infos()
    paths = [path for word in selection.logs for path in _paths(word)]
    by_hand = presses_by_hand(selection, [path for path in paths if not _is_model(path)])
    settings = selection.settings_for(make_settings())
    n_read = 0
    for path in paths:
        if _is_model(path):
            infos.found.append(_model_info(path))
            continue
        try:
            with open_readable(path, selection) as reader:
                source = survey_source(reader, n_read, selection, settings, by_hand, required=False)
                infos.found.append(_log_info(source, progress))
                n_read += 1
        except LogError as error:
            if selection.strict or len(paths) == 1:
                raise
            LOGGER.warning("%s; left out", error)
            infos.unreadable.append(path.name)
    if not infos.found and len(infos.unreadable) > 0:
        msg = f"none of the logs can be read: {', '.join(infos.unreadable)}"
        raise LogError(msg)
    return infos


def _model_info(path: Path) -> ModelInfo:
    """Load a model."""
    # what models are made of takes longer to import than a log to read
    from mpap_cli.commands.inputs.models import load_models  # noqa: PLC0415

    return ModelInfo(path, load_models(path))


def _paths(word: str) -> list[LogPath]:
    """Return the model or the logs that a word names."""
    return [Path(word)] if _is_model(Path(word)) else expand_paths([word])


def _is_model(path: LogPath) -> TypeGuard[Path]:
    """Tell a model file or results folder on this machine from a log."""
    if not isinstance(path, Path):
        return False
    if path.is_dir():
        return has_model(path)
    return path.suffix == ".npz"


def _log_info(source: Source, progress: Progress) -> LogInfo:
    """Read what a log holds: its topics, and the scans and bumps in full."""
    reader, roles, survey = source.reader, source.roles, source.survey
    presses, stamps_ns = _replay(source, progress)
    pressed = _pressed(stamps_ns, presses)
    bump = bump_facts(source, presses, pressed) if presses is not None else None
    frame = first_frame(reader, roles)
    image = decode_frame(frame) if frame is not None else None
    undecoded = roles.image is not None and image is None
    several = roles.image is None and roles.image_candidates
    lost = count_lost(reader)
    facts: LogFacts = {
        "path": str(reader.path),
        "container": reader.container,
        "start_stamp_ns": reader.start_ns,
        "duration_s": (reader.end_ns - reader.start_ns) / NS_PER_S,
        "messages": reader.n_messages - lost.total(),
        "topics": topic_facts(reader, roles),
        "bump": bump,
        "scan": scan_facts(roles, survey, len(stamps_ns)),
        "image": image_facts(roles, frame, image, lost),
        "damage": [item.text for item in reader.damage],
        "warnings": [
            *reader.warnings,
            *roles.notes,
            *([f"no image topic is chosen: {roles.image_reason}"] if several else []),
            *undefined_facts(reader),
            *source.replay.clock_findings(),
            *(f"{count} skipped: {reason}" for reason, count in source.replay.skipped.items()),
            *(["the first image could not be decoded"] if undecoded else []),
        ],
        "can_learn": can_learn(source, presses, pressed),
    }
    reasons = {"scan": roles.scan_reason, "bump": roles.bump_reason, "image": roles.image_reason}
    if presses is not None:
        reasons["bump"] = roles.bump_reason if roles.bumps else source.start.bump_source
    reasons["forward"] = survey.forward_source
    return LogInfo(reader.path.name, facts, reasons, survey.no_return_shares)


def _replay(source: Source, progress: Progress) -> tuple[tuple[Press, ...] | None, IntArray]:
    """Return the presses (None without a bumper) and the stamps of all scans."""
    presses = LogPresses(source, BumperParams())
    stamps = [np.empty(0, dtype=np.int64)]
    for batch, _ in follow(source, 1, progress, "read"):
        stamps.extend(block.stamps_ns for block in batch.scans)
        presses.add(batch)
    return presses.end(), np.concatenate(stamps)


def _pressed(stamps_ns: IntArray, presses: tuple[Press, ...] | None) -> BoolArray:
    """Tell which scans lie in a press."""
    pressed = np.zeros(len(stamps_ns), dtype=bool)
    for press in presses or ():
        pressed |= (stamps_ns >= press.start_ns) & (stamps_ns < press.end_ns)
    return pressed
