"""One set of meta-points from several that were built apart, as from one log each."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from mpap_cli.clustering.meta_point_rows.state import pack, unpack
from mpap_cli.clustering.meta_point_rows.tables import (
    CLUSTER_POINT,
    N_DROPPED,
    N_ROWS,
    NOISE_POINT,
    Rows,
    build_index,
    empty_rows,
    longest,
    means,
    recount,
    rules_of,
    widest_axes,
)
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.errors import ModelError
from mpap_cli.observations import BoolArray, IntArray
from mpap_cli.params import MetaPointParams
from mpap_cli.params.checks import key_of

_NEARER_MEANS, _NEARER_EXEMPLARS = 0.5, 0.9  # of theta: where two cluster-points are one


def merge_meta_points(
    leaves: Sequence[MetaPoints], log_maps: Sequence[IntArray] | None = None
) -> MetaPoints:
    """Merge meta-points; the order of the arguments does not matter.

    Parameters
    ----------
    leaves : sequence of MetaPoints
        All of the same settings; none of them itself a result of merging, since merging
        in groups is not the same as merging at once.
    log_maps : sequence of ndarray, optional
        For each leaf the new index of each of its logs; without it, indices stay.

    Returns
    -------
    MetaPoints
        With new ids. Label counts and numbers of points add up exactly.

    Raises
    ------
    ModelError
        If there is nothing to merge or the settings differ.

    Notes
    -----
    Meta-points are placed one after the other, cluster-points first, those with more
    points earlier. One that is within theta of a placed one joins the nearest; two
    cluster-points join only within 0.9 theta, or theta / 2 if distances go to means, which
    drift apart: so about as many of them are left as one history of all logs would have.
    What joined a cluster-point, or has got ``min_points`` points, is a cluster-point.
    """
    _check_alike(leaves)
    params, normalized = leaves[0].params, leaves[0].normalized
    parts = _sorted_parts(leaves, log_maps)
    rows, is_cluster_point = _merged(parts, params, normalized=normalized)
    is_cluster_point |= rows.point_count[: len(is_cluster_point)] >= params.min_points
    rows.kind[: len(is_cluster_point)] = np.where(is_cluster_point, CLUSTER_POINT, NOISE_POINT)
    recount(rows)
    rows.totals[N_DROPPED] = sum(leaf.n_dropped for leaf in leaves)
    _drop_surplus(rows, params.max_noise)
    return MetaPoints.from_state(params, pack(rows, normalized=normalized))


def _check_alike(leaves: Sequence[MetaPoints]) -> None:
    if not leaves:
        msg = "nothing to merge: name at least one model"
        raise ModelError(msg)
    first = leaves[0]
    for leaf in leaves[1:]:
        for item in fields(MetaPointParams):
            found, wanted = getattr(leaf.params, item.name), getattr(first.params, item.name)
            if found != wanted:
                key = key_of(item.name)
                msg = f"cannot merge: {key} is {wanted} and {found}; learn with one {key}"
                raise ModelError(msg)
        if (leaf.n_dims, leaf.normalized) != (first.n_dims, first.normalized):
            msg = f"cannot merge: points have {first.n_dims} and {leaf.n_dims} coordinates"
            raise ModelError(msg)


def _sorted_parts(leaves: Sequence[MetaPoints], log_maps: Sequence[IntArray] | None) -> Rows:
    """Return the meta-points of all leaves in an order that knows nothing of the leaves."""
    by_mean = leaves[0].params.reference == "mean"
    tables = [unpack(leaf.state(), by_mean=by_mean)[0] for leaf in leaves]
    for table, log_map in zip(tables, log_maps or [], strict=log_maps is not None):
        table.exemplar_log[:] = np.asarray(log_map)[table.exemplar_log]
    n = sum(len(table.kind) for table in tables)
    together, parts = (empty_rows(n, leaves[0].n_dims) for _ in range(2))
    names = set(Rows._fields) - {"totals"}
    for name in names:
        np.concatenate([getattr(table, name) for table in tables], out=getattr(together, name))
    order = sorted(range(n), key=lambda row: _sort_key(together, row))
    for name in names:
        getattr(parts, name)[:] = getattr(together, name)[order]
    return parts


def _sort_key(parts: Rows, row: int) -> tuple[int | bytes, ...]:
    """Cluster-points first, then many points, then early ones; the rest breaks ties."""
    return (
        -int(parts.kind[row]),
        -int(parts.point_count[row]),
        int(parts.first_ns[row]),
        parts.exemplars[row].tobytes(),
        parts.sums[row].tobytes(),
        int(parts.last_ns[row]),
        int(parts.exemplar_stamp_ns[row]),
        int(parts.exemplar_log[row]),
        parts.label_counts[row].tobytes(),
    )


def _merged(parts: Rows, params: MetaPointParams, *, normalized: bool) -> tuple[Rows, BoolArray]:
    """Place or join each part in turn; tell which rows hold a cluster-point."""
    from mpap_cli.clustering.meta_point_rows import _kernels  # noqa: PLC0415  # slow: numba

    n, d = parts.sums.shape
    rows = empty_rows(n, d)
    # every placed row is on one list, that of the noise-points, until all is done
    index = build_index(rows, widest_axes(parts.references) if n else np.zeros(0, np.int64))
    near = rules_of(params, normalized=normalized, length=longest(parts.references))
    share = _NEARER_MEANS if near.by_mean else _NEARER_EXEMPLARS
    nearer = near._replace(bound=near.bound * share**2)
    lower = np.empty(n, np.float32)
    is_cluster_point = np.zeros(n, np.bool_)
    for part, kind in enumerate(parts.kind):
        rules = nearer if kind == CLUSTER_POINT else near
        point = parts.references[part]
        row = _kernels.nearest(
            index.near, index.members, NOISE_POINT, rows.totals[NOISE_POINT], index.axes,
            rows.references, point, rules, lower,
        )  # fmt: skip
        if row >= 0:
            _join(rows, row, parts, part)
            if rules.by_mean:
                one = slice(row, row + 1)
                mean = means(rows.sums[one], rows.point_count[one], normalized=normalized)
                rows.references[one] = mean
            slot = index.slot[row]
            _kernels.locate(
                index.near,
                index.copies,
                index.halves,
                NOISE_POINT,
                slot,
                index.axes,
                rows.references,
                row,
            )
        else:
            row = _kernels.create_row(rows, parts.first_ns[part])
            _place(rows, row, parts, part)
            _kernels.enlist(rows, index, NOISE_POINT, row)
        is_cluster_point[row] |= kind == CLUSTER_POINT
    return rows, is_cluster_point[: rows.totals[N_ROWS]]


def _place(rows: Rows, row: int, parts: Rows, part: int) -> None:
    """Copy a part into a row of its own; the row keeps its new id."""
    for name in set(Rows._fields) - {"totals", "kind", "ids"}:
        getattr(rows, name)[row] = getattr(parts, name)[part]


def _join(rows: Rows, row: int, parts: Rows, part: int) -> None:
    """Add a part to a row, which keeps its exemplar."""
    for name in ("sums", "point_count", "label_counts"):
        getattr(rows, name)[row] += getattr(parts, name)[part]
    rows.first_ns[row] = min(rows.first_ns[row], parts.first_ns[part])
    rows.last_ns[row] = max(rows.last_ns[row], parts.last_ns[part])


def _drop_surplus(rows: Rows, max_noise: int) -> None:
    """Drop noise-points until no more than allowed are left."""
    from mpap_cli.clustering.meta_point_rows import _kernels  # noqa: PLC0415  # slow: numba

    index = build_index(rows, np.zeros(0, np.int64))
    while rows.totals[NOISE_POINT] > max_noise:
        _kernels.drop_oldest(rows, index)
