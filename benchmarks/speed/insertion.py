"""Points into meta-points (Algorithm 1), against the least a full search costs and peers."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from sklearn.cluster import Birch, MiniBatchKMeans

from benchmarks.measuring.processes import in_turns
from benchmarks.measuring.table import Row
from benchmarks.speed.streams import (
    F32,
    MIN_POINTS,
    N_POINTS,
    THETA,
    clean_stream,
    coherent_stream,
    hard_stream,
)
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.params import MetaPointParams

REPEATS = 3
_BLOCK = 1024


def insertion(_folder: Path) -> list[Row]:
    """Insert 48,600 points of 96 dimensions; microseconds per point."""
    streams = {"hard": hard_stream(), "clean": clean_stream(), "coherent": coherent_stream()}
    return [row for name, points in streams.items() for row in _rows_of(name, points)]


def _rows_of(name: str, points: F32) -> list[Row]:
    """Compare one stream with the matrix product and with what scikit-learn has."""
    learnt = _inserted(points)
    means = learnt.references()[learnt.is_cluster_point].astype(np.float32)
    # Birch's threshold is a Euclidean radius, of which theta is the square root of half
    radius = THETA * float(np.sqrt(2.0))
    peers: dict[str, tuple[Callable[[], object], str]] = {
        "float32 gemm with the final means": (lambda: _multiplied(points, means), "<= 2.2x"),
        "MiniBatchKMeans(10)": (lambda: MiniBatchKMeans(10, random_state=0).fit(points), ">= 1x"),
        "Birch": (lambda: Birch(threshold=radius, n_clusters=None).fit(points), ">= 5x"),
    }
    works = [lambda: _inserted(points), *(work for work, _ in peers.values())]
    mine, *theirs = (
        tuple(1e6 * seconds / N_POINTS for seconds in times) for times in in_turns(works, REPEATS)
    )
    work = f"insert a point, 96-D {name} ({len(means)} cluster-points)"
    stretch = {"float32 gemm with the final means": "<= 1x"} if name == "coherent" else {}
    return [
        Row(
            work=work,
            mpap=mine,
            beside=beside,
            peer=times,
            unit="us",
            goal=goal,
            stretch=stretch.get(beside, ""),
        )
        for times, (beside, (_, goal)) in zip(theirs, peers.items(), strict=True)
    ]


def _inserted(points: F32) -> MetaPoints:
    """Return meta-points that have taken in all points."""
    meta_points = MetaPoints(MetaPointParams(theta=THETA, min_points=MIN_POINTS), points.shape[1])
    meta_points.add_data_points(points, np.arange(len(points)))
    return meta_points


def _multiplied(points: F32, means: F32) -> None:
    """Do the arithmetic of a search of all means for all points, and nothing else."""
    out = np.empty((_BLOCK, len(means)), np.float32)
    for start in range(0, len(points), _BLOCK):
        block = points[start : start + _BLOCK]
        np.matmul(block, means.T, out=out[: len(block)])
