"""Table 3 of the paper in shape: ten Gaussians, with and without noise."""

import numpy as np
import pytest
from sklearn.metrics import v_measure_score

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.distance import similarities, squared_distances
from mpap_cli.evaluation.gaussians import plane_gaussians
from mpap_cli.params import AffinityParams, MetaPointParams

MEDIAN = AffinityParams(preference="median")


@pytest.mark.slow
@pytest.mark.parametrize("n_noise", [0, 500])
@pytest.mark.parametrize("seed", range(10))
def test_mpap_finds_the_ten_clusters(seed: int, n_noise: int) -> None:
    """From 90 to 130 cluster-points, with V = 1 on the points that are no noise."""
    made = plane_gaussians(seed, n_noise)
    points, truth = made.features, made.classes
    meta_points = MetaPoints(MetaPointParams(theta=0.7, min_points=5), 2, normalized=False)

    meta_points.add_data_points(points, np.arange(len(points)))
    clustering = meta_points.cluster(MEDIAN)

    cluster_points = meta_points.references()[meta_points.is_cluster_point]
    nearest = squared_distances(points, cluster_points, normalized=False).argmin(axis=1)
    found = clustering.labels[nearest]
    assert len(clustering.exemplars) == 10
    assert 90 <= len(cluster_points) <= 130
    assert v_measure_score(truth[truth >= 0], found[truth >= 0]) == pytest.approx(1.0)


@pytest.mark.slow
@pytest.mark.parametrize(("n_noise", "low", "high"), [(0, 10, 10), (500, 15, 40)])
def test_affinity_propagation_splits_clusters_because_of_noise(
    n_noise: int, low: int, high: int
) -> None:
    """With median preference it finds ten clusters without noise and many more with it."""
    s = similarities(plane_gaussians(0, n_noise).features, normalized=False)

    clustering = affinity_propagation(s, resolve_preference(s, "median"), MEDIAN)

    assert low <= len(clustering.exemplars) <= high
