"""``novelty``: how much of each log was new, window by window, model carried from log to log."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.common_sensors import common_sensors
from mpap_cli.commands.inputs.models import Models, begin_models
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, Source, open_sources
from mpap_cli.commands.learning.models_in_progress import note_images
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.novelty import Boundary, NoveltyMeter, NoveltyRow
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.novelty_plot import plot_novelty
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.obstacles import KnownPatches


@dataclass(frozen=True, slots=True, kw_only=True)
class NoveltyRequest:
    """Where results go, what is known before, how long a window is, and how often one begins.

    ``step_s`` None: windows follow one another; else they overlap.
    """

    out: Path
    model: Path | None = None
    window_s: float = 60.0
    step_s: float | None = None
    jobs: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Novelty:
    """What was new, and where it lies; ``models`` know what they learnt on the way."""

    folder: Path
    sensor: str
    rows: list[NoveltyRow]
    boundaries: list[Boundary]
    models: Models
    exit_code: int = 0


def novelty(
    selection: LogSelection,
    settings: SettingsRequest,
    request: NoveltyRequest,
    progress: Progress = no_progress,
) -> Novelty:
    """Tell how much of each log was new to a model that learns on (section 5.3).

    Parameters
    ----------
    selection : LogSelection
        Logs in order; images are taken if every log has them, else scans.
    settings : SettingsRequest
        Profile and settings; with an older model they are the model's.
    request : NoveltyRequest
        Results folder, older model, windows.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Novelty
        Windows and boundaries between logs.

    Raises
    ------
    LogError
        If no log can be read.
    UsageError
        If a log lacks the sensor.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    models = begin_models(selection, settings, request.model)
    # a log named again is a return to its place
    selection = replace(selection, once=False)
    if selection.sensor == "auto":
        selection = replace(selection, sensor=_sensor(selection, models))
    sensor = selection.sensor
    losses, inputs = Losses(), list[InputFile]()
    with one_thread_each(), ResultsFolder(request.out, "novelty") as results:
        meter = NoveltyMeter(sensor, request.window_s, request.step_s)
        for source in open_sources(selection, models.settings, losses):
            if sensor == "image":
                _meet_images(models, meter, source, request.jobs, progress)
            else:
                _meet_scans(models, meter, source, request.jobs, progress)
            inputs.append(describe_input(source.path))
        if request.model is not None:
            inputs.append(describe_input(find_model(request.model)))
        rows, boundaries = meter.rows(), meter.boundaries()
        if not rows:
            msg = f"no {sensor} could be used; check --start, --end and the topics"
            raise UsageError(msg)
        write_csv(results.path("novelty.csv"), NoveltyRow, rows)
        plot_novelty(results.path("novelty.png"), rows, boundaries)
        values = {
            **selection.values(models.settings),
            "window": request.window_s,
            "step": request.step_s,
        }
        results.commit(values, inputs, models.settings.affinity.seed)
    return Novelty(
        folder=results.folder,
        sensor=sensor,
        rows=rows,
        boundaries=boundaries,
        models=models,
        exit_code=losses.exit_code,
    )


def _sensor(selection: LogSelection, models: Models) -> str:
    """Return image if every log (and the model) has images, or not every one has scans."""
    if models.sensor in {"scan", "image"}:
        return models.sensor
    shared = common_sensors(selection)
    return "scan" if "scan" in shared and "image" not in shared else "image"


def _meet_images(
    models: Models, meter: NoveltyMeter, source: Source, jobs: int, progress: Progress
) -> None:
    """Learn the images of one log and note what was new in each."""
    model = models.appearance = models.appearance or AppearanceModel(models.settings)
    known = model.known()
    model.begin_log(source.start)
    meter.begin_log(source.name, source.start.start_ns)
    for batch, patches in follow(source, jobs, progress, "meet", model.embed):
        if patches is None:
            continue
        unknown = known.unknown(patches.features)
        learnt = model.learn(patches)
        model.settle(batch.bumps, batch.poses, batch.until_ns)
        meter.add(
            patches.stamps_ns,
            model.n_patches,
            learnt.outlier.sum(axis=1),
            unknown.sum(axis=1) if known.features.size else None,
            model.two_scale.n_clusters,
        )
    model.end_log(source.replay.end_ns)
    note_images(source, model)
    meter.end_log()


def _meet_scans(
    models: Models, meter: NoveltyMeter, source: Source, jobs: int, progress: Progress
) -> None:
    """Learn the scans of one log and note which were new."""
    model = models.collision = models.collision or CollisionModel(models.settings)
    points = model.meta_points
    references = points.references()[points.is_cluster_point].astype(np.float32)
    known = KnownPatches(references, points.params.theta)
    model.begin_log(source.start)
    meter.begin_log(source.name, source.start.start_ns)
    for batch, _ in follow(source, jobs, progress, "meet"):
        for learnt in model.observe(batch):
            unknown = known.unknown(learnt.features.features)
            meter.add(
                learnt.features.stamps_ns,
                1,
                (learnt.cases > 1).astype(np.int64),
                unknown.astype(np.int64) if known.features.size else None,
                int(points.is_cluster_point.sum()),
            )
    model.end_log(source.replay.end_ns)
    meter.end_log()
