"""Which experiments there are, and what each of them delivers."""

from collections.abc import Callable
from dataclasses import dataclass

from mpap_cli.commands.reproducing import (
    large_scale,
    laser,
    long_term,
    overview,
    patch_grids,
    stopping_runs,
    surroundings,
    sweeps,
    synthetic,
    textures,
)
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.evaluation.reproduced import ITEMS


@dataclass(frozen=True, slots=True)
class Experiment:
    """One experiment: its name, what it delivers, the function that does the work.

    ``cost`` is about how many seconds it takes: the longest begin first, so that several
    processes end together.
    """

    name: str
    items: tuple[str, ...]
    run: Callable[[Bench], None]
    cost: int

    def wanted(self, only: tuple[str, ...]) -> frozenset[str]:
        """Return the items to deliver; all of them where nothing is named."""
        return frozenset(self.items) & frozenset(only or ITEMS)


EXPERIMENTS: tuple[Experiment, ...] = (
    Experiment("overview", ("table-1",), overview.run, 0),
    Experiment("textures", ("table-2", "table-3", "figure-7"), textures.run, 40),
    Experiment("synthetic", ("table-3", "figure-8"), synthetic.run, 40),
    Experiment("large scale", large_scale.ITEMS, large_scale.run, 30),
    Experiment("laser", ("table-4", "figure-9", "figure-10", "figure-11"), laser.run, 160),
    Experiment("surroundings", surroundings.ITEMS, surroundings.run, 200),
    Experiment("long term", long_term.ITEMS, long_term.run, 150),
    Experiment("stopping", stopping_runs.ITEMS, stopping_runs.run, 150),
    Experiment("patch grids", patch_grids.ITEMS, patch_grids.run, 150),
    Experiment("sweeps", ("min-points", "theta"), sweeps.run, 30),
)
"""In the order of the paper, which the results keep."""
