"""``predict``: what models say of every scan and every image of new logs."""

from dataclasses import dataclass, replace
from pathlib import Path

from mpap_cli.commands.inputs.common_sensors import common_sensors
from mpap_cli.commands.inputs.models import Models, load_models
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.predicting.images import PredictedImages, predict_images
from mpap_cli.commands.predicting.prediction_log import write_scan_logs
from mpap_cli.commands.predicting.request import PredictRequest
from mpap_cli.commands.predicting.scans import PredictedScans, predict_scans
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import describe_input


@dataclass(frozen=True, slots=True, kw_only=True)
class Predicted:
    """How much was predicted, and where it lies; what the model lacks is None."""

    folder: Path
    n_logs: int
    threshold: float
    scans: PredictedScans | None
    images: PredictedImages | None
    exit_code: int = 0


def predict(
    selection: LogSelection, request: PredictRequest, progress: Progress = no_progress
) -> Predicted:
    """Predict the probability of a collision for every scan, and of obstacles in every image.

    Parameters
    ----------
    selection : LogSelection
        Logs; presses in them are compared with what was predicted.
    request : PredictRequest
        Model, thresholds, results folder.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Predicted
        Counts; the files in the results folder hold the rest.

    Raises
    ------
    ModelError
        If the model cannot be used.
    LogError
        If no log can be read.
    UsageError
        If a log has no sensor that the model knows.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    models = load_models(request.model)
    wanted = _sensors(models, selection)
    scans: PredictedScans | None = None
    images: PredictedImages | None = None
    with one_thread_each(), ResultsFolder(request.out, "predict") as results:
        if models.collision is not None and "scan" in wanted:
            of_scans = replace(selection, sensor="scan")
            scans = predict_scans(
                models.collision, of_scans, results, request.threshold, request.jobs, progress
            )
        if models.appearance is not None and "image" in wanted:
            images = predict_images(models.appearance, selection, results, request, progress, scans)
        elif request.to_mcap and scans is not None:
            write_scan_logs(results, scans.timeline)
        values = {
            **selection.values(models.settings),
            "threshold": request.threshold,
            "patch-threshold": request.patch_threshold,
        }
        parts = [part for part in (scans, images) if part is not None]
        inputs = [*parts[0].inputs, describe_input(find_model(request.model))]
        results.commit(values, inputs, models.settings.affinity.seed)
    redraw(request.out)
    return Predicted(
        folder=results.folder,
        n_logs=len(parts[0].inputs),
        threshold=request.threshold,
        scans=scans,
        images=images,
        exit_code=max(part.exit_code for part in parts),
    )


def _sensors(models: Models, selection: LogSelection) -> frozenset[str]:
    """Return the sensors to predict from; if the logs lack one, reading them says so."""
    known = {"scan": models.collision, "image": models.appearance}
    able = frozenset(sensor for sensor, model in known.items() if model is not None)
    if selection.sensor in {"scan", "image"}:
        return frozenset({selection.sensor})
    return (able & common_sensors(selection)) or able
