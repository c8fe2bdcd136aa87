"""The points in the plane of section 5.1.2: random Gaussians, with uniform noise if wanted."""

import numpy as np

from mpap_cli.evaluation.clusterers.records import LabelledPoints
from mpap_cli.observations import Float64Array

N_CLUSTERS = 10
N_POINTS = 2000
N_NOISE = 500
APART = 8.0
WIDTH = 27.0
MARGIN = 4.0


def plane_gaussians(seed: int, n_noise: int = 0, n_points: int = N_POINTS) -> LabelledPoints:
    """Return points around ten centers, in random order (section 5.1.2, figure 8).

    Parameters
    ----------
    seed : int
        Of centers, points and order.
    n_noise : int
        Points anywhere in the plane; their class is -1.
    n_points : int
        Points of the Gaussians, about as many of each.

    Returns
    -------
    LabelledPoints
        Two coordinates; the standard deviation of each Gaussian is 1.

    Notes
    -----
    The centers are at least 8 deviations apart, but close together, as in figure 8: in a
    world twice as wide the median similarity is so low that two of ten far neighbors may
    share a cluster.

    Examples
    --------
    >>> points = plane_gaussians(seed=0, n_noise=500)
    >>> points.features.shape, points.n_classes
    ((2500, 2), 10)
    """
    rng = np.random.default_rng(seed)
    centers: list[Float64Array] = []
    while len(centers) < N_CLUSTERS:
        centers = []
        for center in rng.uniform(0, WIDTH, (200, 2)):
            if all(np.linalg.norm(center - other) >= APART for other in centers):
                centers.append(center)
    classes = rng.integers(0, N_CLUSTERS, n_points)
    points = np.array(centers[:N_CLUSTERS])[classes] + rng.normal(size=(n_points, 2))
    noise = rng.uniform(-MARGIN, WIDTH + MARGIN, (n_noise, 2))
    points = np.concatenate([points, noise])
    classes = np.concatenate([classes, np.full(n_noise, -1)])
    order = rng.permutation(len(points))
    return LabelledPoints(
        features=points[order].astype(np.float32), classes=classes[order], normalized=False
    )
