"""Small models of clusters on two scales, and streams for them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.two_scale import Insertion, TwoScale
from mpap_cli.observations import Float32Array, IntArray
from mpap_cli.params import AffinityParams, StrapParams
from tests.clustering.blobs import N_DIMS, around, centers

AFFINITY = AffinityParams()


def stream(n: int, kinds: int, seed: int = 0, spread: float = 0.13) -> Float32Array:
    """Observations of so many kinds in any order, some of them too far out to fit."""
    rng = np.random.default_rng(seed)
    return around(centers(kinds)[rng.integers(0, kinds, n)], spread, rng)


def new_model(**params: Any) -> TwoScale:
    """Make a model with a small reservoir."""
    small = {"eps": 0.18, "reservoir": 40}
    return TwoScale(StrapParams(**{**small, **params}), AFFINITY, N_DIMS)


def add(model: TwoScale, points: Float32Array, start: int = 0) -> Insertion:
    """Add observations that come one nanosecond after the other, nine to an image."""
    at = np.arange(start, start + len(points))
    return model.add_observations(points, at, at % 9, log_index=1)


def filled(**params: Any) -> tuple[TwoScale, IntArray]:
    """Make a model with clusters and outliers; return it and the ids of its observations."""
    model = new_model(**params)
    return model, add(model, stream(500, 8)).ids


def assert_same_state(model: TwoScale, expected: dict[str, NDArray[Any]]) -> None:
    """All arrays are equal, bit for bit."""
    state = model.state()
    assert state.keys() == expected.keys()
    assert all(state[name].tobytes() == expected[name].tobytes() for name in expected)
