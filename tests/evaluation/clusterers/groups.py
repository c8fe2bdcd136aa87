"""Embedded histograms in groups that anything can tell apart."""

import numpy as np

from mpap_cli.distance import embed
from mpap_cli.evaluation.clusterers.records import LabelledPoints


def groups(
    n_each: int = 40, n_groups: int = 3, seed: int = 0, noise: float = 0.05
) -> LabelledPoints:
    """Return histograms of 12 bins around a few, in random order."""
    rng = np.random.default_rng(seed)
    centers = np.eye(n_groups, 12) * 5 + 0.5
    classes = rng.permutation(np.repeat(np.arange(n_groups), n_each))
    histograms = centers[classes] * rng.uniform(1 - noise, 1 + noise, (len(classes), 12))
    features = embed(histograms).astype(np.float32)
    return LabelledPoints(features=features, classes=classes)
