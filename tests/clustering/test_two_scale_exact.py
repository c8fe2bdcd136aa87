"""Blocks give what single observations give to the plain Algorithm 2, bit for bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.distance import embed
from mpap_cli.observations import Float32Array, IntArray
from mpap_cli.params import AffinityParams, StrapParams
from tests.clustering.strap_reference import Reference, squared_distance

AFFINITY = AffinityParams(max_iter=300)
STRAP = st.builds(
    StrapParams,
    eps=st.sampled_from([0.02, 0.12, 0.18, 0.3, 0.6]),
    reservoir=st.sampled_from([1, 2, 5, 12, 30]),
    known_share=st.sampled_from([0.0, 0.1, 0.5]),
    noise_share=st.sampled_from([0.5, 0.8]),
    weight_cap=st.sampled_from([1, 10, 1000]),
    strap_window_s=st.sampled_from([None, 1e-8, 1.0]),
    strap_distortion=st.booleans(),
    page_hinkley=st.booleans(),
    page_hinkley_lambda=st.sampled_from([0.5, 2.0]),
)


@st.composite
def streams(draw: st.DrawFn) -> Float32Array:
    """Embedded histograms around a few centers, with copies and empty ones."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, d = draw(st.integers(0, 90)), draw(st.sampled_from([1, 2, 5, 20]))
    sharpness = draw(st.sampled_from([1.0, 10.0, 60.0]))
    centers = rng.dirichlet(np.full(d, 0.5), 6)
    where = np.sort(rng.integers(0, 6, n)) if draw(st.booleans()) else rng.integers(0, 6, n)
    histograms = rng.gamma(1e-2 + sharpness * centers[where])
    histograms[rng.random(n) < 0.05] = 0.0
    points: Float32Array = embed(histograms).astype(np.float32)
    if n:
        copies = rng.random(n) < draw(st.sampled_from([0.0, 0.3]))
        points[copies] = points[rng.integers(0, n, np.count_nonzero(copies))]
    return points


def assert_same(
    points: Float32Array, stamps: IntArray, params: StrapParams, cuts: list[int]
) -> TwoScale:
    """Add blocks to one and single observations to the other; compare all they know."""
    found, reference = TwoScale(params, AFFINITY, points.shape[1]), Reference(params, AFFINITY)
    patches = np.arange(len(points)) % 7
    every_third = np.arange(len(points)) % 3 == 0

    expected = []
    for i, point in enumerate(points):
        expected.append(reference.add_observation(point, int(stamps[i]), int(patches[i]), 2))
    for i in np.flatnonzero(every_third).tolist():
        reference.add_label(expected[i][0], positive=i % 2 == 1)
    parts = [
        found.add_observations(points[part], stamps[part], patches[part], 2)
        for part in np.split(np.arange(len(points)), cuts)
    ]
    ids = np.concatenate([part.ids for part in parts])
    found.add_labels(ids[every_third], np.flatnonzero(every_third) % 2 == 1)

    assert ids.tolist() == [row[0] for row in expected]
    distances = np.concatenate([part.distances for part in parts])
    assert distances.tolist() == np.sqrt([row[1] for row in expected]).tolist()
    assert np.concatenate([part.outlier for part in parts]).tolist() == [row[2] for row in expected]
    assert found.current_ids(ids).tolist() == [reference.current(row[0]) for row in expected]
    assert_same_clusters(found, reference)
    return found


def assert_same_clusters(found: TwoScale, reference: Reference) -> None:
    """Both models hold the same clusters, and short-term exemplars with the same labels."""
    clusters = reference.clusters
    assert found.ids.tolist() == [c.id for c in clusters]
    assert found.exemplars.tolist() == [c.exemplar.tolist() for c in clusters]
    assert found.count.tolist() == [c.count for c in clusters]
    assert found.weight.tolist() == [c.weight for c in clusters]
    assert found.distortion.tolist() == [c.distortion for c in clusters]
    assert found.labels.tolist() == [c.labels for c in clusters]
    assert found.first_ns.tolist() == [c.first_ns for c in clusters]
    assert found.last_ns.tolist() == [c.last_ns for c in clusters]
    sources = zip(
        found.exemplar_stamp_ns.tolist(),
        found.exemplar_log.tolist(),
        found.exemplar_patch.tolist(),
        strict=True,
    )
    assert list(sources) == [c.source for c in clusters]
    assert found.n_reservoir == len(reference.outliers)
    assert found.n_rebuilds == reference.n_rebuilds
    fine = found.fine()
    short = [reference.outliers[row].id for row in reference.short_exemplars()]
    assert fine.ids[fine.is_short].tolist() == short


@settings(max_examples=settings().max_examples // 2)
@given(streams(), STRAP, st.lists(st.integers(0, 90), max_size=3), st.booleans())
def test_blocks_give_exactly_what_single_observations_give(
    points: Float32Array, params: StrapParams, cuts: list[int], back: bool
) -> None:
    """Ids, distances, clusters and labels, also with rebuilds inside of a block."""
    stamps = 5 * np.arange(len(points), dtype=np.int64)[:: -1 if back else 1]

    assert_same(points, stamps, params, sorted(min(cut, len(points)) for cut in cuts))


@settings(max_examples=settings().max_examples // 2)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1e-7, 1e-6, 1e-4, 0.05, 0.3]),
    st.sampled_from([0, 1, 2]),
    st.sampled_from([2, 6, 20]),
)
def test_points_at_the_fit_radius_are_judged_alike(
    seed: int, scale: float, ulps: int, reservoir: int
) -> None:
    """The radius is a distance within the stream, or one float off; many points are nearly one."""
    rng = np.random.default_rng(seed)
    kinds = embed(rng.dirichlet(np.full(9, 0.5), 3))
    points = kinds[rng.integers(0, 3, 70)] + scale * rng.normal(size=(70, 10))
    points = (points / np.linalg.norm(points, axis=1, keepdims=True)).astype(np.float32)
    eps = float(np.sqrt(squared_distance(points[0], points[rng.integers(1, 70)])))
    eps = min(max(float([eps, np.nextafter(eps, 0), np.nextafter(eps, 1)][ulps]), 1e-6), 0.9)

    assert_same(points, np.arange(70), StrapParams(eps=eps, reservoir=reservoir), [3, 40])


@pytest.mark.parametrize("reservoir", [3, 15])
def test_a_stream_that_wanders_off_is_exact(reservoir: int) -> None:
    """Kinds that move a little with every observation, past old exemplars and onto new ones."""
    rng = np.random.default_rng(7)
    angle = np.cumsum(rng.uniform(0.0, 0.02, 400))
    points = np.abs(0.03 * rng.normal(size=(400, 12)))
    points[:, 0] += np.abs(np.cos(angle))
    points[:, 1] += np.abs(np.sin(angle))
    points = (points / np.linalg.norm(points, axis=1, keepdims=True)).astype(np.float32)

    found = assert_same(points, np.arange(400), StrapParams(eps=0.1, reservoir=reservoir), [90])

    assert found.n_rebuilds >= 2


@pytest.mark.parametrize("known_share", [0.0, 0.3])
def test_a_long_stream_in_many_dimensions_is_exact_too(known_share: float) -> None:
    """Hundreds of observations of 12 kinds, with fringes and several rebuilds."""
    rng = np.random.default_rng(0)
    centers = rng.dirichlet(np.full(26, 0.4), 12)
    kinds = np.minimum(rng.integers(0, 12, 600), np.arange(600) // 40)
    points = embed(rng.gamma(1e-3 + 40 * centers[kinds])).astype(np.float32)
    params = StrapParams(eps=0.22, reservoir=20, known_share=known_share, noise_share=0.3)

    found = assert_same(points, np.arange(600), params, [1, 2, 300])

    assert found.n_rebuilds >= 4
    assert found.n_clusters >= 12
