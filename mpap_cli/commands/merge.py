"""``merge``: one model of several that were learnt with the same settings."""

import logging
from collections.abc import Sequence
from pathlib import Path

from mpap_cli.commands.inputs.hints import tell_of_model
from mpap_cli.commands.inputs.models import Models, load_models
from mpap_cli.commands.learning.summary import Learnt, write_learnt
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.errors import ModelError, UsageError
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.params import settings_values
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.merging import merge_models

LOGGER = logging.getLogger(__name__)


def merge(models: Sequence[Path], out: Path) -> Learnt:
    """Merge models; their order does not matter.

    Parameters
    ----------
    models : sequence of Path
        Model files or results folders.
    out : Path
        Results folder.

    Returns
    -------
    Learnt
        Clusters and counts of the merged model.

    Raises
    ------
    ModelError
        If one cannot be used, or their settings differ.
    UsageError
        If two are the same, whose scans would count twice.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    with one_thread_each(), ResultsFolder(out, "merge") as results:
        inputs = _inputs(models)
        merged = merge_models([_laser_part(path) for path in models])
        tell_of_model(merged)
        learnt = write_learnt(results, Models(merged.settings, merged), exit_code=0)
        settings = {**settings_values(merged.settings), "profile": merged.settings.profile}
        results.commit(settings, inputs, merged.settings.affinity.seed)
    redraw(out)
    return learnt


def _laser_part(path: Path) -> CollisionModel:
    """Return the collision model of a file; what was learnt of images is not merged."""
    models = load_models(path)
    if models.collision is None:
        msg = f"{find_model(path)}: learnt from images only; merge joins laser models"
        raise ModelError(msg)
    if models.appearance is not None:
        LOGGER.warning("%s: what was learnt of images is left out", path)
    return models.collision


def _inputs(models: Sequence[Path]) -> list[InputFile]:
    """Describe the model files in an order of their own; none may be given twice."""
    described: dict[str, tuple[Path, InputFile]] = {}
    for path in models:
        one = describe_input(find_model(path))
        if one.sha256 in described:
            other = described[one.sha256][0]
            msg = f"merge: {other} and {path} are the same model; name it once"
            raise UsageError(msg)
        described[one.sha256] = path, one
    return [described[sha256][1] for sha256 in sorted(described)]
