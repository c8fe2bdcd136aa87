"""Runs of message passing, with more damping where one does not end (section 3.2)."""

import logging
from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.observations import BoolArray, Float64Array, IntArray
from mpap_cli.params import AffinityParams

# A run that has not converged is repeated with the next larger of these.
RETRY_DAMPINGS = (0.7, 0.9, 0.95, 0.98)

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class Configuration:
    """A set of exemplars, ascending, and what it is worth (equation 2)."""

    exemplars: IntArray
    net_similarity: float


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """How it ended; ``best`` is None if there was never an exemplar."""

    best: Configuration | None
    n_iter: int
    converged: bool
    damping: float


def run_until_converged(s: Float64Array, params: AffinityParams) -> Run:
    """Repeat with more damping until a run converges; count the iterations of all runs."""
    messages = np.empty_like(s), np.empty_like(s)
    best, n_iter = None, 0
    for damping in (params.damping, *(d for d in RETRY_DAMPINGS if d > params.damping)):
        run = _run(s, messages, damping, params)
        n_iter += run.n_iter
        if run.converged:
            return replace(run, n_iter=n_iter)
        best = _better(best, run.best)
        _log.info("affinity propagation: no end in %d iterations at damping %g", n_iter, damping)
    return replace(run, best=best, n_iter=n_iter)


def _run(
    s: Float64Array,
    messages: tuple[Float64Array, Float64Array],
    damping: float,
    params: AffinityParams,
) -> Run:
    """Pass messages until the exemplars stay or the iterations are used up."""
    from mpap_cli.clustering import _kernels  # noqa: PLC0415  # numba is slow to import

    state = _kernels.start_messages(*messages)
    best = None
    before = np.zeros(len(s), np.bool_)
    unchanged = 0
    for n_iter in range(1, params.max_iter + 1):
        is_exemplar: BoolArray = _kernels.pass_messages(s, state, damping)
        changed = not np.array_equal(is_exemplar, before)
        unchanged = 1 if changed else unchanged + 1
        if changed and is_exemplar.any():
            latest = _configuration(s, np.flatnonzero(is_exemplar))
            best = _better(best, latest)
        before = is_exemplar
        settled = unchanged >= params.convergence_iter < n_iter
        if settled and is_exemplar.any():
            return Run(latest, n_iter, converged=True, damping=damping)
    return Run(best, params.max_iter, converged=False, damping=damping)


def _configuration(s: Float64Array, exemplars: IntArray) -> Configuration:
    from mpap_cli.clustering import _kernels  # noqa: PLC0415  # numba is slow to import

    return Configuration(exemplars, _kernels.net_similarity(s, exemplars))


def _better(one: Configuration | None, other: Configuration | None) -> Configuration | None:
    """Return the one with more net similarity; the first of equals."""
    if one is None or other is None:
        return one or other
    return other if other.net_similarity > one.net_similarity else one
