"""What a collision model tells of observations and of its clusters."""

from collections.abc import Callable

import numpy as np
import pytest

from mpap_cli.observations import (
    NS_PER_S,
    Batch,
    FeatureBlock,
    Press,
    ScanBlock,
)
from mpap_cli.params import Settings, make_settings
from mpap_cli.properties.labels import label_scans
from mpap_cli.systems.collision import CollisionModel

Drive = Callable[[int, int], tuple[ScanBlock, tuple[Press, ...]]]
PartOf = Callable[[ScanBlock, int, int], ScanBlock]
Batches = Callable[[ScanBlock, tuple[Press, ...], int], list[Batch]]
Replayed = Callable[..., CollisionModel]
FeaturesOf = Callable[[Settings, ScanBlock], FeatureBlock]


def test_clusters_describe_what_was_seen(replayed: Replayed) -> None:
    """Sums over clusters are those of the cluster-points; times count from the exemplar's log."""
    model = replayed(make_settings())

    rows = model.clusters()

    points = model.meta_points
    of_clusters = points.count[points.is_cluster_point].sum()
    assert sum(row.observations for row in rows) == of_clusters
    assert sum(row.meta_points for row in rows) == points.is_cluster_point.sum()
    onsets = points.counts[points.is_cluster_point, 1].sum(axis=0)
    assert [sum(r.non_collisions for r in rows), sum(r.collisions for r in rows)] == onsets.tolist()
    assert {row.exemplar_log for row in rows} == {"a.bag"}
    assert all(
        row.exemplar_time_s * NS_PER_S == pytest.approx(row.exemplar_stamp_ns) for row in rows
    )
    assert all(row.first_seen_s <= row.exemplar_time_s <= row.last_seen_s for row in rows)
    hit = max(rows, key=lambda row: row.collisions)
    assert 1 <= hit.presses <= 20
    assert hit.visits >= hit.presses
    assert hit.p_low is not None
    assert hit.p_high is not None
    assert 0 < hit.p_low < hit.p_high < 1


def test_the_paper_shows_shares_and_robust_posterior_means(replayed: Replayed) -> None:
    """Equation 8 as it stands, or shrunk by Jeffreys' prior."""
    paper, robust = replayed(make_settings("paper")), replayed(make_settings())

    for row in paper.clusters():
        assert row.p_collision == row.collisions / (row.collisions + row.non_collisions)
    for row in robust.clusters():
        total = row.collisions + row.non_collisions
        assert row.p_collision == (
            pytest.approx((row.collisions + 0.5) / (total + 1)) if total else None
        )


def test_the_cluster_of_a_prediction_has_its_probability_in_the_table(
    drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """timeline.csv and clusters.csv agree."""
    model = replayed(make_settings())
    shown = {row.cluster: row.p_collision for row in model.clusters()}
    features = features_of(model.settings, drive(60, 2)[0])

    found = model.predict(features)

    known = [shown[cluster] for cluster in found.cluster.tolist()]
    assert found.p_cluster.tolist() == known


def test_a_contact_rises_with_the_onset(
    drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """The map never turns the order; it brings the mean to the share of contacts."""
    model = replayed(make_settings())
    block, presses = drive(240, 1)
    features = features_of(model.settings, block)

    onset = model.predict(features, "onset").p_collision
    contact = model.predict(features, "contact").p_collision

    order = np.argsort(onset, kind="stable")
    assert (np.diff(contact[order])[np.diff(onset[order]) > 0] > 0).all()
    share = label_scans(block.stamps_ns, presses, model.settings.properties)[:, 0].mean()
    assert contact.mean() == pytest.approx(share, abs=0.05)
    assert onset.mean() < contact.mean()


def test_the_paper_scores_all_targets_by_the_contact_pair(
    drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """Its model has one pair of counts."""
    model = replayed(make_settings("paper"))
    features = features_of(model.settings, drive(60, 2)[0])

    found = {
        model.predict(features, target).p_collision.tobytes()
        for target in ("contact", "onset", "early")
    }

    assert len(found) == 1


def test_robust_scores_early_by_its_own_pair(
    drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """What comes before a press is not what is seen during it."""
    model = replayed(make_settings())
    block, presses = drive(240, 1)
    early = label_scans(block.stamps_ns, presses, model.settings.properties)[:, 2]
    features = features_of(model.settings, block)

    p = model.predict(features, "early").p_collision

    assert p[early == 1].mean() > 3 * p[early == 0].mean()


def test_the_self_check_says_how_theta_suits(replayed: Replayed) -> None:
    """Few cluster-points: too large; much noise: too small."""
    large = replayed(make_settings(values={"theta": "0.9"})).self_check()
    small = replayed(make_settings(values={"theta": "0.0001"})).self_check()
    good = replayed(make_settings(values={"theta": "0.02"})).self_check()

    assert (large.theta_too_large, large.theta_too_small) == (True, False)
    assert (small.theta_too_large, small.theta_too_small) == (False, True)
    assert (good.theta_too_large, good.theta_too_small) == (False, False)
