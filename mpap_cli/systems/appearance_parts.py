"""What an appearance model is made of, and its form as arrays and a header for a file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.clustering.counted import are_counts
from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.errors import ModelError
from mpap_cli.observations import Clustering, IntArray
from mpap_cli.params import Settings
from mpap_cli.properties.counts import ClusteredPoints
from mpap_cli.systems.labelling import LogSource
from mpap_cli.systems.model_arrays import are_within, make_header, read_array, read_header
from mpap_cli.systems.model_parts import CarriedVisits, ModelState

KIND = "mpap appearance model"
VERSION = 1
_STRAP = "strap."
_FIGURES = ("damping", "net_similarity", "preference")


@dataclass(frozen=True, slots=True, eq=False)
class AppearanceParts:
    """Everything that an appearance model knows between two logs.

    ``coarse`` are clusters of the long-term exemplars as they are after ``n_rebuilds``.
    """

    settings: Settings
    two_scale: TwoScale
    coarse: ClusteredPoints
    n_rebuilds: int
    carried: CarriedVisits
    logs: tuple[LogSource, ...]

    def coarse_of(self, ids: IntArray) -> IntArray:
        """Return the coarse clusters of patches by their ids (n,), -1 where they have none."""
        return self.coarse.clusters_of(self.two_scale.current_ids(ids))

    def carried_now(self) -> CarriedVisits:
        """Return the carried visits with the ids that their clusters have now."""
        return CarriedVisits(self.two_scale.current_ids(self.carried.ids), self.carried.counts)


def new_parts(settings: Settings, n_dims: int) -> AppearanceParts:
    """Return a model that knows nothing of patches with ``n_dims`` coordinates."""
    two_scale = TwoScale(settings.strap, settings.affinity, n_dims)
    nothing = np.empty(0, dtype=np.int64)
    carried = CarriedVisits(nothing, np.empty((0, 4), dtype=np.int64))
    return AppearanceParts(settings, two_scale, cluster_coarsely(two_scale), 0, carried, ())


def cluster_coarsely(two_scale: TwoScale) -> ClusteredPoints:
    """Run affinity propagation over the long-term exemplars (section 4.2.4)."""
    return ClusteredPoints(two_scale.coarse(), two_scale.ids)


def pack(parts: AppearanceParts) -> ModelState:
    """Turn a model into a header and arrays; :func:`unpack` is the exact inverse."""
    clustering = parts.coarse.clustering
    figures = [getattr(clustering, name) for name in _FIGURES]
    arrays = {
        "coarse.exemplars": clustering.exemplars,
        "coarse.labels": clustering.labels,
        "coarse.figures": np.array(figures, dtype=np.float64),
        **parts.carried.arrays(),
    }
    arrays |= {_STRAP + name: array for name, array in parts.two_scale.state().items()}
    return ModelState(make_header(KIND, VERSION, parts.settings, parts.logs, clustering), arrays)


def unpack(state: ModelState) -> AppearanceParts:
    """Build a model from a header and arrays that are not trusted.

    Raises
    ------
    ModelError
        If a part is missing, of another version, or does not fit the others.
    """
    arrays = state.arrays
    header = read_header(state.header, KIND, VERSION)
    figures = read_array(arrays, "coarse.figures", (len(_FIGURES),), np.float64)
    clustering = Clustering(
        read_array(arrays, "coarse.exemplars", (None,)),
        read_array(arrays, "coarse.labels", (None,)),
        header.n_iter,
        header.converged,
        **dict(zip(_FIGURES, figures.tolist(), strict=True)),
    )
    settings = header.settings
    two_scale = TwoScale.from_state(settings.strap, settings.affinity, _strap_arrays(arrays))
    carried = CarriedVisits.read(arrays)
    coarse = ClusteredPoints(clustering, two_scale.ids)
    parts = AppearanceParts(settings, two_scale, coarse, two_scale.n_rebuilds, carried, header.logs)
    _check(parts, arrays)
    return parts


def _strap_arrays(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {name[len(_STRAP) :]: array for name, array in arrays.items() if name.startswith(_STRAP)}


def _check(parts: AppearanceParts, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Check that coarse clusters, visits, logs and patches fit the exemplars."""
    clustering, carried = parts.coarse.clustering, parts.carried
    rows, columns = parts.settings.image.rows_columns()
    n_exemplars = parts.two_scale.n_clusters
    ascend = are_within(clustering.exemplars, n_exemplars) and bool(
        (np.diff(clustering.exemplars) > 0).all()
    )
    checks = {
        "coarse.exemplars": ascend,
        "coarse.labels": clustering.labels.size == n_exemplars
        and ascend
        and are_within(clustering.labels, parts.coarse.n_clusters)
        and np.array_equal(
            clustering.labels[clustering.exemplars], np.arange(parts.coarse.n_clusters)
        ),
        "visits.ids": carried.ids.size == carried.counts.shape[0]
        and np.isin(carried.ids, parts.coarse.ids).all(),
        "visits.counts": are_counts(carried.counts),
    }
    for items in ("clusters.", "reservoir."):
        name = _STRAP + items + "exemplar_"
        checks[name + "log"] = are_within(arrays[name + "log"], len(parts.logs))
        checks[name + "patch"] = are_within(arrays[name + "patch"], rows * columns)
    for name, holds in checks.items():
        if not holds:
            msg = f"model: {name} does not fit its exemplars; learn it again"
            raise ModelError(msg)
