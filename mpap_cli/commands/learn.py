"""``learn``: from logs to clusters with collision probabilities, one history in order."""

import logging
import time
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.inputs.hints import tell_of_appearance, tell_of_heading, tell_of_model
from mpap_cli.commands.inputs.models import Models, begin_models
from mpap_cli.commands.inputs.press_file import press_inputs
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, open_sources
from mpap_cli.commands.learning.exemplars import draw_exemplars
from mpap_cli.commands.learning.models_in_progress import learn_log
from mpap_cli.commands.learning.patch_images import draw_patches
from mpap_cli.commands.learning.recorder import Recorder
from mpap_cli.commands.learning.summary import Learnt, write_learnt
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.features.scans.scan_features import FEW_BEAMS
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.exemplar_file import EXEMPLARS_NAME, write_exemplar_file
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.patch_pictures import PatchCluster
from mpap_cli.outputs.recording import RECORDING_NAME, read_recording
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.outputs.scan_pictures import ExemplarPicture

LOGGER = logging.getLogger(__name__)


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
        with Recorder(results.path(RECORDING_NAME)) as recorder:
            for source in open_sources(selection, models.settings, losses):
                learn_log(models, recorder, source, request.jobs, progress)
                inputs.append(describe_input(source.path))
                log_s += (source.replay.end_ns - source.replay.start_ns) / NS_PER_S
            _require_observations(models, recorder)
        inputs += press_inputs(selection)
        if request.model is not None:
            inputs.append(describe_input(find_model(request.model)))
        learnt = write_learnt(results, models, losses.exit_code)
        _draw(results, selection, models, learnt, recorder)
        if not (request.keep_recording and recorder.n_scans):
            results.path(RECORDING_NAME).unlink()
        _tell_speed(log_s, time.perf_counter() - began_s)
        values = selection.values(models.settings)
        results.commit(values, inputs, models.settings.affinity.seed)
    redraw(request.out)
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
    scans, patches = list[ExemplarPicture](), list[PatchCluster]()
    if learnt.scans is not None and models.collision is not None:
        recording = results.path(RECORDING_NAME)
        observed = read_recording(recording)
        assumed = [observed[index] for index in recorder.headings_assumed]
        tell_of_heading(assumed, models.settings.scan)
        tell_of_model(models.collision)
        path = results.path("exemplars.png")
        scans = draw_exemplars(path, learnt.scans.clusters, recording, selection)
    if models.appearance is not None:
        tell_of_appearance(models.appearance)
        suffix = "" if learnt.scans is None else "-patches"
        names = (f"exemplars{suffix}.png", "members.png")
        patches = draw_patches([results.path(name) for name in names], models.appearance, selection)
    write_exemplar_file(results.path(EXEMPLARS_NAME), scans, patches)


def _tell_speed(log_s: float, took_s: float) -> None:
    LOGGER.info("learnt %.0f s of log in %.1f s: %.0f x real time", log_s, took_s, log_s / took_s)
