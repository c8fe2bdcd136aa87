"""A collision model learns from batches, whichever way they come."""

from collections.abc import Callable

import numpy as np
import pytest

from mpap_cli.observations import (
    Batch,
    Bump,
    FeatureBlock,
    ObservedLog,
    Press,
    ScanBlock,
)
from mpap_cli.params import Settings, make_settings
from mpap_cli.properties.labels import label_scans
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart
from mpap_cli.systems.training import LabelledFeatures, train

Drive = Callable[[int, int], tuple[ScanBlock, tuple[Press, ...]]]
PartOf = Callable[[ScanBlock, int, int], ScanBlock]
Batches = Callable[[ScanBlock, tuple[Press, ...], int], list[Batch]]
Replayed = Callable[..., CollisionModel]
FeaturesOf = Callable[[Settings, ScanBlock], FeatureBlock]


@pytest.mark.parametrize("profile", ["robust", "paper"])
def test_a_replay_counts_what_training_counts(
    profile: str, drive: Drive, replayed: Replayed, features_of: FeaturesOf
) -> None:
    """Queue, tracker and batches change nothing: same meta-points, counts, probabilities."""
    settings = make_settings(profile)
    block, presses = drive(240, 1)
    features = features_of(settings, block)
    labels = label_scans(block.stamps_ns, presses, settings.properties)

    trained = train(settings, [LabelledFeatures(features, labels)])
    model = replayed(settings)

    assert model.meta_points.counts.tolist() == trained.meta_points.counts.tolist()
    assert model.clustering.labels.tolist() == trained.clustering.labels.tolist()
    for target in ("contact", "onset", "early"):
        one, other = model.predict(features, target), trained.predict(features, target)
        assert one.p_collision.tobytes() == other.p_collision.tobytes()
        assert one.p_cluster.tobytes() == other.p_cluster.tobytes()


def test_the_size_of_batches_does_not_matter(replayed: Replayed) -> None:
    """The state of the model has the same bytes."""
    one = replayed(make_settings(), size=7).state()
    other = replayed(make_settings(), size=1200).state()

    assert one.header == other.header
    assert {name: array.tobytes() for name, array in one.arrays.items()} == {
        name: array.tobytes() for name, array in other.arrays.items()
    }


def test_a_log_without_bumper_clusters_only(drive: Drive, features_of: FeaturesOf) -> None:
    """No labels, no probabilities, no presses; observations are seen all the same."""
    block, _ = drive(60, 3)
    model = CollisionModel(make_settings())
    model.begin_log(LogStart(name="a", start_ns=0))
    model.observe(Batch(int(block.stamps_ns[-1]), (block,), ()))

    presses = model.end_log(int(block.stamps_ns[-1]))

    assert presses is None
    assert model.logs[0].n_presses is None
    assert model.meta_points.counts.sum() == 0
    rows = model.clusters()
    assert {row.p_collision for row in rows} == {None}
    assert {row.p_low for row in rows} == {None}
    assert all(row.visits > 0 for row in rows)
    assert np.isnan(model.predict(features_of(model.settings, block)).p_collision).all()


def test_a_log_without_scans_is_learnt() -> None:
    """There is nothing to cluster and nothing to say."""
    model = CollisionModel(make_settings())
    model.begin_log(LogStart(name="a", start_ns=5, bump_kind="level"))
    model.observe(Batch(50, (), (Bump(10, "", pressed=True),)))

    presses = model.end_log(60)

    assert presses == (Press(10, 61, held_from_start=True, released=False),)
    assert model.clusters() == []
    assert model.self_check().noise_share == 0


def test_online_clusters_before_the_end_of_the_log(
    drive: Drive, batches: Batches, replayed: Replayed
) -> None:
    """So that a model can predict, then learn; in the end it is the same model."""
    block, presses = drive(240, 1)
    seen = {}
    for online in (False, True):
        model = CollisionModel(make_settings(), online=online)
        model.begin_log(LogStart(name="a", start_ns=0, bump_kind="level"))
        for batch in batches(block, presses, 50)[:20]:
            model.observe(batch)
        seen[online] = model.clustering.exemplars.size
    whole = [replayed(make_settings(), online=online) for online in (False, True)]

    assert seen[False] == 0
    assert seen[True] > 0
    assert whole[0].clustering.labels.tolist() == whole[1].clustering.labels.tolist()


def test_online_clusters_at_most_once_a_second(
    monkeypatch: pytest.MonkeyPatch, drive: Drive, part_of: PartOf
) -> None:
    """And only if enough cluster-points have come."""
    model = CollisionModel(make_settings(), online=True)
    model.begin_log(LogStart(name="a", start_ns=0, bump_kind="level"))
    block, _ = drive(120, 1)
    times = []
    monkeypatch.setattr(model, "recluster", lambda: times.append(model.meta_points.n_points))

    for row in range(block.stamps_ns.size):
        part = part_of(block, row, row + 1)
        model.observe(Batch(int(part.stamps_ns[0]), (part,), ()))

    assert 1 < len(times) <= 120


def test_a_log_is_begun_before_it_is_observed(drive: Drive) -> None:
    """Else nothing is known of it."""
    model = CollisionModel(make_settings())

    with pytest.raises(RuntimeError, match="begin_log comes first"):
        model.observe(Batch(0, (drive(12, 1)[0],), ()))


def test_presses_that_are_known_label_like_bumps(
    drive: Drive, part_of: PartOf, replayed: Replayed
) -> None:
    """ObservedLog carries presses; the model is the one that a replay learns."""
    block, presses = drive(240, 1)
    log = ObservedLog(
        name="a.bag",
        path="a.bag",
        start_ns=0,
        end_ns=int(block.stamps_ns[-1]),
        forward_rad=0.0,
        range_max=None,
        presses=presses,
        bump_source="bumper",
        blocks=lambda: iter([part_of(block, 0, 500), part_of(block, 500, 2000)]),
    )

    learnt = CollisionModel(make_settings())
    learnt.begin_log(LogStart.of(log))
    for part in log.blocks():
        learnt.observe(Batch(int(part.stamps_ns[-1]), (part,), ()))
    learnt.end_log(log.end_ns)

    wanted = replayed(make_settings())
    assert learnt.clusters() == wanted.clusters()
    assert learnt.logs == wanted.logs


def test_training_needs_something_to_learn_from() -> None:
    """The width of the features is unknown without any."""
    with pytest.raises(ValueError, match="logs: found none"):
        train(make_settings(), [])
