"""The compiled Algorithm 1 equals the plain one, bit for bit, whatever comes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mpap_cli.clustering.meta_point_rows import _kernels
from mpap_cli.clustering.meta_point_rows.adding import _kernels as adding
from mpap_cli.clustering.meta_point_rows.adding import products
from mpap_cli.clustering.meta_point_rows.adding.blocks import Block
from mpap_cli.clustering.meta_point_rows.distances import _kernels as distances
from mpap_cli.clustering.meta_point_rows.tables import (
    N_DROPPED,
    build_index,
    empty_rows,
    resized,
    rules_of,
    widest_axes,
)
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.distance import embed
from mpap_cli.observations import Float32Array, IntArray
from mpap_cli.params import MetaPointParams
from tests.clustering.reference import Reference

PARAMS = st.builds(
    MetaPointParams,
    theta=st.sampled_from([1e-9, 0.05, 0.13, 0.3, 0.5, 1.0, 2.0, 50.0, 1e8]),
    min_points=st.sampled_from([1, 2, 3, 5]),
    reference=st.sampled_from(["mean", "exemplar"]),
    exemplar=st.sampled_from(["first", "closest"]),
    noise_ttl=st.sampled_from([None, 3e-9, 20e-9]),
    max_noise=st.sampled_from([1, 3, 1000]),
)


@st.composite
def streams(draw: st.DrawFn) -> tuple[Float32Array, bool]:
    """Points with duplicates and ties, embedded histograms (some empty) or points on a grid."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, d = draw(st.integers(0, 60)), draw(st.sampled_from([1, 2, 3, 4, 7, 12, 19, 26]))
    levels = draw(st.sampled_from([2, 3, 1000]))
    coarse = rng.integers(0, levels, (n, d)).astype(np.float64)
    if draw(st.booleans()):
        coarse[rng.random(n) < 0.2] = 0.0
        return embed(coarse).astype(np.float32), True
    scale = draw(st.sampled_from([1e-30, 1.0, 1e3, 1e15, 3e38]))
    offset = draw(st.sampled_from([0.0, -1.0]))
    return ((coarse / levels + offset) * scale).astype(np.float32), False


def assert_same(found: MetaPoints, points: Float32Array, stamps: IntArray, cuts: list[int]) -> None:
    """Add the points in blocks to one and singly to the other; compare all they know."""
    reference = Reference(found.params, normalized=found.normalized)
    expected = [
        reference.add_data_point(point, int(stamp))
        for point, stamp in zip(points, stamps, strict=True)
    ]

    blocks = zip(np.split(points, cuts), np.split(stamps, cuts), strict=True)
    out = [found.add_data_points(block, at) for block, at in blocks]

    assert (
        list(zip(*(np.concatenate(part).tolist() for part in zip(*out, strict=True)), strict=True))
        == expected
    )
    table = reference.table()
    for name, values in table.items():
        assert np.array_equal(getattr(found, name), values.reshape(getattr(found, name).shape)), (
            name
        )
    assert found.n_dropped == reference.n_dropped


@given(streams(), PARAMS, st.lists(st.integers(0, 60), max_size=3), st.booleans())
def test_blocks_give_exactly_what_single_points_give(
    stream: tuple[Float32Array, bool], params: MetaPointParams, cuts: list[int], back: bool
) -> None:
    """Ids, cases and all statistics are those of the pseudo-code, also for falling stamps."""
    points, normalized = stream
    found = MetaPoints(params, points.shape[1], normalized=normalized)
    stamps = np.arange(len(points), dtype=np.int64)[:: -1 if back else 1].copy()

    assert_same(found, points, stamps, sorted(min(cut, len(points)) for cut in cuts))


@pytest.fixture
def _always_products(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let float32 products be the filter of few rows too, in blocks of few points."""
    monkeypatch.setattr(products, "_FEWEST_ROWS", 0)
    monkeypatch.setattr(products, "_FEWEST_DIMS", 1)
    monkeypatch.setattr(products, "_FEWEST_POINTS", 3)
    monkeypatch.setattr(products, "_ELEMENTS", 500)


@pytest.mark.usefixtures("_always_products")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(streams(), PARAMS, st.lists(st.integers(0, 60), max_size=3), st.booleans())
def test_products_change_nothing(
    stream: tuple[Float32Array, bool], params: MetaPointParams, cuts: list[int], back: bool
) -> None:
    """Blocks that are filtered by products give what single points give."""
    points, normalized = stream
    found = MetaPoints(params, points.shape[1], normalized=normalized)
    stamps = np.arange(len(points), dtype=np.int64)[:: -1 if back else 1].copy()

    assert_same(found, points, stamps, sorted(min(cut, len(points)) for cut in cuts))


@pytest.mark.usefixtures("_always_products")
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-8, 1e-7, 1e-6, 1e-4, 1e-2]), PARAMS)
def test_points_that_float32_cannot_part_are_told_apart(
    seed: int, scale: float, params: MetaPointParams
) -> None:
    """Around two centers at theta of one another, nearer and farther by rounding alone."""
    rng = np.random.default_rng(seed)
    theta = min(params.theta, 0.5)
    along = np.eye(12)[:2]
    ends = np.array(
        [along[0], along[0] * np.cos(theta * 1.4142) + along[1] * np.sin(theta * 1.4142)]
    )
    points = ends[rng.integers(0, 2, 120)] + scale * rng.normal(size=(120, 12))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    found = MetaPoints(replace(params, theta=theta), 12)

    assert_same(found, points.astype(np.float32), np.arange(120), [7, 50])


@pytest.mark.usefixtures("_always_products")
@pytest.mark.parametrize("reference", ["mean", "exemplar"])
def test_means_that_drift_far_within_a_block_are_found(reference: str) -> None:
    """Points wander along an arc and drag their means with them; all come in one block."""
    rng = np.random.default_rng(4)
    angle = np.cumsum(rng.uniform(0.0, 0.03, 900))
    points = 0.02 * rng.normal(size=(900, 30))
    points[:, 0] += np.cos(angle)
    points[:, 1] += np.sin(angle)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    params = MetaPointParams(theta=0.15, min_points=3, reference=reference)
    found = MetaPoints(params, 30)

    assert_same(found, points.astype(np.float32), np.arange(900), [])


@pytest.mark.usefixtures("_always_products")
def test_products_are_given_up_when_points_become_too_long() -> None:
    """Products of points of length 1e20 overflow; what was learnt of short ones stays."""
    rng = np.random.default_rng(5)
    points = rng.normal(size=(90, 9)).astype(np.float32)
    points[60:] *= np.float32(1e20)
    found = MetaPoints(MetaPointParams(theta=2.0), 9, normalized=False)

    assert_same(found, points, np.arange(90), [60])

    assert found._index.copies.shape[2] == 0


@pytest.mark.parametrize("theta", [0.1, 0.2, 0.35])
@pytest.mark.parametrize("reference", ["mean", "exemplar"])
def test_a_long_stream_of_histograms_is_exact_too(theta: float, reference: str) -> None:
    """Hundreds of meta-points in 27 coordinates, renewed indexes and resized tables included."""
    rng = np.random.default_rng(0)
    centers = rng.dirichlet(np.full(26, 0.3), 30)
    histograms = rng.gamma(1e-3 + 60 * centers[rng.integers(0, 30, 700)])
    points = embed(histograms).astype(np.float32)
    found = MetaPoints(MetaPointParams(theta=theta, reference=reference), 27)

    assert_same(found, points, np.arange(700), [1, 2, 50, 51, 300])


@pytest.mark.parametrize("with_products", [False, True])
@pytest.mark.parametrize("exemplar", ["first", "closest"])
def test_kernels_run_as_plain_python(
    monkeypatch: pytest.MonkeyPatch, exemplar: str, with_products: bool
) -> None:
    """The loops mean the same without compilation."""
    params = MetaPointParams(
        theta=3.5, min_points=3, exemplar=exemplar, noise_ttl=9e-9, max_noise=5
    )
    points = np.random.default_rng(3).normal(size=(80, 18)).astype(np.float32)
    points[20::3] = 0.6 * points[1::3][:20]
    stamps = np.arange(80)
    reference = Reference(params, normalized=False)
    expected = [reference.add_data_point(p, int(t)) for p, t in zip(points, stamps, strict=True)]
    rows = resized(empty_rows(0, 18), 80)
    index = build_index(rows, widest_axes(points), with_copies=with_products)
    ids, cases, halves = np.empty(80, np.int64), np.empty(80, np.int8), np.empty(80)
    for module in (_kernels, adding, distances):
        for name, kernel in list(vars(module).items()):
            if hasattr(kernel, "py_func"):
                monkeypatch.setattr(module, name, kernel.py_func)

    distances.half_squares(points, halves)
    rules = rules_of(params, normalized=False, length=20.0)
    block = Block(points, halves, stamps, ids, cases, 0)
    products.ProductFilter().add(rows, index, rules, block)

    assert list(zip(ids.tolist(), cases.tolist(), strict=True)) == expected
    assert set(cases.tolist()) == {1, 2, 3}
    assert rows.totals[N_DROPPED] == reference.n_dropped > 0
