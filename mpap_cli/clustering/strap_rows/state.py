"""STRAP as plain arrays for a model file, and back with every value checked."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.counted import MOST_COUNTED, are_counts
from mpap_cli.clustering.strap_rows.arrays import COLUMNS, Items
from mpap_cli.errors import ModelError
from mpap_cli.observations import Float64Array

_LONG, _SHORT = "clusters.", "reservoir."
_COUNTERS = ("next_id", "n_since_rebuild", "n_outliers_ever", "n_rebuilds")
_TESTS = ("surplus", "rises")
_LARGEST = 1e100  # the square of it is finite
LENGTH_TOLERANCE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class StrapParts:
    """Everything that STRAP knows; ``surplus`` and ``rises`` (4,) are states of its tests."""

    clusters: Items
    reservoir: Items
    surplus: Float64Array
    rises: Float64Array
    next_id: int
    n_since_rebuild: int
    n_outliers_ever: int
    n_rebuilds: int


def pack(parts: StrapParts) -> dict[str, NDArray[Any]]:
    """Return the parts as arrays that share nothing with them."""
    state: dict[str, NDArray[Any]] = {
        prefix + name: np.array(column)
        for prefix, items in ((_LONG, parts.clusters), (_SHORT, parts.reservoir))
        for name, column in items._asdict().items()
    }
    state |= {name: np.array(getattr(parts, name), np.int64) for name in _COUNTERS}
    return state | {name: np.array(getattr(parts, name)) for name in _TESTS}


def unpack(state: Mapping[str, NDArray[Any]]) -> StrapParts:
    """Return the parts of a state.

    Raises
    ------
    ModelError
        If an array is missing or its shape, type or values cannot be.
    """
    _check(state)
    clusters, reservoir = (
        Items._make(np.array(state[prefix + name]) for name in Items._fields)
        for prefix in (_LONG, _SHORT)
    )
    _check_items(clusters, _LONG)
    _check_items(reservoir, _SHORT)
    counters = {name: int(state[name]) for name in _COUNTERS}
    ids = np.concatenate([clusters.ids, reservoir.ids])
    _require(bool((np.diff(ids) > 0).all()), "ids", "do not ascend")
    _require(counters["next_id"] > ids.max(initial=-1), "next_id", "is among the ids in use")
    surplus, rises = (np.array(state[name]) for name in _TESTS)
    return StrapParts(clusters, reservoir, surplus, rises, **counters)


def _check(state: Mapping[str, NDArray[Any]]) -> None:
    """Raise ModelError unless all arrays are there, of the right types and shapes."""
    kinds = {prefix + name: kind for prefix in (_LONG, _SHORT) for name, kind in COLUMNS.items()}
    kinds |= {**dict.fromkeys(_COUNTERS, "i8"), **dict.fromkeys(_TESTS, "f8")}
    for name, kind in kinds.items():
        _require(name in state, name, "is missing")
        found = state[name].dtype
        _require(found == np.dtype(kind), name, f"has type {found}, expected {np.dtype(kind)}")
    shapes: dict[str, tuple[int, ...]] = dict.fromkeys(_COUNTERS, ())
    shapes |= dict.fromkeys(_TESTS, (4,))
    n_dims = state[_LONG + "exemplars"].shape[-1:]
    for prefix in (_LONG, _SHORT):
        _require(state[prefix + "ids"].ndim == 1, prefix + "ids", "is not a list")
        n = state[prefix + "ids"].shape
        shapes |= dict.fromkeys((prefix + name for name in COLUMNS), n)
        shapes |= {prefix + "labels": (*n, 2), prefix + "exemplars": (*n, *n_dims)}
    for name, wanted in shapes.items():
        _require(state[name].shape == wanted, name, f"has shape {state[name].shape}, not {wanted}")
    for name in _TESTS:
        _require(bool(np.isfinite(state[name]).all()), name, "holds values that are not finite")
    for name in _COUNTERS:
        _require(0 <= int(state[name]) < MOST_COUNTED, name, f"is {state[name]}")


def _check_items(items: Items, prefix: str) -> None:
    """Raise ModelError if a value cannot be one of clusters or outliers."""
    for name, lowest in (("counts", 1), ("labels", 0)):
        holds = are_counts(getattr(items, name), lowest)
        _require(holds, prefix + name, f"holds values below {lowest} or beyond all counting")
    for name in ("ids", "exemplar_log", "exemplar_patch"):
        _require(bool((getattr(items, name) >= 0).all()), prefix + name, "holds values below 0")
    for name in ("weight", "distortion"):
        column = getattr(items, name)
        good = bool(((column >= 0) & (column <= _LARGEST)).all())
        _require(good, prefix + name, "holds values that are negative or not finite, or too large")
    off = np.abs(np.square(items.exemplars, dtype=np.float64).sum(axis=1) - 1.0)
    _require(bool((off < LENGTH_TOLERANCE).all()), prefix + "exemplars", "are not of length 1")


def _require(holds: bool, name: str, text: str) -> None:
    if not holds:
        msg = f"appearance clusters: array {name} {text}; the model is damaged, learn it again"
        raise ModelError(msg)
