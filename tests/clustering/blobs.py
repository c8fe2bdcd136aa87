"""Observations on the unit sphere around given centers."""

import numpy as np

from mpap_cli.clustering.strap_rows.arrays import Items, single_items
from mpap_cli.distance import embed
from mpap_cli.observations import Float32Array, Float64Array

N_DIMS = 40


def centers(n: int, seed: int = 0) -> Float64Array:
    """Embedded histograms that are far apart: no two nearer than 0.4."""
    return embed(np.random.default_rng(seed).dirichlet(np.full(N_DIMS - 1, 0.3), n)).astype(
        np.float64
    )


def around(points: Float64Array, distance: float, rng: np.random.Generator) -> Float32Array:
    """Return one observation at about this distance from each point, in a random direction."""
    steps = rng.normal(size=points.shape)
    steps -= (steps * points).sum(axis=1, keepdims=True) * points
    steps *= distance * np.sqrt(2.0) / np.linalg.norm(steps, axis=1, keepdims=True)
    moved = points + steps
    made: Float32Array = (moved / np.linalg.norm(moved, axis=1, keepdims=True)).astype(np.float32)
    return made


def items_of(points: Float32Array, first_id: int = 0, count: int = 1) -> Items:
    """Items of these points that stand for so many observations each."""
    n = len(points)
    zeros = np.zeros(n, np.int64)
    items = single_items(points, first_id + np.arange(n), zeros, zeros, log_index=0)
    items.counts[:], items.weight[:] = count, count
    return items
