"""What a collision model is made of, and its form as arrays and a header for a file."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.counted import are_counts
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.errors import ModelError
from mpap_cli.observations import Clustering, Float64Array, IntArray
from mpap_cli.params import TARGETS, Settings
from mpap_cli.properties.contact_map import ContactMap
from mpap_cli.properties.counts import ClusteredPoints
from mpap_cli.properties.visits import Visits
from mpap_cli.systems.labelling import LogSource
from mpap_cli.systems.model_arrays import are_within, make_header, read_array, read_header

KIND = "mpap collision model"
VERSION = 2
_META = "meta_points."
_FIGURES = ("damping", "net_similarity", "preference", "slope", "offset")
_LENGTH_TOLERANCE = 1e-3


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

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays for a file; :meth:`read` is the inverse."""
        return {"visits.ids": self.ids, "visits.counts": self.counts}

    @classmethod
    def read(cls, arrays: Mapping[str, NDArray[Any]]) -> "CarriedVisits":
        """Return those of a file; ModelError if an array is missing or of another shape."""
        ids = read_array(arrays, "visits.ids", (None,))
        return cls(ids, read_array(arrays, "visits.counts", (None, 4)))


@dataclass(frozen=True, slots=True, eq=False)
class ModelParts:
    """Everything that a collision model knows between two logs.

    From the ``alarm_odds`` (3,) of each pair of counts an alarm begins, NaN: none does.
    """

    settings: Settings
    meta_points: MetaPoints
    clustered: ClusteredPoints
    contact_map: ContactMap
    alarm_odds: Float64Array
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
    alarm_odds = np.full(len(TARGETS), np.nan)
    return ModelParts(settings, meta_points, clustered, ContactMap(), alarm_odds, carried, ())


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
    arrays = {
        "clustering.ids": parts.clustered.ids,
        "clustering.exemplars": clustering.exemplars,
        "clustering.labels": clustering.labels,
        "clustering.figures": np.array(figures, dtype=np.float64),
        "alarm_odds": parts.alarm_odds,
        **parts.carried.arrays(),
    }
    arrays |= {_META + name: array for name, array in parts.meta_points.state().items()}
    return ModelState(make_header(KIND, VERSION, parts.settings, parts.logs, clustering), arrays)


def unpack(state: ModelState) -> ModelParts:
    """Build a model from a header and arrays that are not trusted.

    Raises
    ------
    ModelError
        If a part is missing, of another version, or does not fit the others.
    """
    arrays = state.arrays
    header = read_header(state.header, KIND, VERSION)
    figures = read_array(arrays, "clustering.figures", (len(_FIGURES),), np.float64)
    damping, net_similarity, preference, slope, offset = figures.tolist()
    clustering = Clustering(
        read_array(arrays, "clustering.exemplars", (None,)),
        read_array(arrays, "clustering.labels", (None,)),
        header.n_iter,
        header.converged,
        damping,
        net_similarity,
        preference,
    )
    parts = ModelParts(
        header.settings,
        MetaPoints.from_state(header.settings.meta_point, _meta_point_arrays(arrays)),
        ClusteredPoints(clustering, read_array(arrays, "clustering.ids", (None,))),
        ContactMap(slope, offset),
        read_array(arrays, "alarm_odds", (len(TARGETS),), np.float64),
        CarriedVisits.read(arrays),
        header.logs,
    )
    _check(parts)
    return parts


def _meta_point_arrays(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {name[len(_META) :]: array for name, array in arrays.items() if name.startswith(_META)}


def _check(parts: ModelParts) -> None:
    """Check that clusters, visits, logs and the map fit the meta-points."""
    points, ids = parts.meta_points, parts.clustered.ids
    clustering, carried = parts.clustered.clustering, parts.carried
    n_clusters, n_logs = parts.clustered.n_clusters, len(parts.logs)
    rows = points.rows_of(ids)
    ascend = are_within(clustering.exemplars, ids.size) and bool(
        (np.diff(clustering.exemplars) > 0).all()
    )
    slope_offset = (parts.contact_map.slope, parts.contact_map.offset)
    off = np.abs(np.square(points.exemplars, dtype=np.float64).sum(axis=1) - 1.0)
    checks = {
        "meta_points.normalised": points.normalized and (off < _LENGTH_TOLERANCE).all(),
        "clustering.ids": (np.diff(ids) > 0).all()
        and (rows >= 0).all()
        and points.is_cluster_point[rows].all(),
        "clustering.exemplars": ascend,
        "clustering.labels": clustering.labels.size == ids.size
        and ascend
        and are_within(clustering.labels, n_clusters)
        and np.array_equal(clustering.labels[clustering.exemplars], np.arange(n_clusters)),
        "clustering.figures": np.isfinite(slope_offset).all() and slope_offset[0] > 0,
        "alarm_odds": not (parts.alarm_odds < 0).any(),
        "visits.ids": carried.ids.size == carried.counts.shape[0]
        and np.isin(carried.ids, ids).all(),
        "visits.counts": are_counts(carried.counts),
        "logs": are_within(points.exemplar_log, n_logs),
    }
    for name, holds in checks.items():
        if not holds:
            msg = f"model: {name} does not fit its meta-points; learn it again"
            raise ModelError(msg)
