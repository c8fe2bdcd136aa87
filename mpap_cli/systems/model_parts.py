"""What a collision model is made of, and its form as arrays and a header for a file."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.errors import ModelError, SettingError
from mpap_cli.observations import Clustering, IntArray
from mpap_cli.params import Settings, make_settings, settings_values
from mpap_cli.properties.contact_map import ContactMap
from mpap_cli.properties.counts import ClusteredPoints
from mpap_cli.properties.visits import Visits
from mpap_cli.systems.labelling import LogSource

KIND = "mpap collision model"
VERSION = 1
_META = "meta_points."
_FIGURES = ("damping", "net_similarity", "preference", "slope", "offset")


@dataclass(frozen=True, slots=True, eq=False)
class CarriedVisits:
    """Visits (k, 4) of earlier clusters, each kept with the id (k,) of its exemplar.

    The columns are those of :class:`Visits`: visits, positive, negative, presses.
    """

    ids: IntArray
    counts: IntArray

    @classmethod
    def of(cls, visits: Visits, clustered: ClusteredPoints) -> "CarriedVisits":
        """Keep the visits of clusters with their exemplars."""
        columns = [getattr(visits, item.name) for item in fields(Visits)]
        ids = clustered.ids[clustered.clustering.exemplars]
        return cls(ids, np.stack(columns, axis=1))

    def visits(self, clustered: ClusteredPoints) -> Visits:
        """Sum them up over the clusters that the exemplars now belong to."""
        sums = np.zeros((clustered.n_clusters, 4), dtype=np.int64)
        cluster = clustered.clusters_of(self.ids)
        np.add.at(sums, cluster[cluster >= 0], self.counts[cluster >= 0])
        return Visits(*sums.T)


@dataclass(frozen=True, slots=True, eq=False)
class ModelParts:
    """Everything that a collision model knows between two logs."""

    settings: Settings
    meta_points: MetaPoints
    clustered: ClusteredPoints
    contact_map: ContactMap
    carried: CarriedVisits
    logs: tuple[LogSource, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ModelState:
    """A model as a file holds it: a header for JSON and arrays by name."""

    header: dict[str, Any]
    arrays: dict[str, NDArray[Any]]


def new_parts(settings: Settings, n_dims: int) -> ModelParts:
    """Return a model that knows nothing of observations with ``n_dims`` coordinates."""
    meta_points = MetaPoints(settings.meta_point, n_dims)
    nothing = np.empty(0, dtype=np.int64)
    carried = CarriedVisits(nothing, np.empty((0, 4), dtype=np.int64))
    clustered = recluster(meta_points, settings)
    return ModelParts(settings, meta_points, clustered, ContactMap(), carried, ())


def recluster(meta_points: MetaPoints, settings: Settings) -> ClusteredPoints:
    """Run affinity propagation over the cluster-points (section 3.4)."""
    clustering = meta_points.cluster(settings.affinity)
    return ClusteredPoints(clustering, meta_points.ids[meta_points.is_cluster_point])


def pack(parts: ModelParts) -> ModelState:
    """Turn a model into a header and arrays; :func:`unpack` is the exact inverse."""
    clustering = parts.clustered.clustering
    figures = (
        clustering.damping,
        clustering.net_similarity,
        clustering.preference,
        parts.contact_map.slope,
        parts.contact_map.offset,
    )
    header = {
        "kind": KIND,
        "version": VERSION,
        "profile": parts.settings.profile,
        "settings": settings_values(parts.settings),
        "logs": [asdict(log) for log in parts.logs],
        "n_iter": clustering.n_iter,
        "converged": clustering.converged,
    }
    arrays = {
        "clustering.ids": parts.clustered.ids,
        "clustering.exemplars": clustering.exemplars,
        "clustering.labels": clustering.labels,
        "clustering.figures": np.array(figures, dtype=np.float64),
        "visits.ids": parts.carried.ids,
        "visits.counts": parts.carried.counts,
    }
    arrays |= {_META + name: array for name, array in parts.meta_points.state().items()}
    return ModelState(header, arrays)


def unpack(state: ModelState) -> ModelParts:
    """Build a model from a header and arrays that are not trusted.

    Raises
    ------
    ModelError
        If a part is missing, of another version, or does not fit the others.
    """
    header, arrays = state.header, state.arrays
    if header.get("kind") != KIND or header.get("version") != VERSION:
        found = f"{header.get('kind')!r} version {header.get('version')!r}"
        msg = f"model: found {found}, expected {KIND!r} version {VERSION}; learn it again"
        raise ModelError(msg)
    try:
        settings = make_settings(header["profile"], header["settings"])
        logs = tuple(_log_source(log) for log in header["logs"])
        n_iter, converged = int(header["n_iter"]), bool(header["converged"])
    except (KeyError, TypeError, ValueError, AttributeError, SettingError) as err:
        msg = f"model: its header does not fit this version ({err!r}); learn it again"
        raise ModelError(msg) from err
    figures = _array(arrays, "clustering.figures", (len(_FIGURES),), np.float64)
    damping, net_similarity, preference, slope, offset = figures.tolist()
    clustering = Clustering(
        _array(arrays, "clustering.exemplars", (None,)),
        _array(arrays, "clustering.labels", (None,)),
        n_iter,
        converged,
        damping,
        net_similarity,
        preference,
    )
    parts = ModelParts(
        settings,
        MetaPoints.from_state(settings.meta_point, _meta_point_arrays(arrays)),
        ClusteredPoints(clustering, _array(arrays, "clustering.ids", (None,))),
        ContactMap(slope, offset),
        CarriedVisits(
            _array(arrays, "visits.ids", (None,)), _array(arrays, "visits.counts", (None, 4))
        ),
        logs,
    )
    _check(parts)
    return parts


def _log_source(log: Mapping[str, Any]) -> LogSource:
    n_presses = log["n_presses"]
    return LogSource(
        name=str(log["name"]),
        start_ns=int(log["start_ns"]),
        end_ns=int(log["end_ns"]),
        n_scans=int(log["n_scans"]),
        n_presses=None if n_presses is None else int(n_presses),
        bump_source=str(log["bump_source"]),
    )


def _meta_point_arrays(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {name[len(_META) :]: array for name, array in arrays.items() if name.startswith(_META)}


def _array(
    arrays: Mapping[str, NDArray[Any]],
    name: str,
    shape: tuple[int | None, ...],
    dtype: type[np.generic] = np.int64,
) -> NDArray[Any]:
    """Return one array of the file if it has the shape (None: any) and dtype."""
    array = arrays.get(name)
    if array is None:
        msg = f"model: no array {name} in it; learn it again"
        raise ModelError(msg)
    sizes_fit = len(shape) == array.ndim and all(
        wanted in (None, found) for wanted, found in zip(shape, array.shape, strict=True)
    )
    if not sizes_fit or array.dtype != dtype:
        msg = f"model: {name} is {array.dtype} {array.shape}, expected {shape}; learn it again"
        raise ModelError(msg)
    return array


def _check(parts: ModelParts) -> None:
    """Check that clusters, visits, logs and the map fit the meta-points."""
    points, ids = parts.meta_points, parts.clustered.ids
    clustering, carried = parts.clustered.clustering, parts.carried
    n_clusters, n_logs = parts.clustered.n_clusters, len(parts.logs)
    rows = points.rows_of(ids)
    slope_offset = (parts.contact_map.slope, parts.contact_map.offset)
    checks = {
        "clustering.ids": (np.diff(ids) > 0).all()
        and (rows >= 0).all()
        and points.is_cluster_point[rows].all(),
        "clustering.exemplars": _within(clustering.exemplars, ids.size)
        and (np.diff(clustering.exemplars) > 0).all(),
        "clustering.labels": clustering.labels.size == ids.size
        and _within(clustering.labels, n_clusters),
        "clustering.figures": np.isfinite(slope_offset).all() and slope_offset[0] > 0,
        "visits.ids": carried.ids.size == carried.counts.shape[0]
        and np.isin(carried.ids, ids).all(),
        "visits.counts": (carried.counts >= 0).all(),
        "logs": _within(points.exemplar_log, n_logs),
    }
    for name, holds in checks.items():
        if not holds:
            msg = f"model: {name} does not fit its meta-points; learn it again"
            raise ModelError(msg)


def _within(indices: IntArray, size: int) -> bool:
    return bool(((indices >= 0) & (indices < size)).all())
