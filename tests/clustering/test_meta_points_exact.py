"""The compiled Algorithm 1 equals the plain one, bit for bit, whatever comes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.clustering.meta_point_rows import _kernels
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
    reference = Reference(found.params, normalised=found.normalised)
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
    points, normalised = stream
    found = MetaPoints(params, points.shape[1], normalised=normalised)
    stamps = np.arange(len(points), dtype=np.int64)[:: -1 if back else 1].copy()

    assert_same(found, points, stamps, sorted(min(cut, len(points)) for cut in cuts))


@pytest.mark.parametrize("theta", [0.1, 0.2, 0.35])
@pytest.mark.parametrize("reference", ["mean", "exemplar"])
def test_a_long_stream_of_histograms_is_exact_too(theta: float, reference: str) -> None:
    """Hundreds of meta-points in 27 coordinates, renewed indexes and resized tables included."""
    rng = np.random.default_rng(0)
    centres = rng.dirichlet(np.full(26, 0.3), 30)
    histograms = rng.gamma(1e-3 + 60 * centres[rng.integers(0, 30, 700)])
    points = embed(histograms).astype(np.float32)
    found = MetaPoints(MetaPointParams(theta=theta, reference=reference), 27)

    assert_same(found, points, np.arange(700), [1, 2, 50, 51, 300])


@pytest.mark.parametrize("exemplar", ["first", "closest"])
def test_kernels_run_as_plain_python(monkeypatch: pytest.MonkeyPatch, exemplar: str) -> None:
    """The loops mean the same without compilation."""
    params = MetaPointParams(
        theta=3.5, min_points=3, exemplar=exemplar, noise_ttl=9e-9, max_noise=5
    )
    points = np.random.default_rng(3).normal(size=(80, 18)).astype(np.float32)
    points[20::3] = 0.6 * points[1::3][:20]
    stamps = np.arange(80)
    reference = Reference(params, normalised=False)
    expected = [reference.add_data_point(p, int(t)) for p, t in zip(points, stamps, strict=True)]
    rows = resized(empty_rows(0, 18), 80)
    index = build_index(rows, widest_axes(points))
    ids, cases = np.empty(80, np.int64), np.empty(80, np.int8)
    for name, kernel in list(vars(_kernels).items()):
        if hasattr(kernel, "py_func"):
            monkeypatch.setattr(_kernels, name, kernel.py_func)

    rules = rules_of(params, normalised=False, length=20.0)
    _kernels.add_block(rows, index, rules, points, stamps, 0, ids, cases)

    assert list(zip(ids.tolist(), cases.tolist(), strict=True)) == expected
    assert set(cases.tolist()) == {1, 2, 3}
    assert rows.totals[N_DROPPED] == reference.n_dropped > 0
