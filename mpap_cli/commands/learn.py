"""``learn``: from logs to clusters with collision probabilities, one history in order."""

import logging
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.exemplars import draw_exemplars
from mpap_cli.commands.hints import tell_of_heading, tell_of_model, tell_of_presses
from mpap_cli.commands.models import load_model, save_model
from mpap_cli.commands.press_file import press_inputs
from mpap_cli.commands.progress import Progress, no_progress
from mpap_cli.commands.recorder import Recorder
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.selection import LogSelection
from mpap_cli.commands.settings import SettingsRequest, settings_from
from mpap_cli.commands.sources import Losses, Source, open_sources
from mpap_cli.errors import UsageError
from mpap_cli.features.scans.scan_features import FEW_BEAMS
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.recording import read_recording
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.cluster_rows import ClusterRow
from mpap_cli.systems.collision import CollisionModel

LOGGER = logging.getLogger(__name__)
CLUSTERS, MODEL, RECORDING, EXEMPLARS = (
    "clusters.csv",
    "model.npz",
    "recording.npz",
    "exemplars.png",
)


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
class Learnt:
    """What a model knows, and where it lies; ``n_presses`` is None without a bumper."""

    folder: Path
    profile: str
    clusters: list[ClusterRow]
    n_logs: int
    n_scans: int
    n_presses: int | None
    n_cluster_points: int
    n_meta_points: int
    exit_code: int = 0


def learn(
    selection: LogSelection,
    settings: SettingsRequest,
    request: LearnRequest,
    progress: Progress = no_progress,
) -> Learnt:
    """Learn the collision model from logs (section 4.1 of the paper).

    Parameters
    ----------
    selection : LogSelection
        Logs, one history in the order given, and their topics.
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
        If a log has no scan topic, or settings are given beside an older model.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    model = _model(selection, settings, request.model)
    losses, inputs = Losses(), list[InputFile]()
    with one_thread_each(), ResultsFolder(request.out, "learn") as results:
        recording = results.path(RECORDING)
        with Recorder(recording) as recorder:
            for source in open_sources(selection, model.settings, losses):
                _learn_log(model, recorder, source, request.jobs, progress)
                inputs.append(describe_input(source.path))
            recorder.require_scans()
        inputs += press_inputs(selection)
        if request.model is not None:
            inputs.append(describe_input(find_model(request.model)))
        _require_observations(model)
        model.finish()
        observed = read_recording(recording)
        tell_of_heading(
            [observed[index] for index in recorder.headings_assumed], model.settings.scan
        )
        tell_of_model(model)
        clusters = model.clusters()
        write_csv(results.path(CLUSTERS), ClusterRow, clusters)
        save_model(results.path(MODEL), model)
        draw_exemplars(results.path(EXEMPLARS), clusters, recording, selection)
        if not request.keep_recording:
            recording.unlink()
        values = selection.values(model.settings)
        results.commit(values, inputs, model.settings.affinity.seed)
    return learnt_of(model, clusters, results.folder, losses.exit_code)


def _require_observations(model: CollisionModel) -> None:
    """Refuse to publish a model that knows nothing.

    Raises
    ------
    UsageError
        If no scan gave a feature.
    """
    if model.meta_points.n_points == 0:
        scan = model.settings.scan
        msg = f"no scan could be used: {FEW_BEAMS} ({scan.bins} bins, --fov {scan.fov}); use fewer"
        raise UsageError(msg)


def learnt_of(
    model: CollisionModel, clusters: list[ClusterRow], folder: Path, exit_code: int
) -> Learnt:
    """Sum up what a model knows."""
    check = model.self_check()
    pressed = [log.n_presses for log in model.logs if log.n_presses is not None]
    return Learnt(
        folder=folder,
        profile=model.settings.profile,
        clusters=clusters,
        n_logs=len(model.logs),
        n_scans=sum(log.n_scans for log in model.logs),
        n_presses=sum(pressed) if pressed else None,
        n_cluster_points=check.n_cluster_points,
        n_meta_points=model.meta_points.n_points,
        exit_code=exit_code,
    )


def _model(
    selection: LogSelection, settings: SettingsRequest, older: Path | None
) -> CollisionModel:
    """Return a new model, or the older one that is to go on."""
    if older is None:
        # the model keeps the forward direction, for later logs of the same robot
        return CollisionModel(selection.settings_for(settings_from(settings)))
    if not settings.says_nothing:
        msg = "--model goes on with the model's own settings; leave out --profile, --set and such"
        raise UsageError(msg)
    return load_model(older)


def _learn_log(
    model: CollisionModel, recorder: Recorder, source: Source, jobs: int, progress: Progress
) -> None:
    """Replay one log through the model and into the recording."""
    model.begin_log(source.start)
    n_scans = n_learnt = 0
    for batch in recorder.batches(source, jobs, progress, "learn"):
        learnt = model.observe(batch)
        n_scans += sum(len(block.stamps_ns) for block in batch.scans)
        n_learnt += sum(len(block.ids) for block in learnt)
    source.skipped[FEW_BEAMS] += n_scans - n_learnt
    if (source.name, source.start.start_ns) in {(log.name, log.start_ns) for log in model.logs}:
        LOGGER.warning("%s: learnt before; its scans and presses count twice", source.name)
    presses = model.end_log(source.replay.end_ns)
    recorder.end_log(source, presses)
    tell_of_presses(source, presses, recorder.scan_span)
