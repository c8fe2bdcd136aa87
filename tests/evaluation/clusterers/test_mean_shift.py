"""Mean shift of all points at once is scikit-learn's."""

import numpy as np
import pytest
from sklearn.cluster import MeanShift
from sklearn.metrics import adjusted_rand_score

from mpap_cli.evaluation.clusterers.mean_shift import mean_shift


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("bandwidth", [0.8, 2.0, 5.0])
def test_it_finds_the_clusters_of_scikit_learn(seed: int, bandwidth: float) -> None:
    """The same partition on points of three dimensions in some groups."""
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-6, 6, (5, 3))
    points = centers[rng.integers(0, 5, 150)] + rng.normal(size=(150, 3))
    expected = MeanShift(bandwidth=bandwidth).fit_predict(points)

    labels, n_clusters = mean_shift(points, bandwidth)

    assert adjusted_rand_score(expected, labels) == pytest.approx(1.0)
    assert n_clusters == expected.max() + 1


def test_copies_are_one_cluster() -> None:
    """Points at one place end at one mode."""
    labels, n_clusters = mean_shift(np.ones((600, 2)), 0.1)

    assert n_clusters == 1
    assert not labels.any()
