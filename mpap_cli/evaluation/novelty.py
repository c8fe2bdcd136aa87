"""How much of what the robot sees is new to it, over time (section 5.3, Fig. 13, 17, 18).

Two figures stand side by side: the share of observations that were outliers of the model
as it learnt on, and the share that the model did not know as it stood when the log began.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.novelty_windows import (
    BIN,
    CLUSTERS,
    NOVEL,
    OBSERVATIONS,
    UNKNOWN,
    LogCounts,
    sum_windows,
)
from mpap_cli.observations import NS_PER_S, IntArray
from mpap_cli.systems.columns import LogIndex, LogName, Sensor

_PAST_WINDOWS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class NoveltyRow:
    """One window of one log (a row of novelty.csv)."""

    log: LogName
    log_index: LogIndex
    sensor: Sensor
    window_start_s: Annotated[
        float, "begin of the window in seconds since the first message of the log"
    ]
    window_end_s: Annotated[float, "its end, at the latest the last observation"]
    start_stamp_ns: Annotated[int, "begin in nanoseconds, as in the log"]
    observations: Annotated[int, "scans, or patches of images, in the window"]
    novel: Annotated[int, "those that the model did not know when they came"]
    percent_novel: Annotated[float, "their share in percent"]
    percent_unknown_at_start: Annotated[
        float | None, "percent of the whole log unknown to the model as it began; empty without one"
    ]
    clusters: Annotated[
        int | None, "clusters at the end of the window; empty where nobody counts them"
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Boundary:
    """What the model met when a log began.

    ``percent_unknown_at_start`` is of the whole log (None without a model before it),
    ``first_window_percent`` is the novelty of its first window, ``ratio`` how many times
    that of the last three windows before it, counted over their observations (None where
    there are none, or none of them was novel).
    """

    log: str
    log_index: int
    percent_unknown_at_start: float | None
    first_window_percent: float
    ratio: float | None


class NoveltyMeter:
    """Counts new observations in windows of log time.

    Windows begin with the first observation of each log, so none straddles two logs; one
    without an observation has no row. They follow one another, or overlap where ``step_s``
    is shorter than the window; the last one of a log is the first that reaches its end.

    Parameters
    ----------
    sensor : str
        What is observed: image or scan.
    window_s : float
        Length of a window in seconds.
    step_s : float, optional
        Seconds from the start of one window to the next; must divide ``window_s``.
        None: one window begins where the other ends.

    Raises
    ------
    UsageError
        If the step does not divide the window.

    Notes
    -----
    Observations stay in the order in which they arrive: one that is stamped before an
    earlier one, since the clock jumped back, counts at the time of that.

    Examples
    --------
    >>> meter = NoveltyMeter("image", window_s=60)
    >>> meter.begin_log("day1.bag", start_ns=0)
    >>> stamps_ns = np.array([1, 30, 70]) * NS_PER_S
    >>> meter.add(stamps_ns, 36, novel=np.array([36, 9, 0]))
    >>> meter.end_log()
    >>> [(row.window_start_s, row.window_end_s, row.percent_novel) for row in meter.rows()]
    [(1.0, 61.0, 62.5), (61.0, 70.0, 0.0)]
    """

    def __init__(self, sensor: str, window_s: float = 60.0, step_s: float | None = None) -> None:
        self.sensor = sensor
        step_s = window_s if step_s is None else step_s
        self._bin_ns = round(step_s * NS_PER_S)
        self._n_bins, rest = divmod(round(window_s * NS_PER_S), max(self._bin_ns, 1))
        if rest or self._n_bins < 1:
            msg = (
                f"novelty: a step of {step_s:g} s does not divide the window of {window_s:g} s; "
                "give one that does"
            )
            raise UsageError(msg)
        self._rows: list[NoveltyRow] = []
        self._boundaries: list[Boundary] = []
        self._past: deque[tuple[int, int]] = deque(maxlen=_PAST_WINDOWS)
        self._n_logs = 0
        self._log = LogCounts("", 0)

    def begin_log(self, name: str, start_ns: int) -> None:
        """Begin the next log of the history.

        Parameters
        ----------
        name : str
            Base name of the log.
        start_ns : int
            Stamp of its first message.
        """
        self._log = LogCounts(name, start_ns)

    def add(
        self,
        stamps_ns: IntArray,
        observations_each: int,
        novel: IntArray,
        unknown: IntArray | None = None,
        n_clusters: int | None = None,
    ) -> None:
        """Count observations of the log that has begun.

        Parameters
        ----------
        stamps_ns : ndarray of shape (n,)
            Stamps of the images or scans, in order of arrival.
        observations_each : int
            How many observations each of them is: patches of an image, 1 for a scan.
        novel : ndarray of shape (n,)
            How many of those were new when they were learnt.
        unknown : ndarray of shape (n,), optional
            How many of those are unknown to the model as it stood when the log began;
            None if there was no model then.
        n_clusters : int, optional
            How many clusters there are after these observations.
        """
        if not stamps_ns.size:
            return
        log = self._log
        times_ns = log.times_of(stamps_ns)
        bins, first = np.unique((times_ns - log.first_ns) // self._bin_ns, return_index=True)
        table = np.zeros((bins.size, 5), dtype=np.int64)
        table[:, BIN] = bins
        table[:, OBSERVATIONS] = np.diff(first, append=stamps_ns.size) * observations_each
        table[:, NOVEL] = np.add.reduceat(novel.astype(np.int64), first)
        if unknown is None:
            log.has_unknown = False
        else:
            table[:, UNKNOWN] = np.add.reduceat(unknown.astype(np.int64), first)
        table[:, CLUSTERS] = -1 if n_clusters is None else n_clusters
        log.append(table)

    def end_log(self) -> None:
        """Close the log: its windows become rows. A log without observations has none."""
        log, index = self._log, self._n_logs
        self._n_logs += 1
        if not log.bins:
            return
        table = np.array(log.bins, dtype=np.int64)
        self._rows.extend(self._make_rows(log, index, table))
        one_by_one = sum_windows(table, self._n_bins, self._n_bins)
        self._boundaries.append(self._make_boundary(log, index, one_by_one))
        counts = one_by_one[-_PAST_WINDOWS:, [NOVEL, OBSERVATIONS]]
        self._past.extend((novel, n) for novel, n in counts.tolist())

    def rows(self) -> list[NoveltyRow]:
        """Return the windows of the logs that have ended, in order."""
        return list(self._rows)

    def boundaries(self) -> list[Boundary]:
        """Return one entry for each log that has ended and held an observation."""
        return list(self._boundaries)

    def _make_rows(self, log: LogCounts, index: int, table: IntArray) -> Iterator[NoveltyRow]:
        """Yield the windows of one log."""
        found = sum_windows(table, self._n_bins, 1)
        for first_bin, n, novel, unknown, clusters in found.tolist():
            start_ns = log.first_ns + first_bin * self._bin_ns
            end_ns = min(start_ns + self._n_bins * self._bin_ns, log.latest_ns)
            yield NoveltyRow(
                log=log.name,
                log_index=index,
                sensor=self.sensor,
                window_start_s=(start_ns - log.start_ns) / NS_PER_S,
                window_end_s=(end_ns - log.start_ns) / NS_PER_S,
                start_stamp_ns=start_ns,
                observations=n,
                novel=novel,
                percent_novel=100 * novel / n,
                percent_unknown_at_start=100 * unknown / n if log.has_unknown else None,
                clusters=clusters if clusters >= 0 else None,
            )

    def _make_boundary(self, log: LogCounts, index: int, windows: IntArray) -> Boundary:
        """Compare the first window of a log with the last ones before it."""
        n, novel = int(windows[0, OBSERVATIONS]), int(windows[0, NOVEL])
        novel_before = sum(past[0] for past in self._past)
        n_before = sum(past[1] for past in self._past)
        unknown = windows[:, UNKNOWN].sum() / windows[:, OBSERVATIONS].sum()
        return Boundary(
            log=log.name,
            log_index=index,
            percent_unknown_at_start=100 * float(unknown) if log.has_unknown else None,
            first_window_percent=100 * novel / n,
            ratio=novel * n_before / (n * novel_before) if novel_before else None,
        )
