"""All clusterers by method and variant, in the order of the table (section 5.1, Table 2)."""

import importlib.util
from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from mpap_cli.evaluation.clusterers import own, peers
from mpap_cli.evaluation.clusterers.records import (
    Clusterer,
    ClustererSettings,
    ClusteringResult,
    LabelledPoints,
    Run,
)

MOST_POINTS = 5000


def _of_points(run: Callable[[LabelledPoints], ClusteringResult]) -> Run:
    """Make a run of a function that takes points alone."""
    return lambda points, _settings, _seed: run(points)


def _seeded(run: Callable[[LabelledPoints, int], ClusteringResult]) -> Run:
    """Make a run of a function that takes points and a seed."""
    return lambda points, _settings, seed: run(points, seed)


def _settled(run: Callable[[LabelledPoints, ClustererSettings], ClusteringResult]) -> Run:
    """Make a run of a function that takes points and settings."""
    return lambda points, settings, _seed: run(points, settings)


_AP, _AP_MEDIAN = (_settled(partial(own.cluster_all_points, coarse=c)) for c in (True, False))
_STRAP, _STRAP_FINE = (_settled(partial(own.cluster_by_strap, fine=f)) for f in (False, True))
_HDBSCAN, _HDBSCAN_NEAREST = (
    _of_points(partial(peers.cluster_by_density, with_noise=w)) for w in (True, False)
)

CLUSTERERS: Mapping[tuple[str, str], Clusterer] = MappingProxyType(
    {
        ("ap", "default"): Clusterer(_AP, varies=False, most_points=MOST_POINTS),
        ("ap", "median"): Clusterer(_AP_MEDIAN, varies=False, most_points=MOST_POINTS),
        ("mpap", "default"): Clusterer(own.cluster_by_meta_points),
        ("mpap", "fixed-theta"): Clusterer(own.cluster_by_fixed_theta),
        ("strap", "default"): Clusterer(_STRAP),
        ("strap", "fine"): Clusterer(_STRAP_FINE),
        ("k-means", "raw"): Clusterer(_seeded(peers.k_means_of_histograms)),
        ("k-means", "square-root"): Clusterer(_seeded(peers.k_means_of_points)),
        ("mean-shift", "default"): Clusterer(
            _of_points(peers.shift_means), varies=False, most_points=MOST_POINTS
        ),
        ("hdbscan", "default"): Clusterer(_HDBSCAN, varies=False, most_points=MOST_POINTS),
        ("hdbscan", "nearest"): Clusterer(_HDBSCAN_NEAREST, varies=False, most_points=MOST_POINTS),
        ("denstream", "default"): Clusterer(peers.cluster_stream, needs="river"),
    }
)
"""Method and variant to clusterer.

``ap``: preference median times n / 50, or the median. ``mpap``: as the settings say, or
with theta 0.13. ``strap``: coarse clusters over its exemplars, or the exemplars themselves.
``k-means``, with the true number of classes: plain histograms, or their square roots (the
points as they are). ``hdbscan``: noise apart, or in the nearest cluster.
"""


def is_there(clusterer: Clusterer) -> bool:
    """Tell whether the package that a clusterer needs is installed."""
    return clusterer.needs is None or importlib.util.find_spec(clusterer.needs) is not None


def warm_up() -> None:
    """Load kernels and packages, so that the first run is not charged for them."""
    rng = np.random.default_rng(0)
    features = np.abs(rng.normal(size=(40, 4))).astype(np.float32)
    features /= np.linalg.norm(features, axis=1, keepdims=True)
    points = LabelledPoints(features=features, classes=np.arange(40, dtype=np.int64) % 2)
    for clusterer in CLUSTERERS.values():
        if is_there(clusterer):
            clusterer.run(points, ClustererSettings(), 0)
