"""Logs that models meet: what each observation is to them, while they learn on."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.commands.inputs.common_sensors import common_sensors
from mpap_cli.commands.inputs.models import Models
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Source
from mpap_cli.commands.learning.models_in_progress import note_images
from mpap_cli.observations import BoolArray, Float32Array, IntArray
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.obstacles import KnownExemplars


@dataclass(frozen=True, slots=True, eq=False)
class Met:
    """What n scans or images were to the model that learnt them, k observations in each.

    ``features`` (n, k, d) are embedded; ``ids`` (n, k) are those of what took them in;
    ``novel`` (n, k) tells which were new as they came, ``unknown`` (n, k) which the model did
    not know as the log began (None: it knew nothing). ``n_clusters`` there are after them.
    """

    stamps_ns: IntArray
    features: Float32Array
    ids: IntArray
    novel: BoolArray
    unknown: BoolArray | None
    n_clusters: int


def sensor_to_meet(selection: LogSelection, models: Models) -> str:
    """Return image if every log (and the model) has images, or not every one has scans."""
    if models.sensor in {"scan", "image"}:
        return models.sensor
    shared = common_sensors(selection)
    return "scan" if "scan" in shared and "image" not in shared else "image"


def meet(
    models: Models, source: Source, sensor: str, jobs: int, progress: Progress
) -> Iterator[Met]:
    """Learn one log, from its first message to its last, and tell what was new in it.

    Parameters
    ----------
    models : Models
        The model of the sensor learns on, or is made.
    source : Source
        An opened log.
    sensor : str
        image or scan.
    jobs : int
        2 or more: reading runs in a thread of its own.
    progress : Progress
        Told how far the log is.
    """
    if sensor == "image":
        return _meet_images(models, source, jobs, progress)
    return _meet_scans(models, source, jobs, progress)


def _meet_images(models: Models, source: Source, jobs: int, progress: Progress) -> Iterator[Met]:
    """Learn the images of one log."""
    model = models.appearance = models.appearance or AppearanceModel(models.settings)
    known = model.known()
    model.begin_log(source.start)
    for batch, patches in follow(source, jobs, progress, "meet", model.embed):
        if patches is None:
            continue
        unknown = known.unknown(patches.features) if known.features.size else None
        learnt = model.learn(patches)
        model.settle(batch.bumps, batch.poses, batch.until_ns)
        n_clusters = model.two_scale.n_clusters
        yield Met(
            patches.stamps_ns,
            patches.features,
            learnt.ids,
            learnt.outlier,
            unknown,
            n_clusters,
        )
    model.end_log(source.replay.end_ns)
    note_images(source, model)


def _meet_scans(models: Models, source: Source, jobs: int, progress: Progress) -> Iterator[Met]:
    """Learn the scans of one log."""
    model = models.collision = models.collision or CollisionModel(models.settings)
    known = known_scans(model.meta_points)
    model.begin_log(source.start)
    for batch, _ in follow(source, jobs, progress, "meet"):
        for learnt in model.observe(batch):
            unknown = known.unknown(learnt.features.features) if known.features.size else None
            yield Met(
                learnt.features.stamps_ns,
                learnt.features.features[:, None],
                learnt.ids[:, None],
                learnt.cases[:, None] > 1,
                None if unknown is None else unknown[:, None],
                int(model.meta_points.is_cluster_point.sum()),
            )
    model.end_log(source.replay.end_ns)


def known_scans(points: MetaPoints) -> KnownExemplars:
    """Return what meta-points of scans explain now: all within theta of a cluster-point."""
    references = points.references()[points.is_cluster_point].astype(np.float32)
    return KnownExemplars(references, points.params.theta)
