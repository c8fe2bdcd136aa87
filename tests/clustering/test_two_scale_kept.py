"""What Algorithm 2 keeps: labels, what was explained, its size in a known world."""

import pickle
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpap_cli.clustering.two_scale import FineExemplars
from mpap_cli.distance import squared_distances
from tests.clustering.blobs import N_DIMS, around, centers
from tests.clustering.models import add, assert_same_state, filled, new_model, stream


@settings(max_examples=settings().max_examples // 20)
@given(
    st.integers(0, 10_000),
    st.sampled_from([0.0, 0.3, 0.6]),
    st.sampled_from([0.1, 0.18, 0.5]),
    st.sampled_from([1, 7, 30]),
)
def test_labels_are_never_lost(seed: int, share: float, eps: float, reservoir: int) -> None:
    """Their sums over clusters and reservoir grow by what is added and by nothing else."""
    rng = np.random.default_rng(seed)
    model = new_model(known_share=share, noise_share=0.6, eps=eps, reservoir=reservoir)
    ids = np.zeros(0, np.int64)
    given_ = np.zeros(2, np.int64)
    for turn in range(6):
        ids = np.append(ids, add(model, stream(60, 3 + turn, seed + turn), 60 * turn).ids)
        chosen, positive = rng.choice(ids, 50), rng.random(50) < 0.3
        model.add_labels(chosen, positive)
        given_ += [np.count_nonzero(~positive), np.count_nonzero(positive)]
        waiting = model.state()["reservoir.labels"]

        assert (model.labels.sum(axis=0) + waiting.sum(axis=0)).tolist() == given_.tolist()

        if turn == 4:
            model.rebuild()

            assert model.labels.sum(axis=0).tolist() == given_.tolist()


@settings(max_examples=settings().max_examples // 4)
@given(
    st.integers(0, 10_000),
    st.sampled_from([0.0, 0.3, 0.6]),
    st.sampled_from([0.1, 0.18, 0.3]),
    st.booleans(),
)
def test_what_was_explained_is_explained_after_a_rebuild(
    seed: int, share: float, eps: float, distortion: bool
) -> None:
    """Every fine exemplar, long-term or short-term, is within the fit radius of a new one."""
    model = new_model(known_share=share, noise_share=0.6, eps=eps, strap_distortion=distortion)
    for turn in range(5):
        add(model, stream(100, 3 + 2 * turn, seed + turn, spread=0.05 + 0.04 * turn))
        before = model.fine()

        model.rebuild()

        squared = squared_distances(before.features, model.exemplars)
        assert (squared.min(axis=1) < eps**2).all()


def test_old_exemplars_stay_where_they_are() -> None:
    """Of clusters farther apart than the fit radius none is moved or merged by a new place."""
    model = new_model()
    add(model, stream(400, 6, spread=0.03))
    before = model.exemplars

    add(model, around(np.repeat(centers(12)[6:], 40, axis=0), 0.1, np.random.default_rng(1)))

    assert model.n_rebuilds >= 3
    assert model.exemplars[: len(before)].tolist() == before.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_known_world_of_blobs_adds_nothing(seed: int) -> None:
    """Tails of the kinds stay outside all the time: from the second half on no cluster is added.

    Where any outliers make clusters anew, the same stream adds some.
    """
    model, plain = new_model(reservoir=200), new_model(reservoir=200, known_share=0.0)
    rng = np.random.default_rng(seed)
    kinds = centers(12)
    sizes, outside = [], []
    for turn in range(10):
        noise = 0.08 * rng.gamma(8.0, 1 / 8, (10_000, 1))
        steps = rng.normal(size=(10_000, N_DIMS)) * noise * np.sqrt(2.0 / N_DIMS)
        points = kinds[rng.integers(0, 12, 10_000)] + steps
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        added = [add(each, points.astype(np.float32), 10_000 * turn) for each in (model, plain)]
        outside.append(added[0].outlier.mean())
        sizes.append((model.n_clusters, plain.n_clusters))

    assert min(outside) > 0.002
    assert sizes[4][0] == sizes[-1][0]
    assert sizes[4][1] < sizes[-1][1]


def test_a_new_place_is_learnt_after_a_long_quiet_time() -> None:
    """It takes as many outliers as in a new model, and three in a hundred more."""
    model = new_model()
    add(model, stream(400, 6, spread=0.03))
    for turn in range(20):
        add(model, stream(1000, 6, seed=turn, spread=0.03))
    n_before, n_rebuilds = model.n_clusters, model.n_rebuilds

    new = around(np.repeat(centers(12)[6:], 7, axis=0), 0.05, np.random.default_rng(1))
    add(model, new[:41])
    n_after_41 = model.n_rebuilds
    add(model, new[41:])
    again = add(model, new)

    assert (n_after_41, model.n_rebuilds) == (n_rebuilds, n_rebuilds + 1)
    assert model.n_clusters >= n_before + 6
    assert not again.outlier.any()


def test_memory_does_not_grow_with_the_stream() -> None:
    """20,000 more observations of a known world cost 8 bytes for each outlier."""
    model = new_model()
    rng = np.random.default_rng(0)
    kinds = centers(5)
    blocks = [around(kinds[rng.integers(0, 5, 2000)], 0.135, rng) for _ in range(3)]
    for block in blocks:
        add(model, block)
    n_before = model.n_outliers_ever
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()

    for turn in range(10):
        add(model, blocks[turn % 3])

    after, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert after - before < 64 * (model.n_outliers_ever - n_before) + 100_000


def test_arguments_are_neither_changed_nor_kept() -> None:
    """Writing into what was given or returned changes nothing inside."""
    points, stamps, patches = stream(100, 4), np.arange(100), np.arange(100) % 9
    copies = points.copy(), stamps.copy(), patches.copy()
    model, untouched = new_model(), new_model()
    untouched.add_observations(*copies, log_index=1)

    added = model.add_observations(points, stamps, patches, log_index=1)

    assert points.tobytes() == copies[0].tobytes()
    assert stamps.tobytes() == copies[1].tobytes()
    assert patches.tobytes() == copies[2].tobytes()
    points[:] = stamps[:] = patches[:] = 0
    returned = [added.ids, added.distances, *model.state().values()]
    returned += [
        model.ids,
        model.exemplars,
        model.count,
        model.labels,
        model.current_ids(added.ids),
    ]
    for array in returned:
        array[...] = 1
    assert_same_state(model, untouched.state())


def test_a_pickled_copy_goes_on_like_the_original() -> None:
    """Workers hand models over as they are."""
    model, ids = filled()
    copy = pickle.loads(pickle.dumps(model))  # noqa: S301  # our own

    for each in (model, copy):
        add(each, stream(300, 10, seed=3))

    assert_same_state(copy, model.state())
    assert copy.current_ids(ids).tolist() == model.current_ids(ids).tolist()


def test_the_same_stream_gives_the_same_bytes() -> None:
    """There is no chance in it but the seed."""
    one, other = filled()[0], filled()[0]

    assert_same_state(one, other.state())
    assert fine_bytes(one.fine()) == fine_bytes(other.fine())


def fine_bytes(fine: FineExemplars) -> list[bytes]:
    """All arrays of a record."""
    return [getattr(fine, name).tobytes() for name in FineExemplars.__slots__]
