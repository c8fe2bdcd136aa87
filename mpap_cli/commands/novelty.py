"""``novelty``: how much of each log was new, window by window, model carried from log to log."""

from dataclasses import dataclass, replace
from pathlib import Path

from mpap_cli.commands.inputs.meeting import meet, sensor_to_meet
from mpap_cli.commands.inputs.models import Models, begin_models
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, Source, open_sources
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.novelty import Boundary, NoveltyMeter, NoveltyRow
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.novelty_plot import plot_novelty
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.outputs.tables import write_csv


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
        selection = replace(selection, sensor=sensor_to_meet(selection, models))
    sensor = selection.sensor
    losses, inputs = Losses(), list[InputFile]()
    with one_thread_each(), ResultsFolder(request.out, "novelty") as results:
        meter = NoveltyMeter(sensor, request.window_s, request.step_s)
        for source in open_sources(selection, models.settings, losses):
            _meet(models, meter, source, request.jobs, progress)
            inputs.append(describe_input(source.path))
        if request.model is not None:
            inputs.append(describe_input(find_model(request.model)))
        rows, boundaries = meter.rows(), meter.boundaries()
        if not rows:
            msg = f"no {sensor} could be used; check --start, --end and the topics"
            raise UsageError(msg)
        write_csv(results.path("novelty.csv"), NoveltyRow, rows)
        plot_novelty(results.path("novelty.png"), rows, boundaries)
        windows = {"window": request.window_s, "step": request.step_s}
        values = selection.values(models.settings) | windows
        results.commit(values, inputs, models.settings.affinity.seed)
    redraw(request.out)
    return Novelty(
        folder=results.folder,
        sensor=sensor,
        rows=rows,
        boundaries=boundaries,
        models=models,
        exit_code=losses.exit_code,
    )


def _meet(
    models: Models, meter: NoveltyMeter, source: Source, jobs: int, progress: Progress
) -> None:
    """Learn one log and note what was new in each observation."""
    meter.begin_log(source.name, source.start.start_ns)
    for met in meet(models, source, meter.sensor, jobs, progress):
        meter.add(
            met.stamps_ns,
            met.ids.shape[1],
            met.novel.sum(axis=1),
            None if met.unknown is None else met.unknown.sum(axis=1),
            met.n_clusters,
        )
    meter.end_log()
