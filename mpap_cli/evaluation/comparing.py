"""How much of each log is unknown to what was learnt of the others."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from mpap_cli.observations import BoolArray, Float32Array, Float64Array, IntArray
from mpap_cli.systems.columns import LogIndex, LogName
from mpap_cli.systems.obstacles import KnownExemplars

THE_OTHERS = "all others"


@dataclass(frozen=True, slots=True, kw_only=True)
class CompareRow:
    """What one log holds that another did not teach (a row of compare.csv)."""

    log: LogName
    log_index: LogIndex
    against: Annotated[str, "the log that was learnt, or `all others`: unknown to each of them"]
    against_index: Annotated[int | None, "its number; empty for all others"]
    observations: Annotated[int, "scans, or patches of images, of the log"]
    unknown: Annotated[int, "those that what was learnt there does not explain"]
    percent_unknown: Annotated[float, "their share in percent"]


class Comparison:
    """Counts, log by log, which observations the models of the others do not explain.

    Parameters
    ----------
    names : sequence of str
        Base names of the logs.
    known : sequence of KnownExemplars
        What was learnt of each of them alone.
    """

    def __init__(self, names: Sequence[str], known: Sequence[KnownExemplars]) -> None:
        self._names = names
        self._known = known
        n_logs = len(names)
        self._unknown: IntArray = np.zeros((n_logs, n_logs + 1), dtype=np.int64)
        self._observed: IntArray = np.zeros(n_logs, dtype=np.int64)

    def add(self, log: int, features: Float32Array) -> None:
        """Count observations (n, d) of one log."""
        unknown: BoolArray = np.array([one.unknown(features) for one in self._known])
        others = np.arange(len(self._names)) != log
        self._unknown[log, :-1] += unknown.sum(axis=1)
        self._unknown[log, -1] += unknown[others].all(axis=0).sum()
        self._observed[log] += features.shape[0]

    def rows(self) -> list[CompareRow]:
        """Return each log against each other one, then against all others together."""
        n_logs = len(self._names)
        pairs = [(log, other) for log in range(n_logs) for other in [*range(n_logs), -1]]
        return [self._row(log, other) for log, other in pairs if log != other]

    def _row(self, log: int, other: int) -> CompareRow:
        """Return one log against another, -1: against all."""
        return CompareRow(
            log=self._names[log],
            log_index=log,
            against=THE_OTHERS if other < 0 else self._names[other],
            against_index=None if other < 0 else other,
            observations=int(self._observed[log]),
            unknown=int(self._unknown[log, other]),
            percent_unknown=float(100 * self.shares()[log, other]),
        )

    def shares(self) -> Float64Array:
        """Return the unknown share of each log (rows) to each log and, last, to all others."""
        return self._unknown / np.maximum(self._observed, 1)[:, None]
