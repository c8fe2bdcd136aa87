"""Which part of a log is played back, and of which sensors."""

from dataclasses import dataclass

from mpap_cli.errors import SettingError
from mpap_cli.logs.fields import TimeSource
from mpap_cli.logs.times import parse_time

SENSORS = ("scan", "image", "odometry")


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOptions:
    """Which part of a log is played back, by which clock, in blocks of what size.

    ``start`` and ``end`` are as `parse_time` reads them and cut by log time, start <= t <
    end; ``time_source`` is the clock of the stamps that come out; of ``sensors``, some of
    `SENSORS`, nothing else is read but bumps.

    Raises
    ------
    SettingError
        If there is no such sensor.
    """

    start: str | None = None
    end: str | None = None
    time_source: TimeSource = "log"
    block_scans: int = 1024
    sensors: frozenset[str] = frozenset({"scan"})

    def __post_init__(self) -> None:
        """Check the sensors."""
        if unknown := self.sensors.difference(SENSORS):
            msg = f"sensors: found {min(unknown)}, expected some of {', '.join(SENSORS)}"
            raise SettingError(msg)

    def cut(self, log_start_ns: int) -> tuple[int | None, int | None]:
        """Turn start and end into stamps; None where nothing is cut.

        Raises
        ------
        SettingError
            If one is no time, or the start is not before the end.
        """
        start = parse_time(self.start, log_start_ns) if self.start is not None else None
        end = parse_time(self.end, log_start_ns) if self.end is not None else None
        if start is not None and end is not None and start >= end:
            msg = f"--start {self.start} is not before --end {self.end}"
            raise SettingError(msg)
        return start, end
