"""A model of clusters on two scales as arrays of a file, and back."""

from typing import Any

import numpy as np
import pytest

from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.errors import ModelError
from mpap_cli.observations import Float32Array
from mpap_cli.params import AffinityParams, StrapParams
from tests.clustering.blobs import N_DIMS, around, centers

PARAMS = StrapParams(eps=0.18, reservoir=40, page_hinkley=True, page_hinkley_lambda=30.0)
AFFINITY = AffinityParams()


def stream(n: int) -> Float32Array:
    """Observations of eight kinds."""
    rng = np.random.default_rng(0)
    return around(centers(8)[rng.integers(0, 8, n)], 0.13, rng)


def model_of(points: Float32Array) -> TwoScale:
    """Make a model with clusters, outliers and labels."""
    model = TwoScale(PARAMS, AFFINITY, N_DIMS)
    at = np.arange(len(points))
    added = model.add_observations(points, at, at % 9, log_index=1)
    model.add_labels(added.ids, at % 3 == 0)
    return model


def test_state_goes_on_exactly() -> None:
    """From a state, the rest of a stream gives what the whole stream gives."""
    points, at = stream(800), np.arange(400, 800)
    half = model_of(points[:400])

    rest = TwoScale.from_state(PARAMS, AFFINITY, half.state())

    assert half.n_reservoir > 0
    assert half.state()["n_since_rebuild"] == rest.state()["n_since_rebuild"] > 0
    for model in (half, rest):
        added = model.add_observations(points[400:], at, at % 9, log_index=1)
        model.add_labels(added.ids, at % 2 == 0)
    states = half.state(), rest.state()
    assert states[0].keys() == states[1].keys()
    assert all(states[0][name].tobytes() == states[1][name].tobytes() for name in states[0])
    assert rest.coarse().labels.tolist() == half.coarse().labels.tolist()


def test_after_loading_living_ids_are_known_and_merged_ones_are_not() -> None:
    """What became of ids is not part of a state; clusters and outliers keep theirs."""
    model = model_of(stream(400))
    state = model.state()
    living = np.concatenate([state["clusters.ids"], state["reservoir.ids"]])
    others = np.setdiff1d(np.arange(int(state["next_id"])), living)

    again = TwoScale.from_state(PARAMS, AFFINITY, state)

    assert again.current_ids(living).tolist() == living.tolist()
    assert others.size > 0
    assert (again.current_ids(others) == -1).all()


def test_a_new_model_has_a_state_too() -> None:
    """Nothing was seen yet."""
    again = TwoScale.from_state(PARAMS, AFFINITY, TwoScale(PARAMS, AFFINITY, 5).state())

    assert (again.n_dims, again.n_clusters, again.n_reservoir) == (5, 0, 0)
    assert again.coarse().exemplars.size == 0
    assert again.fine().ids.size == 0


def test_a_smaller_reservoir_than_it_was_learnt_with_is_refused() -> None:
    """Outliers that wait would have no room."""
    model = model_of(stream(400))

    with pytest.raises(ModelError, match=r"outliers wait, setting reservoir is 1; use the setting"):
        TwoScale.from_state(StrapParams(reservoir=1), AFFINITY, model.state())


@pytest.mark.parametrize(
    ("name", "change", "match"),
    [
        ("clusters.ids", None, "clusters.ids is missing"),
        ("clusters.ids", lambda a: a[::-1], "ids do not ascend"),
        ("reservoir.ids", lambda a: a * 0, "ids do not ascend"),
        ("next_id", lambda a: a * 0, "next_id is among the ids in use"),
        ("next_id", lambda a: a + (1 << 61), "next_id is"),
        ("n_rebuilds", lambda a: a - 1000, "n_rebuilds is"),
        ("n_since_rebuild", lambda a: a[None], r"n_since_rebuild has shape \(1,\)"),
        ("clusters.counts", lambda a: a * 0, "clusters.counts holds values below 1"),
        ("clusters.counts", lambda a: a.astype(float), "has type float64, expected int64"),
        ("clusters.labels", lambda a: -a, "clusters.labels holds values below 0"),
        ("clusters.labels", lambda a: a[:, :1], "clusters.labels has shape"),
        ("reservoir.exemplar_patch", lambda a: a - 99, "exemplar_patch holds values below 0"),
        ("clusters.weight", lambda a: a * np.nan, "clusters.weight holds values that are negative"),
        ("reservoir.distortion", lambda a: a - 1, "reservoir.distortion holds values that are neg"),
        ("clusters.exemplars", lambda a: a * 2, "clusters.exemplars are not of length 1"),
        ("clusters.exemplars", lambda a: a[0], "clusters.exemplars has shape"),
        ("reservoir.exemplars", lambda a: a[:, 1:], "reservoir.exemplars has shape"),
        ("reservoir.ids", lambda a: a[0], "reservoir.ids is not a list"),
        ("surplus", lambda a: a[1:], "surplus has shape"),
        ("rises", lambda a: a + np.inf, "rises holds values that are not finite"),
    ],
)
def test_a_damaged_state_is_refused(name: str, change: Any, match: str) -> None:
    """Every array of a model file is checked before it is used."""
    state = model_of(stream(400)).state()
    if change is None:
        del state[name]
    else:
        state[name] = np.asarray(change(state[name]))

    with pytest.raises(ModelError, match=match):
        TwoScale.from_state(PARAMS, AFFINITY, state)
