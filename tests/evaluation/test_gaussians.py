"""The Gaussians in the plane."""

import numpy as np
import pytest

from mpap_cli.evaluation.gaussians import MARGIN, WIDTH, plane_gaussians


@pytest.mark.parametrize("seed", range(5))
def test_the_clusters_lie_apart(seed: int) -> None:
    """The means of any two classes are nearly 8 deviations apart or more."""
    points = plane_gaussians(seed)

    means = np.array([points.features[points.classes == one].mean(axis=0) for one in range(10)])

    gaps = np.linalg.norm(means[:, None] - means, axis=2)[np.triu_indices(10, 1)]
    assert gaps.min() > 7.5


def test_a_cluster_has_unit_deviation() -> None:
    """Both coordinates of a class deviate by about 1."""
    points = plane_gaussians(0)

    deviations = [points.features[points.classes == one].std(axis=0) for one in range(10)]

    assert np.mean(deviations) == pytest.approx(1.0, abs=0.05)


def test_noise_is_anywhere_and_has_no_class() -> None:
    """Noise fills the plane to its edges, and its class is -1."""
    points = plane_gaussians(1, n_noise=500)

    noise = points.features[points.classes == -1]

    assert len(noise) == 500
    assert np.all((noise >= -MARGIN) & (noise <= WIDTH + MARGIN))
    assert noise.min() < 0
    assert noise.max() > WIDTH


def test_the_order_is_random_and_the_same_for_a_seed() -> None:
    """Neither classes nor noise come in blocks; a seed gives the same points."""
    one, again = plane_gaussians(2, 100), plane_gaussians(2, 100)

    assert np.array_equal(one.features, again.features)
    assert not np.array_equal(one.features, plane_gaussians(3, 100).features)
    assert 0 < np.count_nonzero(one.classes[:500] == -1) < 100
