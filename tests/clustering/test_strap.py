"""What a rebuild makes of clusters and outliers (sections 3.3 and 4.2.4)."""

from dataclasses import replace

import numpy as np
import pytest

from mpap_cli.clustering.strap import Strap
from mpap_cli.clustering.strap_rows.arrays import Items, joined
from mpap_cli.clustering.strap_rows.choosing import choose_exemplars
from mpap_cli.clustering.strap_rows.state import StrapParts
from mpap_cli.distance import squared_distances
from mpap_cli.observations import NS_PER_S
from mpap_cli.params import AffinityParams, StrapParams
from tests.clustering.blobs import N_DIMS, around, centers, items_of

AFFINITY = AffinityParams()
STRAP = StrapParams(eps=0.18)


def strap_of(clusters: Items, reservoir: Items, params: StrapParams) -> Strap:
    """Return a Strap that holds these clusters and outliers."""
    counters = {"n_since_rebuild": 0, "n_outliers_ever": 0, "n_rebuilds": 0}
    next_id = clusters.n_items + reservoir.n_items
    parts = StrapParts(clusters, reservoir, np.zeros(4), np.zeros(4), next_id=next_id, **counters)
    return Strap.from_parts(params, AFFINITY, parts)


def four_parts_each(count: int, params: StrapParams) -> Strap:
    """30 kinds of four clusters each, and ten outliers of each of ten new kinds."""
    rng = np.random.default_rng(1)
    kinds = centers(40)
    clusters = items_of(around(np.repeat(kinds[:30], 4, axis=0), 0.05, rng), count=count)
    new = items_of(around(np.repeat(kinds[30:], 10, axis=0), 0.05, rng), first_id=120)
    return strap_of(clusters, new, params)


@pytest.mark.parametrize("count", [1, 10, 1000, 100_000])
def test_heavy_clusters_merge_like_light_ones(count: int) -> None:
    """120 clusters of 30 kinds and outliers of ten new kinds become 40 clusters."""
    strap = four_parts_each(count, STRAP)

    strap.update_clustering()

    assert strap.clusters.n_items == 40
    assert sorted(strap.clusters.counts.tolist()) == sorted([10] * 10 + [4 * count] * 30)


def test_without_a_cap_heavy_clusters_stay_apart() -> None:
    """What the cap is for."""
    strap = four_parts_each(100_000, replace(STRAP, weight_cap=10**9))

    strap.update_clustering()

    assert strap.clusters.n_items == 130


def test_distortion_makes_a_poor_exemplar() -> None:
    """With it, the clusters whose points are far from their exemplars are merged into others."""
    params = replace(STRAP, strap_distortion=True)
    strap = four_parts_each(100, params)
    strap.clusters.distortion[:] = np.where(np.arange(120) % 4 == 2, 0.0, 3.0)

    strap.update_clustering()

    kept = strap.clusters.exemplars[strap.clusters.counts == 400]
    assert kept.tolist() == four_parts_each(100, params).clusters.exemplars[2::4].tolist()


def test_a_merged_cluster_keeps_the_id_of_the_heaviest() -> None:
    """Whichever of them gives the exemplar; the first of equals."""
    strap = four_parts_each(10, STRAP)
    strap.clusters.counts[[1, 2, 7]] = 20

    strap.update_clustering()

    assert strap.clusters.ids[:3].tolist() == [1, 7, 8]
    assert strap.lineage.current(np.arange(12)).tolist() == [1] * 4 + [7] * 4 + [8] * 4


def test_new_clusters_have_ids_of_their_outliers() -> None:
    """They are numbered after all older ones, in the order in which they came."""
    strap = four_parts_each(10, STRAP)

    strap.update_clustering()

    assert strap.clusters.ids[30:].tolist() == list(range(120, 220, 10))


def test_distortion_grows_by_what_a_cluster_is_moved() -> None:
    """Weight times the squared distance to the new exemplar, on top of what there was."""
    strap = four_parts_each(10, STRAP)
    strap.clusters.distortion[:] = 1.0
    before = strap.clusters

    strap.update_clustering()

    squared = squared_distances(before.exemplars[:4], strap.clusters.exemplars[:1])
    assert strap.clusters.distortion[0] == pytest.approx(4.0 + 10.0 * squared.sum())


def test_an_exemplar_that_is_not_covered_stays_a_cluster_of_its_own() -> None:
    """Light clusters that affinity propagation would give to others survive with what they had."""
    kinds = centers(30)
    rng = np.random.default_rng(3)
    clusters = items_of(kinds[:25].astype(np.float32))
    clusters.labels[:, 0] = np.arange(25)
    new = items_of(around(np.repeat(kinds[25:], 12, axis=0), 0.1, rng), first_id=25)
    strap = strap_of(clusters, new, replace(STRAP, eps=0.4))
    items = joined(clusters, new)

    chosen = choose_exemplars(items, 25, replace(STRAP, eps=0.4), AFFINITY)
    strap.update_clustering()

    assert np.count_nonzero(chosen < 25) < 25
    assert strap.clusters.ids[:25].tolist() == list(range(25))
    assert strap.clusters.exemplars[:25].tolist() == clusters.exemplars.tolist()
    assert strap.clusters.labels[:25, 0].tolist() == list(range(25))


def test_nothing_at_all_stays_nothing() -> None:
    """A rebuild without clusters and outliers only counts."""
    strap = Strap(STRAP, AFFINITY, N_DIMS)

    strap.update_clustering()

    assert (strap.clusters.n_items, strap.n_rebuilds) == (0, 1)


def test_the_oldest_outliers_of_a_known_place_join_the_nearest_cluster() -> None:
    """Its counts and labels grow, its weight and distortion do not; the newest wait."""
    kinds = centers(9).astype(np.float32)
    reservoir = items_of(kinds[2:6], first_id=2)
    reservoir.labels[:, 1] = [1, 2, 3, 4]
    params = replace(STRAP, reservoir=4, known_share=0.5, noise_share=0.9)
    strap = strap_of(items_of(kinds[:2]), reservoir, params)
    known = np.repeat(kinds[:1], 9, axis=0)
    none = np.zeros(9, np.int64)

    strap.insert(known, none, none, log_index=0)
    ids, _ = strap.insert(kinds[6:], none[:3], none[:3], log_index=0)

    heirs = squared_distances(kinds[2:5], kinds[:2]).argmin(axis=1)
    assert strap.lineage.current(np.arange(2, 5)).tolist() == heirs.tolist()
    assert strap.clusters.labels[:, 1].tolist() == np.bincount(heirs, [1, 2, 3], 2).tolist()
    assert (strap.clusters.counts - np.bincount(heirs, minlength=2)).tolist() == [10, 1]
    assert strap.clusters.weight.tolist() == [10.0, 1.0]
    assert strap.clusters.distortion.tolist() == [0.0, 0.0]
    assert strap.reservoir.ids.tolist() == [5, *ids.tolist()]
    assert not strap.restarts.is_due


def test_a_window_halves_what_was_last_seen_a_window_ago() -> None:
    """Weights and distortions fade before a rebuild; counts never do."""
    clusters = items_of(centers(3).astype(np.float32), count=8)
    clusters.faded_ns[:] = [0, 30 * NS_PER_S, 60 * NS_PER_S]
    clusters.distortion[:] = 1.0
    strap = strap_of(
        clusters,
        items_of(np.zeros((0, N_DIMS), np.float32)),
        replace(STRAP, strap_window_s=60.0),
    )

    strap.update_clustering()

    assert strap.clusters.weight.tolist() == pytest.approx([4.0, 8.0 * 60 / 90, 8.0])
    assert strap.clusters.distortion.tolist() == pytest.approx([0.5, 60 / 90, 1.0])
    assert strap.clusters.counts.tolist() == [8, 8, 8]
