"""What a reproduction of the paper's experiments found: numbers beside the paper's, pictures."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np


class Item(NamedTuple):
    """A table, figure or claim of the paper: its name and the section it stands in."""

    title: str
    section: str


ITEMS: dict[str, Item] = {
    "table-1": Item("Table 1", "5"),
    "table-2": Item("Table 2", "5.1.1"),
    "table-3": Item("Table 3", "5.1.2"),
    "table-4": Item("Table 4", "5.2"),
    "figure-6": Item("Figure 6", "4.2.6"),
    "figure-7": Item("Figure 7", "5.1.1"),
    "figure-8": Item("Figure 8", "5.1.2"),
    **{f"figure-{number}": Item(f"Figure {number}", "5.2") for number in (9, 10, 11)},
    **{f"figure-{number}": Item(f"Figure {number}", "5.3.1") for number in (12, 13, 14, 15)},
    **{f"figure-{number}": Item(f"Figure {number}", "5.3.2") for number in (16, 17, 18)},
    "stopping-distance": Item("Stopping distance", "5.3.3"),
    "patches": Item("9 to 144 patches", "4.2.2"),
    "min-points": Item("min-points 5 to 10", "3.4"),
    "theta": Item("theta 5 to 15 %", "3.4"),
}
"""Everything that can be reproduced, in the order of the report; the keys are for ``--only``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReproducedRow:
    """One number (a row of reproduced.csv)."""

    experiment: Annotated[str, "name of the experiment"]
    item: Annotated[
        str,
        "table, figure or claim of the paper, with `, part` behind it where it has several tables",
    ]
    row: Annotated[str, "row of that table"]
    quantity: Annotated[str, "what is measured"]
    paper: Annotated[float | None, "the paper's number; empty where it prints none"]
    ours: Annotated[float | None, "mean of the repeats"]
    sd: Annotated[float | None, "their standard deviation"]
    n: Annotated[int | None, "number of repeats"]
    seconds: Annotated[
        float | None, "a duration, instead of `ours`; alone may differ from run to run"
    ]
    note: Annotated[str, "what else is to be known"]


class Picture(NamedTuple):
    """One figure: key in ``ITEMS``, file in the results folder, what it shows."""

    item: str
    file: str
    caption: str


class Finding(NamedTuple):
    """One sentence made of the numbers of this run, about an item (a key of ``ITEMS``)."""

    item: str
    words: str


class Spread(NamedTuple):
    """Mean and standard deviation of repeats; None where there are too few."""

    mean: float | None
    sd: float | None
    n: int


def spread(values: Sequence[float | None]) -> Spread:
    """Return mean and spread of repeats.

    Parameters
    ----------
    values : sequence of float or None
        None or NaN where a repeat has no number; it does not count.

    Returns
    -------
    Spread
        The deviation is that of a sample (n - 1), None for fewer than two.

    Examples
    --------
    >>> spread([1.0, 3.0, None])
    Spread(mean=2.0, sd=1.4142135623730951, n=2)
    """
    known = np.array([value for value in values if value is not None], dtype=np.float64)
    known = known[~np.isnan(known)]
    mean = float(known.mean()) if known.size else None
    sd = float(known.std(ddof=1)) if known.size > 1 else None
    return Spread(mean, sd, known.size)
