"""Which logs a user names, and what to read in them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpap_cli.logs.fields import TimeSource
from mpap_cli.logs.replay import ReplayOptions
from mpap_cli.logs.topics import TopicChoice
from mpap_cli.params import Settings, settings_values


@dataclass(frozen=True, slots=True, kw_only=True)
class LogSelection:
    """Which logs to read, and what in them.

    ``logs`` are paths or globs; ``start`` and ``end`` are texts as after ``--start``;
    ``bump_from`` is topic, scan, none or the path of a CSV with presses.
    """

    logs: tuple[str, ...] = ()
    scan_topic: str | None = None
    image_topic: str | None = None
    bump_topics: tuple[str, ...] = ()
    bump_from: str = "topic"
    bump_distance_m: float = 0.25
    start: str | None = None
    end: str | None = None
    time_source: TimeSource = "log"
    msgs: tuple[Path, ...] = ()
    strict: bool = False

    @property
    def topic_choice(self) -> TopicChoice:
        """The part of the selection that chooses topics."""
        kind = self.bump_from if self.bump_from in {"topic", "scan", "none"} else "file"
        return TopicChoice(
            scan=self.scan_topic, image=self.image_topic, bumps=self.bump_topics, bump_from=kind
        )

    @property
    def replay_options(self) -> ReplayOptions:
        """The part of the selection that says what is replayed."""
        return ReplayOptions(start=self.start, end=self.end, time_source=self.time_source)

    def values(self, settings: Settings) -> dict[str, Any]:
        """Return all that can change results, for settings.json: no paths, no threads."""
        return {
            **settings_values(settings),
            "profile": settings.profile,
            "scan-topic": self.scan_topic,
            "image-topic": self.image_topic,
            "bump-topic": list(self.bump_topics),
            "bump-from": Path(self.bump_from).name,
            "bump-distance": self.bump_distance_m,
            "start": self.start,
            "end": self.end,
            "time-source": self.time_source,
        }
