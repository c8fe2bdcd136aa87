"""Clusters are scored against classes, noise left out."""

import math
from dataclasses import replace

import numpy as np
import pytest
from sklearn.metrics import adjusted_rand_score, v_measure_score

from mpap_cli.evaluation.clusterers.records import ClusteringResult
from mpap_cli.evaluation.clusterers.scores import score_clustering
from mpap_cli.observations import IntArray
from tests.evaluation.clusterers.groups import groups


def clusters(labels: IntArray) -> ClusteringResult:
    """Return a result with these labels."""
    return ClusteringResult(
        labels=labels,
        clusters=int(labels.max()) + 1,
        clustered_points=None,
        coverage=None,
        seconds=0.5,
    )


def test_scores_are_those_of_scikit_learn() -> None:
    """V-measure and adjusted Rand index of random labels."""
    points = groups(20)
    labels = np.random.default_rng(0).integers(0, 4, 60)

    row = score_clustering("mpap", "default", 2, points, clusters(labels))

    assert row.v_measure == pytest.approx(v_measure_score(points.classes, labels))
    assert row.ari == pytest.approx(adjusted_rand_score(points.classes, labels))
    product = row.homogeneity * row.completeness / (row.homogeneity + row.completeness)
    assert row.v_measure == pytest.approx(2 * product)
    assert (row.method, row.variant, row.order_seed, row.points) == ("mpap", "default", 2, 60)


def test_points_of_no_class_do_not_count() -> None:
    """Noise among the points may be in any cluster."""
    points = groups(20)
    labels = points.classes.copy()
    labels[:15] = 0
    noisy = replace(points, classes=np.where(np.arange(60) < 15, -1, points.classes))

    row = score_clustering("mpap", "default", 0, noisy, clusters(labels))

    assert row.v_measure == pytest.approx(1.0)
    assert row.points == 60


def test_one_class_has_no_score() -> None:
    """V-measure and its kin are no numbers where there is one class."""
    row = score_clustering("ap", "median", None, groups(20, 1), clusters(np.arange(20) % 2))

    scores = (row.v_measure, row.homogeneity, row.completeness, row.ari)
    assert all(math.isnan(score) for score in scores)
    assert row.clusters == 2
