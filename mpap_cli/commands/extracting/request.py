"""What ``extract`` is asked for beside logs and topics, and what it found."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.keeping import Margins, Moment
from mpap_cli.logs.reader import LogPath
from mpap_cli.outputs.results_reader import InputFile

NOVEL, PRESSES, PREDICTED, MISSED, FALSE_ALARMS = (
    "novel",
    "press",
    "predicted",
    "missed",
    "false-alarm",
)
REASONS = (NOVEL, PRESSES, PREDICTED, MISSED, FALSE_ALARMS)
_LOOKBACK_S = {NOVEL: 1.0}
_POST_S = {NOVEL: 0.0}
_USUAL_LOOKBACK_S, _USUAL_POST_S = 5.0, 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtractRequest:
    """What is kept, how much of it, and where to.

    ``reason`` is one of ``REASONS``. ``threshold`` is the share of new observations in a
    stretch from which it is kept, or the probability from which a collision is announced;
    with ``keep_ratio`` the best is kept until that share of the duration. ``lookback_s`` and
    ``post_s`` None: as usual for the reason. ``topics`` are names or globs, none: all.
    """

    out: Path
    reason: str
    model: Path | None = None
    threshold: float | None = None
    keep_ratio: float | None = None
    lookback_s: float | None = None
    post_s: float | None = None
    topics: tuple[str, ...] = ()
    split: bool = False
    dry_run: bool = False
    jobs: int = 2

    def __post_init__(self) -> None:
        """Check what does not go together."""
        if self.reason not in REASONS:
            msg = f"reason: found {self.reason}, expected one of {', '.join(REASONS)}"
            raise UsageError(msg)
        if self.reason == NOVEL and self.threshold is not None and self.keep_ratio is not None:
            msg = "--novel takes --keep-ratio or --threshold, not both; leave one out"
            raise UsageError(msg)
        if self.keep_ratio is not None and not 0 < self.keep_ratio <= 1:
            msg = f"--keep-ratio: found {self.keep_ratio:g}, expected above 0 up to 1"
            raise UsageError(msg)

    @property
    def level(self) -> float:
        """The threshold, 0.2 where none is given."""
        return 0.2 if self.threshold is None else self.threshold

    @property
    def lookback(self) -> float:
        """Seconds that are kept before what is worth keeping."""
        usual = _LOOKBACK_S.get(self.reason, _USUAL_LOOKBACK_S)
        return usual if self.lookback_s is None else self.lookback_s

    @property
    def post(self) -> float:
        """Seconds that are kept after it."""
        usual = _POST_S.get(self.reason, _USUAL_POST_S)
        return usual if self.post_s is None else self.post_s

    @property
    def margin_values(self) -> dict[str, float]:
        """Both, for settings.json."""
        return {"lookback": self.lookback, "post": self.post}

    @property
    def margins(self) -> Margins:
        """What is kept about it."""
        return Margins.of_seconds(self.lookback, self.post)


@dataclass(frozen=True, slots=True)
class FoundLog:
    """A log that was looked through: stamp of its first message, and the stretch that counts."""

    name: str
    path: LogPath
    start_ns: int
    first_ns: int
    behind_ns: int


@dataclass(slots=True)
class Found:
    """What is worth keeping: ``segments`` apart, with their margins, log by log."""

    logs: list[FoundLog] = field(default_factory=list)
    segments: list[Moment] = field(default_factory=list)
    inputs: list[InputFile] = field(default_factory=list)
    values: dict[str, Any] = field(default_factory=dict)
    seed: int = 0
    exit_code: int = 0

    @property
    def bounds(self) -> list[tuple[int, int]]:
        """The stretch that counts of each log."""
        return [(log.first_ns, log.behind_ns) for log in self.logs]

    @property
    def length_ns(self) -> int:
        """How long the logs are together."""
        return sum(behind_ns - first_ns for first_ns, behind_ns in self.bounds)
