"""Which logs a user names, and what to read in them."""

import logging
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from mpap_cli.logs.fields import TimeSource
from mpap_cli.logs.reader import LogPath, expand_paths
from mpap_cli.logs.replay import ReplayOptions
from mpap_cli.logs.topics import TopicChoice
from mpap_cli.params import Settings, settings_values

LOGGER = logging.getLogger(__name__)
OPTIONS = {
    "scan_topic": "--scan-topic",
    "image_topic": "--image-topic",
    "bump_topics": "--bump-topic",
    "bump_from": "--bump-from",
    "bump_distance_m": "--bump-distance",
    "forward": "--forward",
    "start": "--start",
    "end": "--end",
    "time_source": "--time-source",
    "msgs": "--msgs",
    "strict": "--strict",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class LogSelection:
    """Which logs to read, and what in them.

    ``logs`` are paths or globs; ``start`` and ``end`` are texts as after ``--start``;
    ``bump_from`` is topic, scan, none or the path of a CSV with presses; ``forward``
    degrees or tf, None where the settings say it; ``sensor`` one of ``sensors.SENSORS``;
    with ``once`` a log that is named twice is read once.
    """

    logs: tuple[str, ...] = ()
    sensor: str = "scan"
    once: bool = True
    scan_topic: str | None = None
    image_topic: str | None = None
    bump_topics: tuple[str, ...] = ()
    bump_from: str = "topic"
    bump_distance_m: float = 0.25
    forward: str | None = None
    start: str | None = None
    end: str | None = None
    time_source: TimeSource = "log"
    msgs: tuple[Path, ...] = ()
    strict: bool = False

    @property
    def press_file(self) -> Path | None:
        """The CSV with presses, if they come from one."""
        return None if self.bump_from in {"topic", "scan", "none"} else Path(self.bump_from)

    @property
    def options_said(self) -> tuple[str, ...]:
        """The options that were given another value than their default."""
        defaults = {item.name: item.default for item in fields(self)}
        return tuple(
            option for name, option in OPTIONS.items() if getattr(self, name) != defaults[name]
        )

    @property
    def topic_choice(self) -> TopicChoice:
        """The part of the selection that chooses topics."""
        kind = "file" if self.press_file else self.bump_from
        return TopicChoice(
            scan=self.scan_topic, image=self.image_topic, bumps=self.bump_topics, bump_from=kind
        )

    def paths(self) -> list[LogPath]:
        """Return the logs in the order given.

        Raises
        ------
        LogError
            If a word names nothing.
        """
        named = [path for word in self.logs for path in expand_paths([word])]
        if not self.once:
            return named
        found: dict[LogPath, LogPath] = {}
        for path in named:
            if path.resolve() in found:
                LOGGER.warning("%s: given twice; read once", path.name)
            found.setdefault(path.resolve(), path)
        return list(found.values())

    def replay_options(self, sensors: frozenset[str]) -> ReplayOptions:
        """Return the part of the selection that says what is replayed of these sensors."""
        return ReplayOptions(
            start=self.start, end=self.end, time_source=self.time_source, sensors=sensors
        )

    def with_sensor_of(self, sensor: str) -> "LogSelection":
        """Return the selection with the sensor of a model, unless one was asked for."""
        return replace(self, sensor=sensor) if self.sensor == "auto" else self

    def settings_for(self, settings: Settings) -> Settings:
        """Return the settings with the forward direction of these logs.

        Raises
        ------
        SettingError
            If it is neither tf nor degrees.
        """
        if self.forward is None:
            return settings
        return replace(settings, scan=replace(settings.scan, forward=self.forward))

    def values(self, settings: Settings) -> dict[str, Any]:
        """Return all that can change results, for settings.json: no paths, no threads."""
        return {
            **settings_values(self.settings_for(settings)),
            "profile": settings.profile,
            "sensor": self.sensor,
            "scan-topic": self.scan_topic,
            "image-topic": self.image_topic,
            "bump-topic": list(self.bump_topics),
            "bump-from": Path(self.bump_from).name,
            "bump-distance": self.bump_distance_m,
            "start": self.start,
            "end": self.end,
            "time-source": self.time_source,
        }
