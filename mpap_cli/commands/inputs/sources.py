"""Logs as the user names them: opened, their topics chosen, surveyed, ready to replay."""

import logging
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from mpap_cli.commands.inputs.press_file import presses_by_hand
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sensors import SCAN, sensors_of
from mpap_cli.errors import LogError
from mpap_cli.logs.clocks import out_of_turn
from mpap_cli.logs.reader import Damage, LogPath, LogReader, open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.survey import Survey, survey_log
from mpap_cli.logs.topics import Roles, choose_roles
from mpap_cli.observations import Batch
from mpap_cli.outputs.text_table import count
from mpap_cli.params import Settings
from mpap_cli.properties.press_files import PressRow, presses_of_log
from mpap_cli.properties.presses import with_virtual_bumps
from mpap_cli.systems.labelling import LogStart

LOGGER = logging.getLogger(__name__)
DAMAGED = 3


@dataclass(slots=True)
class Losses:
    """What could not be read: whole logs that were left out, and damage inside the others."""

    left_out: list[str] = field(default_factory=list)
    damage: list[Damage] = field(default_factory=list)
    lost_images: int = 0

    @property
    def exit_code(self) -> int:
        """0, or 3 if part of the input was left out."""
        return DAMAGED if self.left_out or self.damage or self.lost_images else 0

    def note(self, source: "Source") -> None:
        """Keep and tell what was found damaged or skipped in a log that has been read."""
        for item in source.reader.damage:
            LOGGER.warning("%s", item.text)
        self.damage.extend(source.reader.damage)
        for finding in source.replay.clock_findings():
            LOGGER.warning("%s: %s", source.name, finding)
        skipped = source.replay.skipped + source.skipped
        for reason, n_skipped in skipped.items():
            what = next((word for word in ("image", "pose") if f" {word} " in reason), "scan")
            self.lost_images += n_skipped if what == "image" else 0
            LOGGER.warning("%s: %s skipped: %s", source.name, count(n_skipped, what), reason)
        for reason, n_lost in source.lost_images.items():
            LOGGER.warning("%s: %s left out: %s", source.name, count(n_lost, "image"), reason)
        self.lost_images += source.lost_images.total()


@dataclass(frozen=True, slots=True)
class Source:
    """One opened log with its topics chosen and its geometry known.

    ``sensors`` are replayed; ``bump_distance_m`` is set where presses come from near scans;
    ``skipped`` counts scans that were read but gave no feature, by reason, and
    ``lost_images`` images that were left out.
    """

    name: str
    path: LogPath
    index: int
    reader: LogReader
    roles: Roles
    survey: Survey
    replay: Replay
    start: LogStart
    sensors: frozenset[str]
    bump_distance_m: float | None
    skipped: Counter[str] = field(default_factory=Counter)
    lost_images: Counter[str] = field(default_factory=Counter)

    def batches(self) -> Iterator[Batch]:
        """Replay the log; with --bump-from scan the bumps come from near scans."""
        for batch in self.replay:
            if self.bump_distance_m is None:
                yield batch
            else:
                yield with_virtual_bumps(batch, self.bump_distance_m, self.survey.range_max)


def open_sources(
    selection: LogSelection, settings: Settings, losses: Losses, *, required: bool = True
) -> Iterator[Source]:
    """Open one log after the other, in the order given; each is closed at the next.

    Parameters
    ----------
    selection : LogSelection
        Which logs and topics.
    settings : Settings
        Forward direction and bumper settings.
    losses : Losses
        Filled with what could not be read.
    required : bool
        As for :func:`survey_source`.

    Yields
    ------
    Source
        A log ready to replay; ``index`` counts those that could be read.

    Raises
    ------
    LogError
        If no log is left, or with ``strict`` if one cannot be read.
    UsageError
        If a log has no scan topic, or several.
    """
    paths = selection.paths()
    settings = selection.settings_for(settings)
    by_hand = presses_by_hand(selection, paths)
    index, before = 0, None
    for path in paths:
        try:
            reader = open_readable(path, selection)
        except LogError as error:
            if selection.strict or len(paths) == 1:
                raise
            LOGGER.warning("%s; left out", error)
            losses.left_out.append(path.name)
            continue
        with reader:
            source = survey_source(reader, index, selection, settings, by_hand, required=required)
            tell_of_source(source)
            if before is not None and (words := out_of_turn(reader, before)):
                LOGGER.warning("%s: %s", path.name, words)
            before = reader
            yield source
            losses.note(source)
        index += 1
    if index == 0:
        msg = f"none of the {len(paths)} logs can be read: {', '.join(losses.left_out)}"
        raise LogError(msg)


def open_readable(path: LogPath, selection: LogSelection) -> LogReader:
    """Open a log that holds at least one message.

    Raises
    ------
    LogError
        If it cannot be read or holds no message.
    """
    reader = open_log(path, msgs=selection.msgs, strict=selection.strict)
    if reader.n_messages == 0:
        with reader:
            for text in reader.warnings:
                LOGGER.warning("%s", text)
            msg = f"{path.name}: no messages; check that the recording was stopped properly"
            raise LogError(msg)
    return reader


def survey_source(
    reader: LogReader,
    index: int,
    selection: LogSelection,
    settings: Settings,
    by_hand: dict[str, tuple[PressRow, ...]] | None,
    *,
    required: bool = True,
) -> Source:
    """Choose the topics of an open log, survey it, and find where presses come from.

    Parameters
    ----------
    reader : LogReader
        An open log.
    index : int
        Its place among the logs that could be read.
    selection : LogSelection
        Topics, and what makes a press.
    settings : Settings
        Forward direction and bumper settings.
    by_hand : dict or None
        As from :func:`presses_by_hand`.
    required : bool
        Whether the log must have the sensors of the selection; else scans are replayed
        if there are any.

    Returns
    -------
    Source

    Raises
    ------
    UsageError
        If a topic asked for cannot play its role, a required sensor is missing, or a press
        begins after the log.
    """
    name = reader.path.name
    roles = choose_roles(reader, selection.topic_choice)
    survey = survey_log(reader, roles, settings.scan.forward_rad())
    sensors = sensors_of(roles, name, selection.sensor) if required else SCAN
    replay = Replay(reader, roles, settings.bumper, selection.replay_options(sensors))
    kind, hold_s, presses, words = None, None, None, "none"
    if by_hand is not None:
        rows = by_hand.get(name, ())
        presses = presses_of_log(rows, index, reader.start_ns, reader.end_ns)
        words = f"file {Path(selection.bump_from).name}"
    elif selection.bump_from == "scan":
        kind, words = "level", f"scan nearer than {selection.bump_distance_m:g} m"
    elif roles.bumps:
        kind, hold_s = replay.bump_kind, replay.hold_s
        words = f"bumper {', '.join(role.topic.name for role in roles.bumps)}"
    start = LogStart(
        name=name,
        start_ns=reader.start_ns,
        forward_rad=survey.forward_rad,
        range_max=survey.range_max,
        bump_kind=kind,
        hold_s=hold_s,
        presses=presses,
        bump_source=words,
    )
    distance_m = selection.bump_distance_m if selection.bump_from == "scan" else None
    return Source(
        name, reader.path, index, reader, roles, survey, replay, start, sensors, distance_m
    )


def tell_of_source(source: Source) -> None:
    """Say what was chosen, and what is odd about the log."""
    name, roles, presses_from = source.name, source.roles, source.start.bump_source
    presses_from = presses_from if presses_from != "none" else roles.bump_reason
    used = [
        f"{what}s from {topic.name} ({reason})"
        for what, topic, reason in (
            ("scan", roles.scan, roles.scan_reason),
            ("image", roles.image, roles.image_reason),
        )
        if topic is not None and what in source.sensors
    ]
    used.append(f"presses from {presses_from}")
    LOGGER.info("%s: %s", name, ", ".join(used))
    for warning in (*source.reader.warnings, *(f"{name}: {note}" for note in roles.notes)):
        LOGGER.warning("%s", warning)
