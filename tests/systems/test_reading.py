"""What a collision model tells of observations and of its clusters."""

from collections.abc import Callable

import numpy as np
import pytest

from mpap_cli.classifier import classify
from mpap_cli.observations import (
    NS_PER_S,
    Batch,
    FeatureBlock,
    Press,
    ScanBlock,
)
from mpap_cli.params import Settings, make_settings
from mpap_cli.properties.counts import ratio
from mpap_cli.properties.labels import ONSET, label_scans
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.training import LabelledFeatures, train

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

    base_rate = ratio(model.meta_points.counts[:, 1].sum(axis=0))
    known = [base_rate if shown[at] is None else shown[at] for at in found.cluster.tolist()]
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


def test_curves_over_the_nearest_ranges_join_the_kernel(
    drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """Their share moves the odds from the kernel's all the way to those of the curves."""
    block, _ = drive(60, 2)
    settings = [make_settings(values={"range-share": share}) for share in ("0", "0.5", "1")]
    models = [replayed(one) for one in settings]
    features = features_of(settings[0], block)

    odds = []
    for model in models:
        p = model.predict(features, "onset").p_collision
        odds.append(np.log(p / (1 - p)))

    np.testing.assert_allclose(odds[1], (odds[0] + odds[2]) / 2, atol=1e-9)
    assert np.corrcoef(odds[2], features.features[:, 3])[0, 1] > 0.5


def test_only_a_kernel_has_curves(
    drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """Another read-out says what its clusters say."""
    settings = make_settings(values={"readout": "metapoint"})
    model = replayed(settings)
    features = features_of(settings, drive(60, 2)[0])

    found = model.predict(features, "onset").p_collision

    read = classify(
        model.meta_points,
        model.parts().clustered,
        settings.properties,
        ONSET,
        features.features,
    )
    np.testing.assert_allclose(found, read.p_collision, atol=1e-15)


def test_without_a_press_the_kernel_stands_alone(drive: Drive, features_of: FeaturesOf) -> None:
    """Odds of nothing cannot be joined."""
    settings = make_settings()
    block, _ = drive(60, 2)
    features = features_of(settings, block)
    labels = np.zeros((block.stamps_ns.size, 3), dtype=np.int8)
    model = train(settings, [LabelledFeatures(features, labels)])

    found = model.predict(features, "onset")

    assert set(found.p_collision.tolist()) == {0.0}


def test_alarms_begin_by_the_odds_of_each_pair(
    drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """Contact goes by onsets, before the map; profile paper raises none."""
    settings = make_settings()
    model, paper = replayed(settings), replayed(make_settings("paper"))
    features = features_of(settings, drive(60, 2)[0])

    found = {target: model.predict(features, target) for target in ("contact", "onset", "early")}

    begins = model.parts().alarm_odds
    for target, pair in (("onset", 1), ("early", 2)):
        p = found[target].p_collision
        np.testing.assert_allclose(found[target].alarm, p / (1 - p) / begins[pair])
    assert found["contact"].alarm.tolist() == found["onset"].alarm.tolist()
    assert (found["early"].alarm >= 1).any()
    assert np.isnan(paper.parts().alarm_odds).all()
    asked = features_of(paper.settings, drive(60, 2)[0])
    assert np.isnan(paper.predict(asked).alarm).all()
