"""Affinity propagation: messages, every degenerate case, and scikit-learn as the oracle."""

import itertools
import tracemalloc
import warnings

import numpy as np
import pytest
from sklearn.cluster import affinity_propagation as scikit_learn
from sklearn.exceptions import ConvergenceWarning

from mpap_cli.clustering import _kernels
from mpap_cli.clustering.affinity_propagation import (
    affinity_propagation,
    jittered,
    weighted_similarities,
)
from mpap_cli.observations import Clustering, Float64Array
from mpap_cli.params import AffinityParams

PARAMS = AffinityParams()


def squared(points: Float64Array) -> Float64Array:
    """Negative squared distances of points."""
    difference = points[:, None] - points[None]
    s: Float64Array = -(difference**2).sum(axis=-1)
    return s


def net(s: Float64Array, p: Float64Array, exemplars: tuple[int, ...]) -> float:
    """Equation 2 for a set of exemplars, every item at its best one."""
    chosen = np.array(exemplars)
    others = np.delete(np.arange(len(s)), chosen)
    return float(s[np.ix_(others, chosen)].max(axis=1, initial=-np.inf).sum() + p[chosen].sum())


def best_exemplars(s: Float64Array, p: Float64Array) -> tuple[int, ...]:
    """Try all sets of exemplars; the smallest, then lowest, of equals is taken."""
    sizes = range(1, len(s) + 1)
    sets = itertools.chain(*(itertools.combinations(range(len(s)), size) for size in sizes))
    return max(sets, key=lambda exemplars: net(s, p, exemplars))


def assert_valid(result: Clustering, n: int) -> None:
    """Exemplars ascend and represent themselves; every item has a label."""
    assert result.labels.shape == (n,)
    assert (np.diff(result.exemplars) > 0).all()
    assert (result.labels[result.exemplars] == np.arange(len(result.exemplars))).all()


def test_no_item_no_cluster() -> None:
    """N = 0."""
    result = affinity_propagation(np.zeros((0, 0)), -1.0, PARAMS)

    assert (result.exemplars.size, result.labels.size, result.converged) == (0, 0, True)


def test_one_item_is_one_cluster() -> None:
    """N = 1, whatever its preference."""
    result = affinity_propagation(np.array([[np.nan]]), -7.0, PARAMS)

    assert (result.exemplars.tolist(), result.labels.tolist()) == ([0], [0])
    assert result.net_similarity == -7.0


@pytest.mark.parametrize(
    ("to_first", "to_second", "p", "exemplars"),
    [
        (-1.0, -2.0, [-5.0, -5.0], [0]),  # the second goes to the first
        (-2.0, -1.0, [-5.0, -5.0], [1]),
        (-3.0, -3.0, [-1.0, -1.0], [0, 1]),  # both are cheaper than one
        (-1.0, -1.0, [-1.0, -1.0], [0]),  # all equal: fewer clusters, lower index
        (-2.0, -2.0, [-3.0, -3.0], [0]),  # a tie of the single ones: lower index
        (-3.0, -2.0, [-5.0, -2.0], [1]),  # unequal preferences
        (-np.inf, -np.inf, [-9.0, -9.0], [0, 1]),  # they may not meet
    ],
)
def test_two_items_have_a_closed_form(
    to_first: float, to_second: float, p: list[float], exemplars: list[int]
) -> None:
    """N = 2: the best of three configurations."""
    s = np.array([[0.0, to_second], [to_first, 0.0]])

    result = affinity_propagation(s, np.array(p), PARAMS)

    assert result.exemplars.tolist() == exemplars
    assert result.net_similarity == net(s, np.array(p), tuple(exemplars))


@pytest.mark.parametrize(("preference", "n_clusters"), [(-0.5, 4), (-1.0, 1), (-2.0, 1)])
def test_all_equal_similarities(preference: float, n_clusters: int) -> None:
    """P > s: each item on its own; else one cluster around the first, without a warning."""
    result = affinity_propagation(np.full((4, 4), -1.0), preference, PARAMS)

    assert result.exemplars.tolist() == list(range(n_clusters))
    assert result.converged


def test_duplicates_share_a_cluster() -> None:
    """Exact copies never part."""
    points = np.repeat(np.array([[0.0, 0.0], [9.0, 0.0], [0.0, 9.0]]), 5, axis=0)

    results = [
        affinity_propagation(squared(points), -10.0, AffinityParams(seed=seed))
        for seed in range(20)
    ]

    assert all(result.converged for result in results)
    assert all(result.labels.tolist() == [0] * 5 + [1] * 5 + [2] * 5 for result in results)
    assert all(result.exemplars.tolist() == [0, 5, 10] for result in results)


def test_duplicates_part_where_clusters_cost_nothing() -> None:
    """With p above their similarity each copy is its own exemplar."""
    points = np.repeat(np.array([[0.0, 0.0], [9.0, 0.0], [0.0, 9.0]]), 2, axis=0)

    result = affinity_propagation(squared(points), 0.5, PARAMS)

    assert result.exemplars.tolist() == list(range(6))


def test_items_that_only_look_like_copies_from_one_side_are_none() -> None:
    """With unequal columns or preferences both may become exemplars."""
    s = squared(np.array([[0.0], [0.0], [5.0], [5.1], [9.0]]))
    s[4, 1] = -1.0
    p = np.full(5, -30.0)

    better_column = affinity_propagation(s, p, PARAMS)
    p[1] = -1.0
    s[4, 1] = s[4, 0]
    better_preference = affinity_propagation(s, p, PARAMS)

    assert 1 in better_column.exemplars
    assert 1 in better_preference.exemplars


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("preference", [-3.0, -1.5, -0.5])
def test_unit_square_converges_thanks_to_jitter(seed: int, preference: float) -> None:
    """Four equal corners have many equally good solutions; one of them is found."""
    square = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])

    result = affinity_propagation(squared(square), preference, AffinityParams(seed=seed))

    assert result.converged
    assert_valid(result, 4)


def test_the_jitter_hangs_on_the_seed_alone() -> None:
    """Same seed, same copy; the input and forbidden pairs stay."""
    s = squared(np.arange(6.0)[:, None])
    s[0, 5] = -np.inf
    before = s.copy()

    one, two, other = jittered(s, 0), jittered(s, 0), jittered(s, 1)

    assert np.array_equal(one, two)
    assert not np.array_equal(one, other)
    assert one[0, 5] == -np.inf
    assert np.allclose(np.delete(one, 5, 1), np.delete(s, 5, 1), rtol=1e-14, atol=1e-300)
    assert np.array_equal(s, before)


def test_a_run_without_end_is_repeated_with_more_damping() -> None:
    """With too few iterations no run converges; the best exemplars seen are taken."""
    s = squared(np.random.default_rng(2).normal(size=(40, 2)))
    params = AffinityParams(damping=0.5, max_iter=30, convergence_iter=30)

    result = affinity_propagation(s, -3.0, params)

    assert not result.converged
    assert result.damping == 0.98
    assert result.n_iter == 5 * 30
    assert_valid(result, 40)


def test_a_repeated_run_can_converge() -> None:
    """Low damping oscillates where more of it does not; the record tells which it was."""
    s = squared(np.random.default_rng(0).normal(size=(120, 2)))
    params = AffinityParams(damping=0.5, max_iter=200, convergence_iter=20)

    result = affinity_propagation(s, 20 * float(s.min()), params)

    assert result.converged
    assert result.damping > 0.5
    assert result.n_iter > 200


def test_without_any_exemplar_the_item_with_the_largest_column_sum_is_taken() -> None:
    """One iteration at a very low preference finds nobody."""
    s = squared(np.array([[0.0], [1.0], [2.0], [2.9]]))
    params = AffinityParams(max_iter=1)

    result = affinity_propagation(s, -1e6, params)

    assert not result.converged
    assert result.exemplars.tolist() == [1]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_similarities_must_be_numbers(bad: float) -> None:
    """NaN and +inf are errors, except on the diagonal, which is ignored."""
    s = squared(np.arange(4.0)[:, None])
    np.fill_diagonal(s, bad)
    result = affinity_propagation(s, -1.0, PARAMS)
    s[1, 2] = bad

    with pytest.raises(ValueError, match="1 of 16 are NaN or"):
        affinity_propagation(s, -1.0, PARAMS)
    assert_valid(result, 4)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, np.array([1.0, 2.0])])
def test_preferences_must_be_numbers(bad: float | Float64Array) -> None:
    """One finite number, or one for each item."""
    with pytest.raises(ValueError, match="preference: expected one or 4 finite numbers"):
        affinity_propagation(np.zeros((4, 4)), bad, PARAMS)


def test_similarities_must_be_square() -> None:
    """Every pair has two."""
    with pytest.raises(ValueError, match="expected a square matrix"):
        affinity_propagation(np.zeros((4, 3)), -1.0, PARAMS)


def test_forbidden_pairs_stay_apart() -> None:
    """No item goes to an exemplar that it may not go to."""
    rng = np.random.default_rng(4)
    s = squared(rng.normal(size=(30, 2)))
    forbidden = rng.random((30, 30)) < 0.4
    s[forbidden] = -np.inf

    result = affinity_propagation(s, -2.0, PARAMS)

    assert np.isfinite(result.net_similarity)
    assert_valid(result, 30)


def test_an_item_that_may_go_nowhere_is_its_own_exemplar() -> None:
    """Even where the run ended before it could tell."""
    s = squared(np.array([[0.0], [0.1], [0.2], [0.3]]))
    s[2] = -np.inf

    for max_iter in (1, 1000):
        result = affinity_propagation(s, -0.5, AffinityParams(max_iter=max_iter))

        assert 2 in result.exemplars
        assert np.isfinite(result.net_similarity)


def test_groups_that_may_not_meet_get_an_exemplar_each() -> None:
    """A run that ended too early is completed: lowest items first."""
    s = np.full((5, 5), -np.inf)
    s[:2, :2] = s[2:, 2:] = -1.0

    result = affinity_propagation(s, -100.0, AffinityParams(max_iter=1))

    assert result.exemplars.tolist() == [0, 2]
    assert result.labels.tolist() == [0, 0, 1, 1, 1]
    assert result.net_similarity == -203.0


@pytest.mark.parametrize("seed", range(12))
def test_small_problems_reach_the_best_net_similarity(seed: int) -> None:
    """On seven random points nothing much better exists than what is found."""
    rng = np.random.default_rng(seed)
    s = squared(rng.normal(size=(7, 2)))
    p = np.full(7, float(np.median(s)))

    result = affinity_propagation(s, p, PARAMS)

    best = net(s, p, best_exemplars(s, p))
    assert best * 1.1 <= result.net_similarity <= best + 1e-12
    assert result.net_similarity == pytest.approx(net(s, p, tuple(result.exemplars)))


def test_refinement_centers_the_exemplars() -> None:
    """Each exemplar is the member with the largest sum within its cluster."""
    s = squared(np.random.default_rng(5).normal(size=(60, 2)))

    result = affinity_propagation(s, -4.0, PARAMS)

    assert result.converged
    assert 1 < len(result.exemplars) < 60
    for cluster, exemplar in enumerate(result.exemplars):
        members = np.flatnonzero(result.labels == cluster)
        sums = s[np.ix_(members, members)].sum(axis=0)
        assert exemplar in members
        assert sums[members == exemplar][0] >= sums.max() - 1e-9


def test_individual_preferences_choose_the_exemplars() -> None:
    """An item with a high preference becomes one."""
    s = squared(np.random.default_rng(6).normal(size=(20, 2)))
    p = np.full(20, -30.0)
    p[7] = 0.0

    result = affinity_propagation(s, p, PARAMS)

    assert 7 in result.exemplars
    assert result.preference == pytest.approx(p.mean())


def test_the_input_stays_and_the_result_repeats() -> None:
    """Same input, same seed: the same bytes; no argument is written to."""
    s = squared(np.random.default_rng(7).normal(size=(50, 3)))
    before = s.copy()

    one, two = (affinity_propagation(s, -3.0, PARAMS) for _ in range(2))

    assert np.array_equal(s, before)
    assert one.labels.tobytes() == two.labels.tobytes()
    assert one.net_similarity == two.net_similarity


def test_memory_is_three_matrices() -> None:
    """Beside its input: the similarities with jitter, and two kinds of message."""
    n = 300
    s = squared(np.random.default_rng(8).normal(size=(n, 2)))
    affinity_propagation(s[:40, :40], -3.0, PARAMS)

    tracemalloc.start()
    affinity_propagation(s, -3.0, PARAMS)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()

    assert peak < 3.2 * n * n * 8


def plain_messages(s: Float64Array, damping: float, n_iter: int) -> tuple[Float64Array, ...]:
    """Equations 4 to 6 as they are printed; the diagonals of a and r after each iteration."""
    n = len(s)
    a, r = np.zeros((n, n)), np.zeros((n, n))
    for _ in range(n_iter):
        new_r, new_a = np.empty((n, n)), np.empty((n, n))
        for i, k in itertools.product(range(n), repeat=2):
            others = np.delete(a[i] + s[i], k)
            new_r[i, k] = s[i, k] - others.max()
        r = damping * r + (1 - damping) * new_r
        for i, k in itertools.product(range(n), repeat=2):
            supporters = np.maximum(np.delete(r[:, k], [i, k]), 0).sum()
            new_a[i, k] = supporters if i == k else min(0.0, r[k, k] + supporters)
        a = damping * a + (1 - damping) * new_a
    return a, r


@pytest.mark.parametrize("compiled", [True, False])
def test_kernel_equals_the_printed_equations(compiled: bool) -> None:
    """Availabilities of one sweep are those that the next one finishes."""
    n, n_iter = _kernels._LANES + 9, 3
    s = squared(np.random.default_rng(9).normal(size=(n, 2)))
    np.fill_diagonal(s, -2.0)
    messages = _kernels.start_messages(np.empty((n, n)), np.empty((n, n)))
    sweep = _kernels._sweep if compiled else _kernels._sweep.py_func

    for _ in range(n_iter):
        sweep(s, messages, 0.7, np.empty((2, _kernels._LANES)))

    a, r = plain_messages(s, 0.7, n_iter)
    assert np.allclose(messages.a_diagonal, np.diagonal(a))
    assert np.allclose(messages.r, r)


def test_net_similarity_kernel_is_equation_2() -> None:
    """Compiled or not, it equals the plain sum."""
    s = squared(np.random.default_rng(10).normal(size=(9, 2)))
    np.fill_diagonal(s, -1.0)
    exemplars = np.array([2, 5])

    found = [f(s, exemplars) for f in (_kernels.net_similarity, _kernels._net_similarity.py_func)]

    assert found == [pytest.approx(net(s, np.full(9, -1.0), (2, 5)))] * 2


@pytest.mark.parametrize("seed", range(20))
def test_weights_equal_duplicates(seed: int) -> None:
    """The net similarity of weighted items is that of all the points they stand for."""
    rng = np.random.default_rng(seed)
    s = squared(rng.normal(size=(6, 2)))
    counts = rng.integers(1, 5, 6)
    eps, p = 1e-3, -2.0
    owner = np.repeat(np.arange(6), counts)
    spread = s[np.ix_(owner, owner)]
    spread[owner[:, None] == owner] = -eps  # near-duplicates of one item
    first = np.searchsorted(owner, np.arange(6))
    exemplars = tuple(int(k) for k in rng.choice(6, 3, replace=False))

    weighted, diagonal = weighted_similarities(s, counts, p, eps * (counts - 1).astype(np.float64))

    of_points = net(spread, np.full(len(owner), p), tuple(int(first[k]) for k in exemplars))
    assert net(weighted, diagonal, exemplars) == pytest.approx(of_points)
    assert np.array_equal(np.diagonal(weighted), diagonal)


def test_weights_give_as_many_clusters_as_all_points() -> None:
    """The preference of one point means the same for items that stand for many."""
    n_clusters = np.zeros(3, np.int64)
    for seed in range(10):
        rng = np.random.default_rng(seed)
        s = squared(rng.normal(size=(25, 2)))
        counts = rng.integers(1, 6, 25)
        owner = np.repeat(np.arange(25), counts)

        weighted = affinity_propagation(*weighted_similarities(s, counts, -4.0), PARAMS)
        points = affinity_propagation(s[np.ix_(owner, owner)], -4.0, PARAMS)
        unweighted = affinity_propagation(s, -4.0, PARAMS)

        n_clusters += [len(each.exemplars) for each in (weighted, points, unweighted)]

    assert n_clusters[0] == pytest.approx(n_clusters[1], rel=0.1)
    assert n_clusters[2] < 0.75 * n_clusters[1]


def random_problem(seed: int) -> tuple[Float64Array, float]:
    """Points in blobs or spread out, in one to five dimensions, and a preference."""
    rng = np.random.default_rng(seed)
    n, d = int(rng.integers(5, 90)), int(rng.integers(1, 6))
    centers = rng.normal(scale=float(rng.choice([0.0, 2.0, 6.0])), size=(5, d))
    s = squared(centers[rng.integers(0, 5, n)] + rng.normal(size=(n, d)))
    off_diagonal = s[~np.eye(n, dtype=bool)]
    return s, float(np.quantile(off_diagonal, rng.choice([0.0, 0.25, 0.5, 0.9])))


def test_same_exemplars_as_scikit_learn() -> None:
    """At least 95 % of 200 random problems agree; both add the same jitter."""
    compared, differing = 0, []
    for seed in range(210):
        s, p = random_problem(seed)
        ours = affinity_propagation(s, p, PARAMS)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            exemplars, labels, n_iter = scikit_learn(
                s,
                preference=p,
                damping=0.9,
                max_iter=1000,
                convergence_iter=50,
                return_n_iter=True,
                random_state=PARAMS.seed,
            )
        if ours.converged and n_iter < 1000:
            compared += 1
            if not np.array_equal(exemplars, ours.exemplars) or (labels != ours.labels).any():
                differing.append((seed, len(s), p, exemplars, ours.exemplars))

    assert compared >= 200
    assert len(differing) <= 0.05 * compared, f"differing problems: {differing}"


def test_jitter_is_that_of_scikit_learn() -> None:
    """One matrix of normal numbers drawn at once equals ours, drawn row by row."""
    s = squared(np.random.default_rng(0).normal(size=(7, 2)))
    noise = np.random.RandomState(3).standard_normal((7, 7))

    found = jittered(s, 3)

    real = np.finfo(np.float64)
    assert np.array_equal(found, s + (real.eps * s + real.tiny * 100) * noise)
