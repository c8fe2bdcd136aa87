"""The estimators do what scikit-learn expects of a clusterer, and what the algorithms give."""

from typing import Any

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.datasets import make_blobs
from sklearn.metrics import v_measure_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

from mpap_cli.errors import SettingError
from mpap_cli.estimators import AffinityPropagation, MetaPointAffinityPropagation

BLOBS, CLASSES = make_blobs(600, centers=5, cluster_std=0.4, random_state=3)


@parametrize_with_checks([AffinityPropagation(), MetaPointAffinityPropagation()])  # type: ignore[untyped-decorator]
@pytest.mark.filterwarnings("default")
def test_scikit_learn_checks(estimator: Any, check: Any) -> None:
    """Every check of scikit-learn for clusterers passes."""
    check(estimator)


@pytest.mark.parametrize("estimator", [AffinityPropagation, MetaPointAffinityPropagation])
def test_blobs_in_a_pipeline(estimator: Any) -> None:
    """Five blobs are told apart behind a scaler; new points join them."""
    pipeline = make_pipeline(StandardScaler(), estimator(preference="min"))

    labels = pipeline.fit_predict(BLOBS)
    again = pipeline.predict(BLOBS)

    assert v_measure_score(CLASSES, labels) > 0.88
    assert np.array_equal(labels, again)


def test_parts_are_the_whole() -> None:
    """Points in parts give what all at once give, with theta known."""
    whole = MetaPointAffinityPropagation(theta=0.5).fit(BLOBS)
    parts = MetaPointAffinityPropagation(theta=0.5)
    for part in np.array_split(BLOBS, 7):
        parts.partial_fit(part)

    assert parts.n_meta_points_ == whole.n_meta_points_ < 600
    assert np.array_equal(parts.predict(BLOBS), whole.labels_)


def test_points_that_were_seen_once_are_noise() -> None:
    """Without any cluster-point all are unassigned."""
    x = np.array([[0.0], [10.0], [20.0]])

    found = MetaPointAffinityPropagation(theta=1.0).fit(x)

    assert found.labels_.tolist() == [-1, -1, -1]
    assert found.n_cluster_points_ == 0


def test_wrong_settings_are_named() -> None:
    """At fit, as scikit-learn wants it; a clone keeps them."""
    estimator = AffinityPropagation(damping=2.0)

    with pytest.raises(SettingError, match="damping"):
        clone(estimator).fit(BLOBS)
