"""Rows of the table: a figure of mpap beside one of a peer or limit of the same run."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from benchmarks.measuring.seconds import Seconds

COLUMNS = (
    "work", "mpap", "clock", "beside", "", "clock", "ratio", "spread", "on clock",
    "goal", "met", "stretch", "met",
)  # fmt: skip
_WIDTHS = (46, 10, 7, 38, 10, 7, 7, 15, 8, 8, 3, 8, 3)
_LEFT = {0, 3}


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One line: figures of repeats that were taken in turns, and what is aimed at.

    ``goal`` begins with ">=" (the ratio is peer / mpap: how many times less mpap needs) or
    with "<=" (mpap / peer); without a number nothing is aimed at. ``stretch`` is a farther
    goal of the same kind, or nothing. Figures that are :class:`Seconds` bring the time on
    the clock with them.
    """

    work: str
    mpap: tuple[float, ...]
    beside: str
    peer: tuple[float, ...]
    goal: str
    unit: str = "s"
    stretch: str = ""

    @property
    def ratios(self) -> tuple[float, ...]:
        """Ratio of each repeat; a single figure stands beside all of the others."""
        return self._ratios(self.mpap, self.peer)

    @property
    def ratio(self) -> float:
        """Median of the ratios."""
        return median(self.ratios)

    @property
    def clock_ratio(self) -> float | None:
        """Median of the ratios of times on the clock, None where none were taken."""
        mine, peer = clocks(self.mpap), clocks(self.peer)
        return median(self._ratios(mine, peer)) if mine and peer else None

    @property
    def is_met(self) -> bool | None:
        """Whether the goal is met; None without a goal."""
        return self._reaches(self.goal)

    @property
    def is_stretch_met(self) -> bool | None:
        """Whether the farther goal is met; None without one."""
        return self._reaches(self.stretch)

    def _ratios(self, mine: Sequence[float], peer: Sequence[float]) -> tuple[float, ...]:
        n = max(len(mine), len(peer))
        pairs = zip(_repeated(mine, n), _repeated(peer, n), strict=True)
        if self.goal.startswith(">="):
            return tuple(float(b) / float(a) for a, b in pairs)
        return tuple(float(a) / float(b) for a, b in pairs)

    def _reaches(self, goal: str) -> bool | None:
        if not goal[2:]:
            return None
        bound = float(goal[2:].rstrip("x"))
        return self.ratio >= bound if goal.startswith(">=") else self.ratio <= bound


def clocks(figures: Sequence[float]) -> list[float]:
    """Return the times on the clock, none unless all figures have one."""
    taken = [figure.clock for figure in figures if isinstance(figure, Seconds)]
    return taken if len(taken) == len(figures) else []


def packed(row: Row) -> dict[str, Any]:
    """Return a row as JSON can hold it."""
    cells: dict[str, Any] = {name: getattr(row, name) for name in Row.__dataclass_fields__}
    for name in ("mpap", "peer"):
        cells[name] = [[float(figure)] for figure in cells[name]]
        for figure, clock in zip(cells[name], clocks(getattr(row, name)), strict=False):
            figure.append(clock)
    return cells


def unpacked(cells: dict[str, Any]) -> Row:
    """Return the row that was packed."""
    figures = {
        name: tuple(Seconds(*one) if one[1:] else one[0] for one in cells[name])
        for name in ("mpap", "peer")
    }
    return Row(**{**cells, **figures})


def _repeated(values: Sequence[float], n: int) -> Sequence[float]:
    return values if len(values) == n else [median(values)] * n


def line(cells: Sequence[str]) -> str:
    """Lay out one line of the table."""
    padded = [
        cell.ljust(width) if index in _LEFT else cell.rjust(width)
        for index, (cell, width) in enumerate(zip(cells, _WIDTHS, strict=True))
    ]
    return "  ".join(padded).rstrip()


def shown(row: Row) -> str:
    """Return the line of a row."""
    low, high = min(row.ratios), max(row.ratios)
    met = {None: "", True: "yes", False: "no"}
    mine, peer = clocks(row.mpap), clocks(row.peer)
    return line(
        (
            row.work,
            f"{median(map(float, row.mpap)):.3g} {row.unit}",
            f"{median(mine):.3g}" if mine else "",
            row.beside,
            f"{median(map(float, row.peer)):.3g} {row.unit}",
            f"{median(peer):.3g}" if peer else "",
            f"{row.ratio:.3g}x",
            f"{low:.3g} - {high:.3g}" if low < high else "",
            f"{row.clock_ratio:.3g}x" if row.clock_ratio is not None else "",
            row.goal if row.goal[2:] else "",
            met[row.is_met],
            row.stretch,
            met[row.is_stretch_met],
        )
    )
