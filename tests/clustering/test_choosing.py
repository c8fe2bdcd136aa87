"""Which outliers may become exemplars, and what is added so that nothing is uncovered."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.clustering.strap_rows.choosing import cover, eligible
from mpap_cli.distance import squared_distances
from mpap_cli.params import StrapParams
from tests.clustering.blobs import N_DIMS, around, centres, items_of

STRAP = StrapParams(eps=0.18, exemplar_points=3)


def test_support_is_counted_within_the_fit_radius() -> None:
    """Three outliers near one another are enough, two are not, nor are any far apart."""
    rng = np.random.default_rng(0)
    kinds = centres(5)
    outliers = around(kinds[[0, 0, 0, 1, 1, 2, 3]], 0.05, rng)

    rows = eligible(outliers, kinds[4:].astype(np.float32), 7, STRAP)

    assert rows.tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("n_observations", "in_eps", "n_eligible"),
    [
        (3000, 1.2, 6),  # one in 500 of the observations
        (3001, 1.2, 0),
        (3001, 1.45, 0),
        (3001, 1.55, 6),  # beyond the fringe
        (10**6, 1.55, 6),
    ],
)
def test_the_fringe_of_a_cluster_needs_more_support(
    n_observations: int, in_eps: float, n_eligible: int
) -> None:
    """Six outliers near one another, at so many fit radii of a cluster."""
    rng = np.random.default_rng(0)
    cluster = centres(1)
    edge = around(cluster, 0.18, rng).astype(np.float64)
    # around steps along the tangent: go on until the distance is as asked for
    step = edge - cluster
    for _ in range(60):
        made = cluster + step
        made /= np.linalg.norm(made)
        step *= in_eps * 0.18 / np.sqrt(0.5 * np.square(made - cluster).sum())
    near = np.repeat(made, 6, axis=0).astype(np.float32)

    rows = eligible(near, cluster.astype(np.float32), n_observations, STRAP)

    assert rows.tolist() == list(range(n_eligible))


def test_covering_adds_the_heaviest_first_and_is_strict() -> None:
    """Of two that would cover one another the heavier is added; at eps itself nothing covers."""
    items = items_of(np.eye(4, N_DIMS, dtype=np.float32)[[0, 1, 1, 2]])
    items.counts[:] = [1, 1, 5, 1]

    exemplars = cover(items, np.array([0]), np.arange(4), eps=1.0)

    assert exemplars.tolist() == [0, 2, 3]


def test_with_one_point_every_outlier_is_eligible() -> None:
    """STRAP as it was published."""
    points = centres(9).astype(np.float32)

    rows = eligible(points, points[:2], 10**6, replace(STRAP, exemplar_points=1))

    assert rows.tolist() == list(range(9))


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.18, 0.4, 0.9]))
def test_covering_leaves_nothing_outside(seed: int, eps: float) -> None:
    """Each item that is to be kept is strictly within the fit radius of an exemplar."""
    rng = np.random.default_rng(seed)
    items = items_of(around(centres(12)[rng.integers(0, 12, 60)], 0.15, rng))
    items.counts[:] = rng.integers(1, 4, 60)
    start = np.unique(rng.integers(0, 60, 3))
    kept = np.flatnonzero(rng.random(60) < 0.5)

    exemplars = cover(items, start, kept, eps)

    squared = squared_distances(items.exemplars[kept], items.exemplars[exemplars])
    assert (squared.min(axis=1, initial=np.inf) < eps * eps).all()
    assert np.isin(start, exemplars).all()
    added = np.setdiff1d(exemplars, start)
    assert np.isin(added, kept).all()
