"""Rows of the table: a figure of mpap beside one of a peer or limit of the same run."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

COLUMNS = ("work", "mpap", "beside", "", "ratio", "spread", "goal", "met")
_WIDTHS = (46, 10, 38, 10, 7, 15, 8, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One line: figures of repeats that were taken in turns, and what is aimed at.

    ``goal`` begins with ">=" (the ratio is peer / mpap: how many times less mpap needs) or
    with "<=" (mpap / peer); without a number nothing is aimed at.
    """

    work: str
    mpap: tuple[float, ...]
    beside: str
    peer: tuple[float, ...]
    goal: str
    unit: str = "s"

    @property
    def ratios(self) -> tuple[float, ...]:
        """Ratio of each repeat; a single figure stands beside all of the others."""
        n = max(len(self.mpap), len(self.peer))
        pairs = zip(_repeated(self.mpap, n), _repeated(self.peer, n), strict=True)
        if self.goal.startswith(">="):
            return tuple(peer / mpap for mpap, peer in pairs)
        return tuple(mpap / peer for mpap, peer in pairs)

    @property
    def ratio(self) -> float:
        """Median of the ratios."""
        return median(self.ratios)

    @property
    def is_met(self) -> bool | None:
        """Whether the goal is met; None without a goal."""
        if not self.goal[2:]:
            return None
        bound = float(self.goal[2:].rstrip("x"))
        return self.ratio >= bound if self.goal.startswith(">=") else self.ratio <= bound


def _repeated(values: Sequence[float], n: int) -> Sequence[float]:
    return values if len(values) == n else [median(values)] * n


def line(cells: Sequence[str]) -> str:
    """Lay out one line of the table."""
    padded = [
        cell.ljust(width) if index in {0, 2} else cell.rjust(width)
        for index, (cell, width) in enumerate(zip(cells, _WIDTHS, strict=True))
    ]
    return "  ".join(padded).rstrip()


def shown(row: Row) -> str:
    """Return the line of a row."""
    low, high = min(row.ratios), max(row.ratios)
    met = {None: "", True: "yes", False: "no"}[row.is_met]
    return line(
        (
            row.work,
            f"{median(row.mpap):.3g} {row.unit}",
            row.beside,
            f"{median(row.peer):.3g} {row.unit}",
            f"{row.ratio:.3g}x",
            f"{low:.3g} - {high:.3g}" if low < high else "",
            row.goal if row.goal[2:] else "",
            met,
        )
    )
