"""One collision model from the models of several logs."""

from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from mpap_cli.clustering.merging import merge_meta_points
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.distance import squared_distances
from mpap_cli.errors import ModelError, UsageError
from mpap_cli.observations import IntArray
from mpap_cli.params import settings_values
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.model_parts import CarriedVisits, ModelParts, recluster
from mpap_cli.systems.reading import fit_reading


def merge_models(models: Sequence[CollisionModel]) -> CollisionModel:
    """Merge models that were learnt with the same settings.

    Parameters
    ----------
    models : sequence of CollisionModel
        At least one, in any order: the result is the same.

    Returns
    -------
    CollisionModel
        Knows all counts and logs, the logs by their start; clustered once. The visits of
        a cluster go to the cluster of the merged cluster-point nearest to its exemplar.

    Raises
    ------
    ModelError
        If there is no model.
    UsageError
        If the settings differ; the message names the first that does.
    """
    if not models:
        msg = "merge: found no model, expected at least one"
        raise ModelError(msg)
    leaves = sorted((model.parts() for model in models), key=_order)
    _check_settings(leaves)
    before = accumulate((len(leaf.logs) for leaf in leaves), initial=0)
    log_maps = [np.arange(len(leaf.logs)) + n for leaf, n in zip(leaves, before, strict=False)]
    meta_points = merge_meta_points([leaf.meta_points for leaf in leaves], log_maps)
    settings = leaves[0].settings
    merged = ModelParts(
        settings=settings,
        meta_points=meta_points,
        clustered=recluster(meta_points, settings),
        contact_map=leaves[0].contact_map,
        alarm_odds=leaves[0].alarm_odds,
        carried=_carried(leaves, meta_points),
        logs=tuple(log for leaf in leaves for log in leaf.logs),
    )
    return CollisionModel(settings, fit_reading(merged))


def _order(parts: ModelParts) -> tuple[list[tuple[int, str, int]], bytes]:
    """Return a key that puts models in an order of their own, whatever order they came in."""
    logs = [(log.start_ns, log.name, log.end_ns) for log in parts.logs]
    return logs, parts.meta_points.exemplars.tobytes()


def _check_settings(leaves: Sequence[ModelParts]) -> None:
    """Refuse models whose settings differ from those of the first."""
    wanted = {"profile": leaves[0].settings.profile, **settings_values(leaves[0].settings)}
    for leaf in leaves[1:]:
        found = {"profile": leaf.settings.profile, **settings_values(leaf.settings)}
        for key, value in wanted.items():
            # the scanner may be mounted another way in each log; features count from ahead
            if key != "forward" and found[key] != value:
                names = [
                    parts.logs[0].name if parts.logs else "no log" for parts in (leaves[0], leaf)
                ]
                msg = (
                    f"merge: setting {key} is {value} in the model of {names[0]} and {found[key]} "
                    f"in that of {names[1]}; learn both with the same settings"
                )
                raise UsageError(msg)


def _carried(leaves: Sequence[ModelParts], merged: MetaPoints) -> CarriedVisits:
    """Give the visits of each old cluster to the cluster-point nearest to its exemplar."""
    cluster_points = np.flatnonzero(merged.is_cluster_point)
    references = merged.references()[cluster_points]
    ids: list[IntArray] = [np.empty(0, dtype=np.int64)]
    for leaf in leaves:
        rows = leaf.meta_points.rows_of(leaf.carried.ids)
        if rows.size:
            squared = squared_distances(leaf.meta_points.references()[rows], references)
            ids.append(merged.ids[cluster_points[squared.argmin(axis=1)]])
    found, place = np.unique(np.concatenate(ids), return_inverse=True)
    counts = np.zeros((found.size, 4), dtype=np.int64)
    np.add.at(counts, place, np.concatenate([leaf.carried.counts for leaf in leaves]))
    return CarriedVisits(found, counts)
