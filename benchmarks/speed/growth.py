"""How time and cluster-points grow with the number of points (the data of Table 3)."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.measuring.processes import cpu_of
from benchmarks.measuring.table import Row
from benchmarks.speed.streams import F32, gaussians
from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.distance import similarities
from mpap_cli.params import AffinityParams, MetaPointParams

SIZES = (500, 1000, 2000, 5000, 10_000)
_AFFINITY = AffinityParams(preference="median")
_META_POINT = MetaPointParams(theta=0.7, min_points=5)


def growth(_folder: Path) -> list[Row]:
    """Cluster more and more points of 10 Gaussians in the plane, with MPAP and with AP alone.

    An exponent of 1 is linear growth, of 2 quadratic.
    """
    _by_meta_points(gaussians(SIZES[0]))  # compiles the kernels
    _by_affinity(gaussians(SIZES[0])[:100])
    times, points = zip(*[_by_meta_points(gaussians(n)) for n in SIZES], strict=True)
    alone = [_by_affinity(gaussians(n)) for n in SIZES]
    over = f"N = {SIZES[0]:,} to {SIZES[-1]:,}"
    figures = (
        (f"exponent of time, {over}", _exponent(times), "AP alone", _exponent(alone), ">= 2x"),
        (f"exponent of cluster-points, {over}", _exponent(points), "linear growth", 1.0, "<="),
        (f"cluster-points, N = {SIZES[-1]:,}", points[-1], f"N = {SIZES[2]:,}", points[2], "<="),
    )
    rows = [
        Row(work=work, mpap=(mine,), beside=beside, peer=(other,), unit="", goal=goal)
        for work, mine, beside, other, goal in figures
    ]
    time = Row(
        work=f"cluster, N = {SIZES[-1]:,}",
        mpap=(times[-1],),
        beside="AP alone",
        peer=(alone[-1],),
        goal=">=",
    )
    return [*rows, time]


def _exponent(values: Sequence[float]) -> float:
    """Return the slope of values over sizes, both as logarithms."""
    return float(np.polyfit(np.log(SIZES), np.log(values), 1)[0])


def _by_meta_points(points: F32) -> tuple[float, int]:
    """Return time and cluster-points of meta-point affinity propagation."""

    def learn() -> int:
        meta_points = MetaPoints(_META_POINT, 2, normalized=False)
        meta_points.add_data_points(points, np.arange(len(points)))
        meta_points.cluster(_AFFINITY)
        return int(meta_points.is_cluster_point.sum())

    return cpu_of(learn)


def _by_affinity(points: F32) -> float:
    """Return the time of affinity propagation over all points."""

    def cluster() -> None:
        s = similarities(points, normalized=False)
        affinity_propagation(s, resolve_preference(s, _AFFINITY.preference), _AFFINITY)

    return cpu_of(cluster)[0]
