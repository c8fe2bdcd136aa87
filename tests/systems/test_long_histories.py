"""Models that learn for a hundred hours: what they keep, what they forget, what they count."""

from collections.abc import Sequence

import numpy as np
import pytest

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.features.images.patch_features import PatchEmbedder
from mpap_cli.features.scans.scan_features import ScanEmbedder
from mpap_cli.observations import (
    NS_PER_S,
    Bump,
    Clustering,
    FeatureBlock,
    Float32Array,
    PatchBlock,
)
from mpap_cli.params import (
    AffinityParams,
    Settings,
    make_settings,
)
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart
from mpap_cli.systems.model_parts import ModelState

HOUR_NS = 3600 * NS_PER_S
HOURS = 100
START_NS = 1_577_836_800 * NS_PER_S
MANY = 3_000_000_000  # more than 32 bits hold


def _directions(n: int, n_dims: int, seed: int) -> Float32Array:
    """Return points of length 1 that lie far apart."""
    points = np.abs(np.random.default_rng(seed).standard_normal((n, n_dims))) ** 3
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points.astype(np.float32)


def _scans(settings: Settings, n: int, seed: int) -> Float32Array:
    return _directions(n, ScanEmbedder(settings.scan).n_dims, seed)


def _seen(features: Float32Array, start_ns: int, step_ns: int = NS_PER_S) -> FeatureBlock:
    """Return features as observations that follow one another."""
    n = len(features)
    stamps_ns = start_ns + np.arange(n, dtype=np.int64) * step_ns
    return FeatureBlock(stamps_ns, features, np.arange(n), np.ones(n, np.float32))


def _patches(features: Float32Array, start_ns: int, n_patches: int) -> PatchBlock:
    """Return features as the patches of images that follow one another."""
    images = features.reshape(-1, n_patches, features.shape[1])
    stamps_ns = start_ns + np.arange(len(images), dtype=np.int64) * NS_PER_S
    return PatchBlock(stamps_ns, images, np.arange(len(images)))


def _begin(model: CollisionModel | AppearanceModel, hour: int) -> int:
    """Begin the log of an hour; return its first stamp."""
    start_ns = START_NS + hour * HOUR_NS
    start = LogStart(name=f"hour-{hour}", start_ns=start_ns, bump_kind="level")
    model.begin_log(start)
    return start_ns


def _learn_hour(model: CollisionModel, hour: int, features: Float32Array) -> None:
    start_ns = _begin(model, hour)
    block = _seen(features, start_ns)
    model.learn(block)
    model.settle((Bump(start_ns, "", pressed=False),), int(block.stamps_ns[-1]))
    model.end_log(start_ns + HOUR_NS - 1)


def test_a_place_of_the_first_hour_is_known_after_99_hours_elsewhere() -> None:
    """Cluster-points stay, whatever noise-points have come and gone since."""
    settings = make_settings(values={"max-noise": "30", "noise-ttl": "7200"})
    place = _scans(settings, 10, seed=1)
    model = CollisionModel(settings)
    _learn_hour(model, 0, np.repeat(place, 3, axis=0))
    for hour in range(1, HOURS):
        _learn_hour(model, hour, _scans(settings, 40, seed=1000 + hour))

    found = model.predict(_seen(place, START_NS + HOURS * HOUR_NS))

    assert not found.novel.any()
    assert found.distance.max() < 1e-3
    assert model.meta_points.n_dropped > 3000
    assert model.meta_points.is_cluster_point[:10].all()


def test_noise_points_of_a_hundred_hours_are_the_last_ones() -> None:
    """At most 50 of single observations stay, the last seen; every other one is counted."""
    settings = make_settings(values={"max-noise": "50"})
    model = CollisionModel(settings)
    features = _scans(settings, 20 * HOURS, seed=2)
    for hour in range(HOURS):
        _learn_hour(model, hour, features[20 * hour : 20 * hour + 20])

    points = model.meta_points

    noise = ~points.is_cluster_point
    assert noise.sum() == 50
    assert points.n_dropped == points.ids.max() + 1 - points.n_points
    assert (points.count[noise] == 1).all()
    assert (points.last_ns[noise] >= START_NS + (HOURS - 4) * HOUR_NS).all()


def test_patches_of_the_first_hour_are_known_after_99_hours_elsewhere() -> None:
    """Rebuild after rebuild, what was explained stays explained."""
    settings = make_settings(values={"grid": "2x2", "reservoir": "20"})
    model = AppearanceModel(settings)
    n_dims = PatchEmbedder(settings.image).n_dims
    place = np.tile(_directions(4, n_dims, seed=3), (20, 1))
    for hour in range(HOURS):
        start_ns = _begin(model, hour)
        seen = place if hour == 0 else _directions(8, n_dims, seed=1000 + hour)
        model.learn(_patches(seen, start_ns, 4))
        model.end_log(start_ns + HOUR_NS - 1)

    unknown = model.known().unknown(_patches(place, 0, 4).features)

    assert model.two_scale.n_rebuilds > 20
    assert not unknown.any()


def test_labels_and_times_are_exact_after_a_hundred_hours_of_one_log() -> None:
    """A press in the last second of hour 100 labels the scans in it; times are to the second."""
    settings = make_settings(values={"learn-target": "contact"})
    model, place = CollisionModel(settings), _scans(settings, 1, seed=4)
    model.begin_log(LogStart(name="long", start_ns=START_NS, bump_kind="level"))
    model.learn(_seen(np.repeat(place, 10, axis=0), START_NS))
    last_ns = START_NS + HOURS * HOUR_NS
    model.settle((Bump(START_NS, "", pressed=False),), last_ns - HOUR_NS)
    model.learn(_seen(np.repeat(place, 10, axis=0), last_ns - 9 * NS_PER_S))
    presses = (Bump(last_ns - NS_PER_S, "", True), Bump(last_ns + 1, "", False))

    model.settle(presses, last_ns + 1)
    model.end_log(last_ns + 1)
    (row,) = model.clusters()

    assert (row.collisions, row.non_collisions, row.presses) == (2, 18, 1)
    assert (row.first_seen_s, row.last_seen_s) == (0.0, 360_000.0)


def _counted(state: ModelState, prefix: str, names: Sequence[str], factor: int) -> ModelState:
    """Return the state of a model that has seen everything so many times."""
    arrays = {
        name: array * factor if name in {prefix + one for one in names} else array
        for name, array in state.arrays.items()
    }
    return ModelState(state.header, arrays)


def test_meta_points_count_on_after_three_billion_observations() -> None:
    """Neither counts nor means lose an observation to the width of a number."""
    settings = make_settings(values={"learn-target": "contact", "theta": "0.3"})
    place = _scans(settings, 2, seed=5)
    first = CollisionModel(settings)
    _learn_hour(first, 0, np.repeat(place[:1], 20, axis=0))
    names = ("point_count", "label_counts", "sums")
    state = _counted(first.state(), "meta_points.", names, MANY // 20)
    model = CollisionModel.from_state(state)
    before = model.meta_points.sums[0]
    near = 0.9 * place[:1] + 0.1 * place[1:]
    near /= np.linalg.norm(near)

    _learn_hour(model, 1, np.repeat(near, 8, axis=0))
    (row,) = model.clusters()

    points = model.meta_points
    assert points.count.tolist() == [MANY + 8]
    assert points.counts[0, 0].tolist() == [MANY + 8, 0]
    np.testing.assert_allclose(points.sums[0] - before, 8.0 * near[0], atol=1e-5)
    assert (row.observations, row.non_collisions) == (MANY + 8, MANY + 8)


def test_exemplars_count_on_after_three_billion_patches() -> None:
    """Neither counts, labels nor weights lose a patch to the width of a number."""
    settings = make_settings()
    first = AppearanceModel(settings)
    n_patches = first.n_patches
    kinds = _directions(1, PatchEmbedder(settings.image).n_dims, seed=6)
    block = _patches(np.repeat(kinds, 4 * n_patches, axis=0), START_NS, n_patches)
    _begin(first, 0)
    first.learn(block)
    first.end_log(START_NS + HOUR_NS)
    factor = MANY // (4 * n_patches)
    state = _counted(first.state(), "strap.clusters.", ("counts", "weight"), factor)
    state.arrays["strap.clusters.labels"][:] = MANY
    model = AppearanceModel.from_state(state)

    _begin(model, 1)
    learnt = model.learn(block)
    model.two_scale.add_labels(learnt.ids.ravel(), np.ones(learnt.ids.size, np.bool_))

    assert model.two_scale.count.tolist() == [factor * 4 * n_patches + 4 * n_patches]
    assert model.two_scale.weight.tolist() == [factor * 4 * n_patches + 4 * n_patches]
    assert model.two_scale.labels.tolist() == [[MANY, MANY + 4 * n_patches]]


def test_a_hundred_logs_are_clustered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Affinity propagation runs when its result is asked for, and gives the same bytes."""
    settings = make_settings("paper")
    every, last = CollisionModel(settings), CollisionModel(settings)
    runs = list[int]()
    cluster = MetaPoints.cluster

    def counted(points: MetaPoints, params: AffinityParams) -> Clustering:
        runs.append(points.n_points)
        return cluster(points, params)

    monkeypatch.setattr(MetaPoints, "cluster", counted)
    for hour in range(HOURS):
        features = np.repeat(_scans(settings, 3, seed=hour), 6, axis=0)
        _learn_hour(last, hour, features)
        _learn_hour(every, hour, features)
        assert every.clustering.labels.size
    n_before = len(runs)
    states = every.state(), last.state()

    assert (n_before, len(runs)) == (HOURS, HOURS + 1)
    assert states[0].header == states[1].header
    assert all(
        array.tobytes() == states[1].arrays[name].tobytes()
        for name, array in states[0].arrays.items()
    )
