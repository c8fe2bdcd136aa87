"""Protocols: which scans are learnt and which are scored by that model (section 5.2).

The paper seems to score the scans it learnt from (``in-sample``); the others hold
scans out, in blocks of time, logs or groups of logs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.history import History
from mpap_cli.observations import NS_PER_S, BoolArray, IntArray
from mpap_cli.params import EvaluationParams

PROTOCOLS = (
    "blocked",
    "leave-one-log-out",
    "leave-one-group-out",
    "in-sample",
    "prequential",
    "given-model",
)
MIN_PRESSES = 2
MIN_LOGS = 3
MIN_UNITS = 5
GUARD_SHARE = 0.1
# Outer edges: scans stamped a little outside their log still lie in the outer blocks.
FAR_NS = 2**61


@dataclass(frozen=True, slots=True, eq=False)
class FoldPlan:
    """Folds as parts of the history: blocks between ``edges_ns``, or logs by number.

    ``edges_ns`` (n_folds + 1,) has the outer edges too. ``guard_ns`` (n_folds,) is left out
    of training on either side of a block. ``reason`` says why there is no fold.
    """

    protocol: str
    n_folds: int
    edges_ns: IntArray | None = None
    guard_ns: IntArray | None = None
    fold_of_log: IntArray | None = None
    reason: str = ""

    def place(self, log_index: IntArray, times_ns: IntArray) -> "Folds":
        """Say for scans, by log and time in the history, which fold scores them."""
        if self.edges_ns is not None:
            test = np.searchsorted(self.edges_ns[1:-1], times_ns, side="right")
        elif self.fold_of_log is not None:
            test = self.fold_of_log[log_index]
        else:
            test = np.zeros(log_index.size, dtype=np.int64)
        return Folds(self, np.asarray(test, dtype=np.int64), times_ns)


@dataclass(frozen=True, slots=True, eq=False)
class Folds:
    """Folds of n scans: ``test`` (n,) is the fold whose model scores a scan."""

    plan: FoldPlan
    test: IntArray
    times_ns: IntArray

    def train(self, fold: int) -> BoolArray:
        """Return which of the n scans the model of a fold learns from."""
        plan = self.plan
        if plan.protocol == "in-sample":
            return np.ones(self.test.size, dtype=np.bool_)
        if plan.protocol == "given-model":
            return np.zeros(self.test.size, dtype=np.bool_)
        learnt = self.test < fold if plan.protocol == "prequential" else self.test != fold
        return np.asarray(learnt & ~self._guarded(fold), dtype=np.bool_)

    def _guarded(self, fold: int) -> BoolArray:
        """Mark scans within the guard of a block of time."""
        plan = self.plan
        if plan.edges_ns is None or plan.guard_ns is None:
            return np.zeros(self.test.size, dtype=np.bool_)
        guard = plan.guard_ns[fold]
        first, last = plan.edges_ns[fold : fold + 2]
        inside = (self.times_ns >= first - guard) & (self.times_ns < last + guard)
        return np.asarray(inside, dtype=np.bool_)


def choose_protocol(
    asked: str | None, groups: Sequence[str] | None, history: History
) -> tuple[str, str]:
    """Choose the protocol where none is asked for.

    Parameters
    ----------
    asked : str or None
        One of ``PROTOCOLS``, or None.
    groups : sequence of str or None
        Group of each log, if groups were given.
    history : History
        Logs and presses.

    Returns
    -------
    protocol, reason : str
        The protocol, and why it was taken.

    Raises
    ------
    UsageError
        If the protocol does not exist, or groups are missing or not used.
    """
    if asked is not None:
        if asked not in PROTOCOLS:
            msg = f"--protocol: found {asked}, expected one of {', '.join(PROTOCOLS)}"
            raise UsageError(msg)
        if asked == "leave-one-group-out" and groups is None:
            msg = "--protocol leave-one-group-out: needs --groups folder, REGEX or FILE.csv"
            raise UsageError(msg)
        if asked != "leave-one-group-out" and groups is not None:
            msg = f"--groups goes with leave-one-group-out, not with {asked}; leave out one of them"
            raise UsageError(msg)
        return asked, "asked for"
    if groups is not None:
        return "leave-one-group-out", "groups were given"
    n_logs = np.unique(history.press_log).size
    if n_logs >= MIN_LOGS:
        return "leave-one-log-out", f"{n_logs} logs contain presses"
    return "blocked", f"fewer than {MIN_LOGS} logs contain presses"


def plan_folds(
    protocol: str, history: History, groups: Sequence[str] | None, params: EvaluationParams
) -> FoldPlan:
    """Lay out the folds of a protocol.

    Parameters
    ----------
    protocol : str
        One of ``PROTOCOLS``.
    history : History
        Logs and presses on one clock.
    groups : sequence of str or None
        Group of each log, for ``leave-one-group-out``.
    params : EvaluationParams
        Number of blocks and guard.

    Returns
    -------
    FoldPlan
        With fewer than two presses, or one log or group only, a held-out protocol has no
        fold; ``reason`` says so.
    """
    if protocol in {"in-sample", "given-model"}:
        return FoldPlan(protocol, 1)
    if history.n_presses < MIN_PRESSES:
        found = ("no press", "one press only")[history.n_presses]
        return FoldPlan(protocol, 0, reason=f"{found}: a held-out score needs two presses")
    if protocol in {"blocked", "prequential"}:
        return _blocks(protocol, history, params)
    names = list(groups or ()) if protocol == "leave-one-group-out" else list(range(history.n_logs))
    order = {name: number for number, name in enumerate(dict.fromkeys(names))}
    fold_of_log = np.array([order[name] for name in names], dtype=np.int64)
    if np.unique(fold_of_log[history.press_log]).size < MIN_PRESSES:
        kind = "group" if protocol == "leave-one-group-out" else "log"
        reason = f"one {kind} only has presses: the other {kind}s have none to learn from"
        return FoldPlan(protocol, 0, reason=reason)
    return FoldPlan(protocol, len(order), fold_of_log=fold_of_log)


def bootstrap_units(
    history: History, log_index: IntArray, times_ns: IntArray
) -> tuple[IntArray | None, str]:
    """Say what is resampled for an interval: logs, segments of time, or nothing.

    Returns
    -------
    unit : ndarray of shape (n,) or None
        Unit of each scan.
    kind : str
        ``logs`` (with presses in five or more), ``segments`` cut midway between five or
        more presses, or ``none``.
    """
    if np.unique(history.press_log).size >= MIN_UNITS:
        return log_index, "logs"
    if history.n_presses >= MIN_UNITS:
        cuts = history.edges(history.n_presses)
        return np.asarray(np.searchsorted(cuts, times_ns, side="right"), dtype=np.int64), "segments"
    return None, "none"


def _blocks(protocol: str, history: History, params: EvaluationParams) -> FoldPlan:
    """Contiguous blocks of the history with about the same number of presses each."""
    n_folds = min(params.folds, history.n_presses)
    inner = history.edges(n_folds)
    spans = np.diff(np.concatenate(([0], inner, [history.length_ns])))
    guard = np.minimum(params.guard_s * NS_PER_S, GUARD_SHARE * spans).astype(np.int64)
    edges = np.concatenate(([-FAR_NS], inner, [FAR_NS]))
    return FoldPlan(protocol, n_folds, edges_ns=edges, guard_ns=guard)
