"""Meta-points as plain arrays for a model file, and back with every value checked."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.counted import are_counts
from mpap_cli.clustering.meta_point_rows.tables import (
    CLUSTER_POINT,
    N_DROPPED,
    N_ROWS,
    NEXT_ID,
    NOISE_POINT,
    Rows,
    empty_rows,
    kept_rows,
    means,
    recount,
)
from mpap_cli.errors import ModelError

_TABLES = {
    "ids": "i8",
    "point_count": "i8",
    "first_ns": "i8",
    "last_ns": "i8",
    "exemplar_stamp_ns": "i8",
    "exemplar_log": "i8",
    "label_counts": "i8",
    "sums": "f8",
    "exemplars": "f4",
}
# squares of these are finite
_LARGEST_VALUE = 1e18
_LARGEST_SUM = 1e100
# "normalised" is spelled as it stands in model files
_OTHERS = {"is_cluster_point": "b1", "next_id": "i8", "n_dropped": "i8", "normalised": "b1"}


def pack(rows: Rows, *, normalized: bool) -> dict[str, NDArray[Any]]:
    """Return the kept rows as arrays that share nothing with them."""
    kept = kept_rows(rows)
    state = {name: getattr(rows, name)[kept] for name in _TABLES}
    state["is_cluster_point"] = rows.kind[kept] == CLUSTER_POINT
    state["next_id"] = np.array(rows.totals[NEXT_ID])
    state["n_dropped"] = np.array(rows.totals[N_DROPPED])
    state["normalised"] = np.array(normalized)
    return state


def unpack(state: Mapping[str, NDArray[Any]], *, by_mean: bool) -> tuple[Rows, bool]:
    """Return the rows of a state and whether their points are normalized.

    Raises
    ------
    ModelError
        If an array is missing or its shape, type or values cannot be.
    """
    _check(state)
    n, d = state["exemplars"].shape
    normalized = bool(state["normalised"])
    rows = empty_rows(n, d)
    for name in _TABLES:
        getattr(rows, name)[:] = state[name]
    rows.kind[:] = np.where(state["is_cluster_point"], CLUSTER_POINT, NOISE_POINT)
    rows.totals[N_ROWS] = n
    rows.totals[NEXT_ID] = state["next_id"]
    rows.totals[N_DROPPED] = state["n_dropped"]
    recount(rows)
    exact_means = means(rows.sums, rows.point_count, normalized=normalized)
    rows.references[:] = exact_means if by_mean else rows.exemplars
    return rows, normalized


def _check(state: Mapping[str, NDArray[Any]]) -> None:
    """Raise ModelError unless the arrays can be the state of meta-points."""
    for name, kind in {**_TABLES, **_OTHERS}.items():
        _require(name in state, name, "is missing")
        found = state[name].dtype
        _require(found == np.dtype(kind), name, f"has type {found}, expected {np.dtype(kind)}")
    _require(state["exemplars"].ndim == 2, "exemplars", "is not a matrix")  # noqa: PLR2004
    n, d = state["exemplars"].shape
    shapes: dict[str, tuple[int, ...]] = {
        "sums": (n, d),
        "exemplars": (n, d),
        "label_counts": (n, 3, 2),
    }
    shapes |= dict.fromkeys(("next_id", "n_dropped", "normalised"), ())
    for name in {**_TABLES, **_OTHERS}:
        wanted = shapes.get(name, (n,))
        _require(state[name].shape == wanted, name, f"has shape {state[name].shape}, not {wanted}")
    ids, next_id = state["ids"], int(state["next_id"])
    for name, most in (("sums", _LARGEST_SUM), ("exemplars", _LARGEST_VALUE)):
        fits = bool((np.abs(state[name]) <= most).all())
        _require(fits, name, "holds values that are not finite, or too large")
    for name, least in (("point_count", 1), ("label_counts", 0), ("n_dropped", 0), ("next_id", 0)):
        fits = are_counts(state[name], least)
        _require(fits, name, f"holds values below {least} or beyond all counting")
    _require(bool((ids >= 0).all()), "ids", "holds values below 0")
    _require(bool((np.diff(ids) > 0).all()), "ids", "do not ascend")
    _require(next_id > ids.max(initial=-1), "next_id", "is among the ids in use")


def _require(holds: bool, name: str, text: str) -> None:
    if not holds:
        msg = f"meta-points: array {name} {text}; the model is damaged, learn it again"
        raise ModelError(msg)
