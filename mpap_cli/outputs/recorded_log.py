"""What a recording says of a log beside its scans."""

from dataclasses import dataclass

from mpap_cli.observations import Press


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedLog:
    """What is known of a log when all its scans have been written.

    The fields mean what they mean in ``ObservedLog``; of ``path`` the base name and
    the folder around it are kept (``--groups folder``), not where that lies.
    """

    name: str
    path: str
    start_ns: int
    end_ns: int
    forward_rad: float
    range_max: float | None
    presses: tuple[Press, ...] | None
    bump_source: str
