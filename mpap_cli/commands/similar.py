"""``similar``: the moments a model remembers that look most like another one."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.models import Models, load_models
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, Source, open_readable, open_sources
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.remembering import Moment, SimilarRow, nearest_moments
from mpap_cli.logs.times import parse_time
from mpap_cli.observations import NS_PER_S, Float32Array
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import describe_input
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel

_BEFORE_S, _AFTER_S = 6.0, 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarRequest:
    """Where results go, how many moments are wanted, and how far they lie apart."""

    model: Path
    at: str
    out: Path
    count: int = 10
    apart_s: float = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Similar:
    """The moments found, the nearest first; ``seen`` is the one that was asked for."""

    folder: Path
    sensor: str
    seen: Moment
    rows: list[SimilarRow]
    exit_code: int = 0


def similar(selection: LogSelection, request: SimilarRequest) -> Similar:
    """Find the earlier moments that look most like one of a log.

    Parameters
    ----------
    selection : LogSelection
        How logs are read; its ``logs`` and times are those of ``request.at``.
    request : SimilarRequest
        The model, and the moment as ``LOG@TIME``.

    Returns
    -------
    Similar
        Exemplars of the model by their distance to the scan, or to the nearest patch of the
        image, of that moment; of the same log only what came before it.

    Raises
    ------
    UsageError
        If the moment is not ``LOG@TIME`` or holds no observation, or the model knows nothing
        of that sensor.
    ModelError
        If the model cannot be used.
    LogError
        If the log cannot be read.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    models = load_models(request.model)
    sensor = _sensor(models, selection.sensor)
    path, at_s = _moment(request.at, selection)
    start_s = max(0.0, at_s - _BEFORE_S)
    selection = replace(
        selection,
        logs=(path,),
        sensor=sensor,
        start=f"{start_s:.9f}",
        end=f"{at_s + _AFTER_S:.9f}",
    )
    losses = Losses()
    with one_thread_each(), ResultsFolder(request.out, "similar") as results:
        for source in open_sources(selection, models.settings, losses):
            wanted_ns = source.start.start_ns + round(at_s * NS_PER_S)
            seen, features = _look(models, source, sensor, wanted_ns)
            inputs = [describe_input(source.path), describe_input(find_model(request.model))]
        moments, known = _remembered(models, sensor)
        rows = nearest_moments(moments, known, seen, features, request.count, request.apart_s)
        write_csv(results.path("similar.csv"), SimilarRow, rows)
        values = selection.values(models.settings)
        values |= {"count": request.count, "apart": request.apart_s}
        results.commit(values, inputs, models.settings.affinity.seed)
    redraw(request.out)
    return Similar(
        folder=results.folder, sensor=sensor, seen=seen, rows=rows, exit_code=losses.exit_code
    )


def _sensor(models: Models, wanted: str) -> str:
    """Return the sensor to look with: the one asked for, or scans before images."""
    known = {"scan": models.collision, "image": models.appearance}
    for sensor in ("scan", "image") if wanted == "auto" else (wanted,):
        if known[sensor] is not None:
            return sensor
    msg = f"similar: the model knows nothing of {wanted}s; leave out --sensor"
    raise UsageError(msg)


def _moment(text: str, selection: LogSelection) -> tuple[str, float]:
    """Return the log and the seconds since its first message."""
    path, sign, time = text.rpartition("@")
    if not (sign and path and time):
        msg = f"--at {text}: no moment; write LOG@TIME, such as day1.bag@12.5"
        raise UsageError(msg)
    one = replace(selection, logs=(path,)).paths()
    if len(one) != 1:
        msg = f"--at {text}: {path} names {len(one)} logs; name one"
        raise UsageError(msg)
    with open_readable(one[0], selection) as reader:
        at_ns = parse_time(time, reader.start_ns)
        start_ns, end_ns = reader.start_ns, reader.end_ns
    if not start_ns <= at_ns <= end_ns:
        msg = f"--at {text}: the log is {(end_ns - start_ns) / NS_PER_S:.1f} s long; look inside it"
        raise UsageError(msg)
    return path, (at_ns - start_ns) / NS_PER_S


def _look(
    models: Models, source: Source, sensor: str, wanted_ns: int
) -> tuple[Moment, Float32Array]:
    """Return the observation nearest to a moment, and its features (n, d)."""
    best: tuple[int, int, Float32Array] | None = None
    scans, images = CollisionModel(models.settings), AppearanceModel(models.settings)
    scans.begin_log(source.start)
    for batch in source.batches():
        if sensor == "scan":
            blocks = [scans.embed(block) for block in batch.scans]
            seen = [(one.stamps_ns, one.features[:, None, :]) for one in blocks]
        else:
            patches = images.embed(batch.frames)
            seen = [(patches.stamps_ns, patches.features)]
        for stamps_ns, features in seen:
            if stamps_ns.size:
                nearest = int(np.abs(stamps_ns - wanted_ns).argmin())
                away = abs(int(stamps_ns[nearest]) - wanted_ns)
                if best is None or away < best[0]:
                    best = away, int(stamps_ns[nearest]), features[nearest]
    if best is None:
        span = f"from {_BEFORE_S:g} s before that moment to {_AFTER_S:g} s after it"
        msg = f"{source.name}: no {sensor} {span}; choose another"
        raise UsageError(msg)
    return Moment(source.name, source.start.start_ns, best[1], -1), best[2]


def _remembered(models: Models, sensor: str) -> tuple[list[Moment], Float32Array]:
    """Return where the exemplars of a model were seen, and their features (m, d)."""
    if sensor == "scan" and models.collision is not None:
        points, clustered = models.collision.meta_points, models.collision.parts().clustered
        features = points.references().astype(np.float32)
        clusters = clustered.clusters_of(points.ids)
        logs, stamps_ns = points.exemplar_log, points.exemplar_stamp_ns
        known = models.collision.logs
    elif models.appearance is not None:
        fine = models.appearance.two_scale.fine()
        features, clusters = fine.features, models.appearance.parts().coarse_of(fine.ids)
        logs, stamps_ns, known = fine.exemplar_log, fine.exemplar_stamp_ns, models.appearance.logs
    else:
        return [], np.zeros((0, 0), dtype=np.float32)
    moments = [
        Moment(known[log].name, known[log].start_ns, stamp_ns, cluster)
        for log, stamp_ns, cluster in zip(
            logs.tolist(), stamps_ns.tolist(), clusters.tolist(), strict=True
        )
    ]
    return moments, features
