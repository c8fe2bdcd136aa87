"""Affinity propagation against scikit-learn, on the same similarities."""

import tracemalloc
from functools import partial
from pathlib import Path

import numpy as np
from sklearn.cluster import affinity_propagation as scikit_learn

from benchmarks.measuring.processes import cpu_of
from benchmarks.measuring.seconds import Seconds
from benchmarks.measuring.table import Row
from benchmarks.speed.streams import hard_stream
from mpap_cli.clustering.affinity_propagation import affinity_propagation, jittered
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.distance import similarities
from mpap_cli.observations import Float64Array
from mpap_cli.params import AffinityParams

REPEATS = {1200: 3, 2000: 3, 5000: 2}
_PARAMS = AffinityParams(preference="median")
_SETTINGS = {
    "damping": _PARAMS.damping,
    "max_iter": _PARAMS.max_iter,
    "convergence_iter": _PARAMS.convergence_iter,
}


def affinity(_folder: Path) -> list[Row]:
    """Cluster N points of the hard stream, median preference."""
    _compare(similarities(hard_stream()[:200]))  # compiles the kernels
    return [row for n, repeats in REPEATS.items() for row in _rows_of(n, repeats)]


def _rows_of(n: int, repeats: int) -> list[Row]:
    """Compare total, iteration and memory for one size."""
    s = jittered(similarities(hard_stream()[:n]), seed=0)
    turns = [_compare(s) for _ in range(repeats)]
    mine, theirs, my_steps, their_steps = (tuple(values) for values in zip(*turns, strict=True))
    squares = _peak_bytes(s) / s.nbytes
    size = f"AP, N = {n:,}"
    return [
        Row(work=f"{size}, total", mpap=mine, beside="scikit-learn", peer=theirs, goal=">= 3x"),
        Row(
            work=f"{size}, one iteration",
            mpap=my_steps,
            beside="scikit-learn",
            peer=their_steps,
            unit="ms",
            goal=">=",
            stretch=">= 5x",
        ),
        Row(
            work=f"{size}, memory beside its input",
            mpap=(squares,),
            beside="N^2 floats",
            peer=(1.0,),
            unit="N^2",
            goal="<= 3.05x",
        ),
    ]


def _compare(s: Float64Array) -> tuple[Seconds, ...]:
    """Run both once; return total seconds and milliseconds per iteration, ours and theirs.

    Raises
    ------
    RuntimeError
        If the labels differ: then nothing is comparable.
    """
    preference = resolve_preference(s, _PARAMS.preference)
    mine, found = cpu_of(lambda: affinity_propagation(s, preference, _PARAMS))
    call = partial(scikit_learn, s.copy(), preference=preference, random_state=0, **_SETTINGS)
    theirs, (_, labels, n_iter) = cpu_of(partial(call, return_n_iter=True))
    if not np.array_equal(labels, found.labels):
        msg = f"labels of scikit-learn differ at N = {len(s)}"
        raise RuntimeError(msg)
    return mine, theirs, 1000 * mine / found.n_iter, 1000 * theirs / n_iter


def _peak_bytes(s: Float64Array) -> int:
    """Return the most memory that is taken beside the input."""
    preference = resolve_preference(s, _PARAMS.preference)
    tracemalloc.start()
    affinity_propagation(s, preference, AffinityParams(max_iter=1, convergence_iter=1))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak
