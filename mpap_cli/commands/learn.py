"""``learn``: from logs to clusters with collision probabilities, one history in order."""

import logging
import time
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.inputs.hints import tell_of_appearance, tell_of_heading, tell_of_model
from mpap_cli.commands.inputs.models import Models, begin_models, save_models
from mpap_cli.commands.inputs.press_file import press_inputs
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, open_sources
from mpap_cli.commands.learning.exemplars import draw_exemplars
from mpap_cli.commands.learning.models_in_progress import learn_log
from mpap_cli.commands.learning.patch_images import draw_patches
from mpap_cli.commands.learning.recorder import Recorder
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.features.scans.scan_features import FEW_BEAMS
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.recording import read_recording
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.cluster_rows import ClusterRow

LOGGER = logging.getLogger(__name__)
CLUSTERS, MODEL, RECORDING = "clusters.csv", "model.npz", "recording.npz"


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnRequest:
    """What ``learn`` shall do beside reading logs with settings.

    ``model`` is an older model to go on from; without ``keep_recording`` nothing is left
    for ``evaluate``; results do not depend on ``jobs``.
    """

    out: Path
    model: Path | None = None
    keep_recording: bool = True
    jobs: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class LearntScans:
    """What is known of laser scans."""

    clusters: list[ClusterRow]
    n_scans: int
    n_cluster_points: int
    n_meta_points: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LearntImages:
    """What is known of camera images."""

    clusters: list[ClusterRow]
    n_images: int
    n_patches: int
    n_exemplars: int
    n_outliers: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Learnt:
    """What models know, and where they lie; ``n_presses`` is None without a bumper."""

    folder: Path
    profile: str
    n_logs: int
    n_presses: int | None
    scans: LearntScans | None
    images: LearntImages | None
    exit_code: int = 0

    @property
    def clusters(self) -> list[ClusterRow]:
        """The rows of clusters.csv."""
        parts = [part.clusters for part in (self.scans, self.images) if part is not None]
        return [row for part in parts for row in part]


def learn(
    selection: LogSelection,
    settings: SettingsRequest,
    request: LearnRequest,
    progress: Progress = no_progress,
) -> Learnt:
    """Learn the collision model and the appearance model from logs (section 4 of the paper).

    Parameters
    ----------
    selection : LogSelection
        Logs, one history in the order given, their sensors and topics.
    settings : SettingsRequest
        Profile and settings; with an older model they are the model's.
    request : LearnRequest
        Results folder, older model, threads.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Learnt
        Clusters and counts; exit code 3 if part of the input was left out.

    Raises
    ------
    LogError
        If no log can be read.
    UsageError
        If a log lacks a sensor that was asked for, or settings are given beside an older
        model.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    models = begin_models(selection, settings, request.model)
    if request.model is not None:
        selection = selection.with_sensor_of(models.sensor)
    losses, inputs = Losses(), list[InputFile]()
    with one_thread_each(), ResultsFolder(request.out, "learn") as results:
        began_s, log_s = time.perf_counter(), 0.0
        with Recorder(results.path(RECORDING)) as recorder:
            for source in open_sources(selection, models.settings, losses):
                learn_log(models, recorder, source, request.jobs, progress)
                inputs.append(describe_input(source.path))
                log_s += (source.replay.end_ns - source.replay.start_ns) / NS_PER_S
            _require_observations(models, recorder)
        inputs += press_inputs(selection)
        if request.model is not None:
            inputs.append(describe_input(find_model(request.model)))
        learnt = learnt_of(models, results.folder, losses.exit_code)
        write_csv(results.path(CLUSTERS), ClusterRow, learnt.clusters)
        save_models(results.path(MODEL), models)
        _draw(results, selection, models, learnt, recorder)
        if not (request.keep_recording and recorder.n_scans):
            results.path(RECORDING).unlink()
        _tell_speed(log_s, time.perf_counter() - began_s)
        values = selection.values(models.settings)
        results.commit(values, inputs, models.settings.affinity.seed)
    return learnt


def _require_observations(models: Models, recorder: Recorder) -> None:
    """Refuse to publish a model that knows nothing.

    Raises
    ------
    UsageError
        If no observation was read, or none gave a feature.
    """
    images, scans = models.appearance, models.collision
    if images is not None and images.n_images:
        return
    if scans is None:
        msg = "no image could be used; check --start, --end and --image-topic"
        raise UsageError(msg)
    recorder.require_scans()
    if scans.meta_points.n_points == 0:
        scan = scans.settings.scan
        msg = f"no scan could be used: {FEW_BEAMS} ({scan.bins} bins, --fov {scan.fov}); use fewer"
        raise UsageError(msg)


def _draw(
    results: ResultsFolder,
    selection: LogSelection,
    models: Models,
    learnt: Learnt,
    recorder: Recorder,
) -> None:
    """Draw the exemplars of both models, and say what is odd about the models."""
    if learnt.scans is not None and models.collision is not None:
        recording = results.path(RECORDING)
        observed = read_recording(recording)
        assumed = [observed[index] for index in recorder.headings_assumed]
        tell_of_heading(assumed, models.settings.scan)
        tell_of_model(models.collision)
        draw_exemplars(results.path("exemplars.png"), learnt.scans.clusters, recording, selection)
    if models.appearance is not None:
        tell_of_appearance(models.appearance)
        suffix = "" if learnt.scans is None else "-patches"
        names = (f"exemplars{suffix}.png", "members.png")
        draw_patches([results.path(name) for name in names], models.appearance, selection)


def _tell_speed(log_s: float, took_s: float) -> None:
    LOGGER.info("learnt %.0f s of log in %.1f s: %.0f x real time", log_s, took_s, log_s / took_s)


def learnt_of(models: Models, folder: Path, exit_code: int) -> Learnt:
    """Sum up what models know."""
    for model in (models.collision, models.appearance):
        if model is not None:
            model.finish()
    pressed = [log.n_presses for log in models.logs if log.n_presses is not None]
    return Learnt(
        folder=folder,
        profile=models.settings.profile,
        n_logs=len(models.logs),
        n_presses=sum(pressed) if pressed else None,
        scans=_learnt_scans(models),
        images=_learnt_images(models),
        exit_code=exit_code,
    )


def _learnt_scans(models: Models) -> LearntScans | None:
    model = models.collision
    if model is None:
        return None
    return LearntScans(
        clusters=model.clusters(),
        n_scans=sum(log.n_observations for log in model.logs),
        n_cluster_points=model.self_check().n_cluster_points,
        n_meta_points=model.meta_points.n_points,
    )


def _learnt_images(models: Models) -> LearntImages | None:
    model = models.appearance
    if model is None:
        return None
    return LearntImages(
        clusters=model.rows(),
        n_images=model.n_images,
        n_patches=model.n_images * model.n_patches,
        n_exemplars=model.two_scale.n_clusters,
        n_outliers=model.two_scale.n_reservoir,
    )
