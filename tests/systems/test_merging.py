"""Models of several logs become one, whatever their order."""

from itertools import permutations

import numpy as np
import pytest

from mpap_cli.distance import embed
from mpap_cli.errors import ModelError, UsageError
from mpap_cli.observations import NS_PER_S, FeatureBlock, Press
from mpap_cli.params import make_settings
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart
from mpap_cli.systems.merging import merge_models

SETTINGS = {"theta": "0.06", "reference": "exemplar"}


def learnt(name: str, seed: int, values: dict[str, str] | None = None) -> CollisionModel:
    """Return the model of a log of its own, a day after the one before."""
    model = CollisionModel(make_settings(values=SETTINGS if values is None else values))
    n_bins = model.meta_points.n_dims - 1
    random = np.random.default_rng(seed)
    places = np.random.default_rng(0).uniform(0.1, 5, size=(50, n_bins))
    rows = places[random.integers(50, size=150)] * random.uniform(0.95, 1.05, (150, n_bins))
    start_ns = seed * 86_400 * NS_PER_S
    stamps_ns = start_ns + np.arange(150, dtype=np.int64) * NS_PER_S // 2
    features = embed(rows.astype(np.float32)).astype(np.float32)
    presses = (Press(start_ns + 20 * NS_PER_S, start_ns + 24 * NS_PER_S),)
    model.begin_log(LogStart(name=name, start_ns=start_ns, presses=presses, bump_source="file"))
    model.learn(FeatureBlock(stamps_ns, features, np.arange(150), np.ones(150, np.float32)))
    model.end_log(int(stamps_ns[-1]))
    return model


def test_merging_gives_the_same_bytes_in_any_order() -> None:
    """Arrays and header are equal under every permutation."""
    models = [learnt(name, seed) for seed, name in enumerate("abc", start=1)]

    states = [merge_models(order).state() for order in permutations(models)]

    first = {name: array.tobytes() for name, array in states[0].arrays.items()}
    for state in states[1:]:
        assert state.header == states[0].header
        assert {name: array.tobytes() for name, array in state.arrays.items()} == first


def test_nothing_is_lost_by_merging() -> None:
    """Counts, observations, visits and presses of the leaves add up."""
    models = [learnt("a", 1), learnt("b", 2)]

    merged = merge_models(models)

    assert [log.name for log in merged.logs] == ["a", "b"]
    labels = sum(model.meta_points.counts.sum(axis=0) for model in models)
    assert merged.meta_points.counts.sum(axis=0).tolist() == np.asarray(labels).tolist()
    for column in ("visits", "presses"):
        of_leaves = sum(getattr(row, column) for model in models for row in model.clusters())
        assert sum(getattr(row, column) for row in merged.clusters()) == of_leaves
    assert {row.exemplar_log for row in merged.clusters()} == {"a", "b"}
    assert all(0 <= row.exemplar_time_s < 75 for row in merged.clusters())
    assert all(0 <= row.first_seen_s < 75 for row in merged.clusters())


def test_a_single_model_can_be_merged() -> None:
    """It keeps its counts and gets new ids."""
    model = learnt("a", 1)

    merged = merge_models([model])

    assert merged.meta_points.counts.sum() == model.meta_points.counts.sum()
    assert merged.logs == model.logs


def test_merging_leaves_the_leaves_alone() -> None:
    """Nothing of them is written to or kept."""
    models = [learnt("a", 1), learnt("b", 2)]
    before = [{k: v.tobytes() for k, v in model.state().arrays.items()} for model in models]

    merge_models(models).meta_points.add_counts(np.array([0, 1, 2]), 0, np.ones(3, np.bool_))

    after = [{k: v.tobytes() for k, v in model.state().arrays.items()} for model in models]
    assert after == before


def test_models_of_different_settings_are_refused() -> None:
    """The setting that differs is named, with both values and both logs."""
    models = [learnt("a.bag", 1), learnt("b.bag", 2, {**SETTINGS, "early-s": "2.0"})]

    message = r"setting early-s is 1.0 in the model of a.bag and 2.0 in that of b.bag; learn both"
    with pytest.raises(UsageError, match=message):
        merge_models(models)


def test_no_model_cannot_be_merged() -> None:
    """There is nothing to say what it would know."""
    with pytest.raises(ModelError, match="found no model"):
        merge_models([])


def test_models_without_cluster_points_can_be_merged() -> None:
    """Noise-points seen in two logs become cluster-points."""
    settings = make_settings(values={**SETTINGS, "min-points": "2"})
    models = []
    for seed in (1, 2):
        model = CollisionModel(settings)
        model.begin_log(LogStart(name=str(seed), start_ns=seed))
        point = embed(np.ones((1, model.meta_points.n_dims - 1), np.float32)).astype(np.float32)
        model.learn(FeatureBlock(np.array([seed]), point, np.arange(1), np.ones(1, np.float32)))
        model.end_log(seed)
        models.append(model)

    merged = merge_models(models)

    assert [model.clustering.exemplars.size for model in models] == [0, 0]
    assert merged.clustering.exemplars.size == 1
    assert merged.clusters()[0].observations == 2
    assert merged.clusters()[0].visits == 0
