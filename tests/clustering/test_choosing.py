"""What is added to the exemplars so that nothing is uncovered."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.clustering.strap_rows.choosing import cover
from mpap_cli.distance import squared_distances
from tests.clustering.blobs import N_DIMS, around, centers, items_of


def test_covering_adds_the_heaviest_first_and_is_strict() -> None:
    """Of two that would cover one another the heavier is added; at eps itself nothing covers."""
    items = items_of(np.eye(4, N_DIMS, dtype=np.float32)[[0, 1, 1, 2]])
    items.counts[:] = [1, 1, 5, 1]

    exemplars = cover(items, np.array([0]), np.arange(4), eps=1.0)

    assert exemplars.tolist() == [0, 2, 3]


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.18, 0.4, 0.9]))
def test_covering_leaves_nothing_outside(seed: int, eps: float) -> None:
    """Each item that is to be kept is strictly within the fit radius of an exemplar."""
    rng = np.random.default_rng(seed)
    items = items_of(around(centers(12)[rng.integers(0, 12, 60)], 0.15, rng))
    items.counts[:] = rng.integers(1, 4, 60)
    start = np.unique(rng.integers(0, 60, 3))
    kept = np.flatnonzero(rng.random(60) < 0.5)

    exemplars = cover(items, start, kept, eps)

    squared = squared_distances(items.exemplars[kept], items.exemplars[exemplars])
    assert (squared.min(axis=1, initial=np.inf) < eps * eps).all()
    assert np.isin(start, exemplars).all()
    added = np.setdiff1d(exemplars, start)
    assert np.isin(added, kept).all()
