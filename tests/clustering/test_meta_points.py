"""Meta-points: the cases of Algorithm 1 one by one, forgetting, labels, state."""

import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.distance import embed
from mpap_cli.errors import ModelError
from mpap_cli.observations import Float32Array
from mpap_cli.params import AffinityParams, MetaPointParams


def on_a_line(*xs: float) -> Float32Array:
    """Points with one coordinate."""
    return np.array(xs, np.float32)[:, None]


def line(xs: list[float], **params: float | str | None) -> MetaPoints:
    """Meta-points of points on a line, one nanosecond apart, theta 1."""
    made = MetaPoints(MetaPointParams(**{"theta": 1.0, **params}), 1, normalized=False)  # type: ignore[arg-type]
    made.add_data_points(on_a_line(*xs), np.arange(len(xs)))
    return made


def assert_same_state(points: MetaPoints, expected: dict[str, NDArray[Any]]) -> None:
    """All arrays are equal, bit for bit."""
    found = points.state()
    assert found.keys() == expected.keys()
    assert all(found[name].tobytes() == expected[name].tobytes() for name in expected)


def test_case_1_a_point_near_a_cluster_point_joins_it() -> None:
    """Lines 1-3: the cluster-point takes it, even if a noise-point is nearer."""
    points = line([0.0, 0.2, 1.7])

    ids, cases = points.add_data_points(on_a_line(1.0), np.array([9]))

    assert (ids[0], cases[0]) == (0, 1)
    assert points.count.tolist() == [3, 1]
    assert points.last_ns.tolist() == [9, 2]


def test_case_2_a_noise_point_becomes_a_cluster_point() -> None:
    """Lines 5-10: the point that completes min_points counts."""
    points = line([0.0, 0.5], min_points=3)
    before = points.is_cluster_point.tolist()

    _, cases = points.add_data_points(on_a_line(0.4), np.array([2]))

    assert before == [False]
    assert cases.tolist() == [2]
    assert points.is_cluster_point.tolist() == [True]
    assert points.count.tolist() == [3]


def test_case_3_a_point_on_its_own_becomes_a_noise_point() -> None:
    """Lines 11-13."""
    points = line([0.0, 5.0])

    assert points.ids.tolist() == [0, 1]
    assert points.is_cluster_point.tolist() == [False, False]


def test_min_points_1_makes_cluster_points_at_once() -> None:
    """There is no noise then."""
    assert line([0.0, 5.0], min_points=1).is_cluster_point.all()


def test_a_point_at_distance_theta_is_outside() -> None:
    """The comparison is strict."""
    assert line([0.0, 1.0]).n_points == 2
    assert line([0.0, 0.999]).n_points == 1


def test_of_two_equally_near_the_older_one_takes_the_point() -> None:
    """Also if the younger one became a cluster-point first."""
    points = line([0.0, 1.5, 1.5, 0.0])

    ids, _ = points.add_data_points(on_a_line(0.75), np.array([9]))

    assert points.is_cluster_point.tolist() == [True, True]
    assert ids.tolist() == [0]


def test_the_mean_moves_and_the_exemplar_stays() -> None:
    """Distances go to the mean; the exemplar is the first point."""
    points = line([0.0, 0.8])

    assert points.references().tolist() == [[pytest.approx(0.4)]]
    assert points.exemplars.tolist() == [[0.0]]


def test_reference_exemplar_cannot_drift() -> None:
    """Every member stays within theta of one point that was seen."""
    assert line([0.0, 0.9, 1.2], reference="exemplar", min_points=1).n_points == 2
    assert line([0.0, 0.9, 1.2], reference="mean", min_points=1).n_points == 1


def test_exemplar_closest_follows_the_mean() -> None:
    """A point nearer the mean than the kept exemplar replaces it, with its stamp and log."""
    points = line([0.0, 0.8], exemplar="closest")

    points.add_data_points(on_a_line(0.4), np.array([7]), log_index=3)

    assert points.exemplars[0, 0] == pytest.approx(0.4)
    assert points.exemplar_stamp_ns.tolist() == [7]
    assert points.exemplar_log.tolist() == [3]


def test_means_of_histograms_have_length_1() -> None:
    """The mean stays on the sphere, the sum is kept as it is."""
    points = MetaPoints(MetaPointParams(theta=0.9), 3)
    u = embed(np.array([[1.0, 0.0], [1.0, 1.0]], np.float32)).astype(np.float32)

    points.add_data_points(u, np.arange(2))

    assert np.linalg.norm(points.references()) == pytest.approx(1.0)
    assert np.allclose(points.sums, u.sum(axis=0))
    again = MetaPoints.from_state(points.params, points.state())
    assert again.references().tobytes() == points.references().tobytes()


def test_the_oldest_single_noise_point_goes_first() -> None:
    """With room for two, the one with two points outlives an older and a younger single."""
    points = line([0.0, 10.0, 10.1, 20.0], min_points=5, max_noise=2)

    ids, _ = points.add_data_points(on_a_line(30.0), np.array([4]))

    assert points.ids.tolist() == [1, 3]
    assert points.n_dropped == 2
    assert points.rows_of(np.array([0, 1, 2, 3, 99])).tolist() == [-1, 0, -1, 1, -1]
    assert ids.tolist() == [3]


def test_noise_points_unseen_for_their_time_to_live_are_forgotten() -> None:
    """They can neither take a point any more nor be found."""
    points = line([0.0], noise_ttl=1.0)

    ids, cases = points.add_data_points(on_a_line(0.1), np.array([1_000_000_001]))

    assert (ids.tolist(), cases.tolist()) == ([1], [3])
    assert points.ids.tolist() == [1]


def test_cluster_points_are_never_forgotten() -> None:
    """Neither the time to live nor the cap touches them."""
    points = line([0.0, 0.1], noise_ttl=1.0, max_noise=1)

    points.add_data_points(on_a_line(50.0, 60.0), np.array([10**12, 2 * 10**12]))

    assert points.ids.tolist() == [0, 2]


def test_memory_is_bounded_by_the_cap() -> None:
    """A stream of nothing but noise leaves tables of a fixed size."""
    points = MetaPoints(MetaPointParams(theta=0.5, max_noise=50), 1, normalized=False)

    for start in range(0, 6_000, 300):
        xs = np.arange(start, start + 300, dtype=np.float32)[:, None]
        points.add_data_points(xs, np.arange(300))

    assert points.n_points == 50
    assert points.n_dropped == 5_950
    assert len(points._rows.kind) <= 512


def test_labels_are_counted_at_the_meta_points_that_took_the_points() -> None:
    """Pairs are apart, repeated ids add up, dropped ids are left out."""
    points = line([0.0, 5.0, 9.0], max_noise=2)

    points.add_counts(np.array([1, 1, 2, 0]), 1, np.array([True, True, False, True]))
    points.add_counts(np.array([2]), 0, np.array([True]))

    assert points.counts[:, 0].tolist() == [[0, 0], [0, 1]]
    assert points.counts[:, 1].tolist() == [[0, 2], [1, 0]]


def test_clusters_are_made_of_cluster_points_only() -> None:
    """Noise-points take no part in affinity propagation."""
    points = line([0.0, 0.1, 2.0, 2.1, 90.0, 90.1, 92.0, 92.1, 500.0])

    clustering = points.cluster(AffinityParams(preference="median"))

    assert clustering.labels.tolist() == [0, 0, 1, 1]
    assert clustering.converged


def test_count_weights_favour_more_clusters() -> None:
    """With weights the preference is that of one point, not of a meta-point."""
    rng = np.random.default_rng(0)
    points = MetaPoints(MetaPointParams(theta=0.5, min_points=1), 2, normalized=False)
    points.add_data_points(rng.normal(size=(400, 2)).astype(np.float32), np.arange(400))

    plain = points.cluster(AffinityParams(preference="median"))
    weighted = points.cluster(AffinityParams(preference="median", weights="count"))

    assert len(weighted.exemplars) > len(plain.exemplars)


def test_no_cluster_point_no_cluster() -> None:
    """Nothing was seen, or nothing twice."""
    assert line([]).cluster(AffinityParams()).exemplars.size == 0
    assert line([]).rows_of(np.array([0])).tolist() == [-1]
    assert line([1.0]).cluster(AffinityParams()).labels.size == 0


def test_state_goes_on_exactly() -> None:
    """From a state, the rest of a stream gives what the whole stream gives."""
    rng = np.random.default_rng(1)
    u = embed(rng.gamma(0.3, size=(300, 8))).astype(np.float32)
    whole = MetaPoints(MetaPointParams(theta=0.3, max_noise=20), 9)
    whole.add_data_points(u, np.arange(300))
    half = MetaPoints(whole.params, 9)
    half.add_data_points(u[:150], np.arange(150))

    rest = MetaPoints.from_state(half.params, half.state())
    rest.add_data_points(u[150:], np.arange(150, 300))

    assert_same_state(rest, whole.state())
    assert np.array_equal(rest.references(), whole.references())


@pytest.mark.parametrize(
    ("name", "value", "match"),
    [
        ("sums", None, "sums is missing"),
        ("ids", np.array([1, 1]), "ids do not ascend"),
        ("ids", np.array([0, 7]), "next_id is among the ids in use"),
        ("point_count", np.array([0, 1]), "point_count holds values below 1"),
        ("label_counts", np.full((2, 3, 2), -1), "label_counts holds values below 0"),
        ("sums", np.full((2, 1), np.nan), "sums holds values that are not finite"),
        ("exemplars", np.zeros((3, 1), np.float32), "sums has shape|ids has shape"),
        ("exemplars", np.zeros(2, np.float32), "exemplars is not a matrix"),
        ("exemplars", np.zeros((2, 1)), "exemplars has type float64, expected float32"),
    ],
)
def test_a_damaged_state_is_refused(name: str, value: object, match: str) -> None:
    """Every array of a model file is checked before it is used."""
    state = line([0.0, 5.0]).state()
    state.pop(name)
    if value is not None:
        state[name] = value  # type: ignore[assignment]

    with pytest.raises(ModelError, match=match):
        MetaPoints.from_state(MetaPointParams(), state)


def test_points_that_do_not_fit_are_an_error() -> None:
    """Wrong width, wrong number of stamps, not a number."""
    points = MetaPoints(MetaPointParams(), 3)

    with pytest.raises(ValueError, match=r"expected \(m, 3\)"):
        points.add_data_points(np.zeros((2, 4), np.float32), np.arange(2))
    with pytest.raises(ValueError, match=r"expected \(m, 3\)"):
        points.add_data_points(np.zeros((2, 3), np.float32), np.arange(3))
    with pytest.raises(ValueError, match="not finite"):
        points.add_data_points(np.full((1, 3), np.nan, np.float32), np.arange(1))


def test_arguments_are_neither_changed_nor_kept() -> None:
    """Writing into what was given or returned changes nothing inside."""
    x, stamps = on_a_line(0.0, 0.2), np.arange(2)
    points = MetaPoints(MetaPointParams(theta=1.0), 1, normalized=False)
    points.add_data_points(x, stamps)
    before = points.state()

    x[:] = 9.0
    stamps[:] = 9
    for returned in (points.sums, points.count, points.references(), *points.state().values()):
        returned[...] = 0

    assert_same_state(points, before)


def test_a_pickled_copy_goes_on_like_the_original() -> None:
    """Workers hand their meta-points over as they are."""
    points = line([0.0, 0.2, 7.0])

    copy = pickle.loads(pickle.dumps(points))  # noqa: S301  # our own
    results = [each.add_data_points(on_a_line(7.1, 3.0), np.arange(2)) for each in (points, copy)]

    assert np.array_equal(results[0], results[1])
    assert_same_state(copy, points.state())
