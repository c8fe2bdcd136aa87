"""``predict``: what a model says of every scan of new logs."""

from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.evaluate_outputs import timelines_of
from mpap_cli.commands.models import load_model
from mpap_cli.commands.observed import drop_recording, observe_logs
from mpap_cli.commands.progress import Progress, no_progress
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.selection import LogSelection
from mpap_cli.evaluation.leads import LeadSummary
from mpap_cli.evaluation.rows import PressRow, TimelineRow
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.plots import plot_timeline
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import describe_input
from mpap_cli.outputs.tables import write_csv


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictRequest:
    """Which model predicts, from which probability a collision is announced, and where to."""

    out: Path
    model: Path
    threshold: float = 0.2
    jobs: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Predicted:
    """How much was predicted, and where it lies."""

    folder: Path
    n_logs: int
    n_scans: int
    n_predicted: int
    n_novel: int
    threshold: float
    leads: LeadSummary
    exit_code: int = 0


def predict(
    selection: LogSelection, request: PredictRequest, progress: Progress = no_progress
) -> Predicted:
    """Predict the probability of a collision for every scan.

    Parameters
    ----------
    selection : LogSelection
        Logs; presses in them are compared with what was predicted.
    request : PredictRequest
        Model and threshold.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Predicted
        Counts; timeline.csv, presses.csv and timeline.png hold the rest.

    Raises
    ------
    ModelError
        If the model cannot be used.
    LogError
        If no log can be read.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    model = load_model(request.model)
    with one_thread_each(), ResultsFolder(request.out, "predict") as results:
        observed = observe_logs(selection, model.settings, results, request.jobs, progress)
        question = Question(logs=observed.logs, threshold=request.threshold, model=model)
        evaluation = evaluate_all(question, [Variant("mpap", model.settings)], baselines=False)
        timeline = evaluation.timeline
        write_csv(results.path("timeline.csv"), TimelineRow, timeline.rows())
        write_csv(results.path("presses.csv"), PressRow, timeline.press_rows())
        plot_timeline(results.path("timeline.png"), timelines_of(timeline), request.threshold)
        drop_recording(results)
        values = {**selection.values(model.settings), "threshold": request.threshold}
        inputs = [*observed.inputs, describe_input(find_model(request.model))]
        results.commit(values, inputs, model.settings.affinity.seed)
    return Predicted(
        folder=results.folder,
        n_logs=len(observed.logs),
        n_scans=timeline.sheet.rows.n_scans,
        n_predicted=int((timeline.prediction.p_collision >= request.threshold).sum()),
        n_novel=int(timeline.prediction.novel.sum()),
        threshold=request.threshold,
        leads=timeline.summary,
        exit_code=observed.exit_code,
    )
