"""``extract``: the segments of logs that are worth keeping, as logs of their own."""

import logging
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.extracting.cutting import SegmentRow, cut_logs
from mpap_cli.commands.extracting.events import find_predicted, find_presses
from mpap_cli.commands.extracting.novelty import find_novel
from mpap_cli.commands.extracting.request import NOVEL, PRESSES, ExtractRequest, Found
from mpap_cli.commands.inputs.models import load_models
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import DAMAGED, open_readable
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import LogError, ModelError, UsageError
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.tables import write_csv

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Extracted:
    """What was cut, and where it lies; ``folder`` is None where nothing was written."""

    folder: Path | None
    reason: str
    rows: list[SegmentRow]
    logs: list[str]
    n_logs: int
    kept_s: float
    duration_s: float
    exit_code: int = 0


def extract(
    selection: LogSelection,
    settings: SettingsRequest,
    request: ExtractRequest,
    progress: Progress = no_progress,
) -> Extracted:
    """Cut the segments worth keeping into new logs, their messages untouched.

    Parameters
    ----------
    selection : LogSelection
        Logs in order.
    settings : SettingsRequest
        Profile and settings where there is no model; else the model's count.
    request : ExtractRequest
        What is kept, how much of it, and where to.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Extracted
        Segments with their sizes.

    Raises
    ------
    LogError
        If no log can be read.
    ModelError
        If a model is needed and there is none, or it cannot be used.
    UsageError
        If a log lacks the sensor, or no topic is as asked for.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    if selection.time_source != "log":
        msg = "--time-source header: logs are cut by the time of recording; leave it out"
        raise UsageError(msg)
    with one_thread_each(), _results(request) as results:
        found = _find(selection, settings, request, results, progress)
        cut = cut_logs(found, request, results, progress, strict=selection.strict)
        told = {item.text for item in cut.damage} if not found.exit_code else set()
        for text in sorted(told):
            LOGGER.warning("%s", text)
        if not request.dry_run:
            write_csv(results.path("segments.csv"), SegmentRow, cut.rows)
            results.commit({**found.values, **_values(request)}, found.inputs, found.seed)
    if not request.dry_run:
        redraw(request.out)
    return Extracted(
        folder=None if request.dry_run else results.folder,
        reason=request.reason,
        rows=cut.rows,
        logs=cut.names,
        n_logs=len(found.logs),
        kept_s=sum(one.length_ns for one in found.segments) / NS_PER_S,
        duration_s=found.length_ns / NS_PER_S,
        exit_code=found.exit_code or (DAMAGED if cut.damage else 0),
    )


@contextmanager
def _results(request: ExtractRequest) -> Iterator[ResultsFolder]:
    """Open the results folder; for a dry run one that vanishes."""
    if not request.dry_run:
        with ResultsFolder(request.out, "extract") as results:
            yield results
        return
    with (
        tempfile.TemporaryDirectory(prefix="mpap-") as folder,
        ResultsFolder(Path(folder), "extract") as results,
    ):
        yield results


def _find(
    selection: LogSelection,
    settings: SettingsRequest,
    request: ExtractRequest,
    results: ResultsFolder,
    progress: Progress,
) -> Found:
    """Find the segments."""
    if request.reason == PRESSES:
        return find_presses(selection, settings, request, progress)
    if request.reason == NOVEL:
        model = request.model or _model_at_hand(selection, settings, request.out)
        return find_novel(selection, settings, request, model, progress)
    if not settings.says_nothing:
        msg = "predictions go by the model's own settings; leave out --profile, --set and such"
        raise UsageError(msg)
    return find_predicted(selection, request, request.model or request.out, results, progress)


def _model_at_hand(selection: LogSelection, settings: SettingsRequest, out: Path) -> Path | None:
    """Return the results folder if its model may tell what is new; it must not know the logs."""
    if not settings.says_nothing:
        return None
    try:
        models = load_models(out)
    except ModelError:
        return None
    known = {(log.name, log.start_ns) for log in models.logs}
    for path in selection.paths():
        try:
            with open_readable(path, selection) as reader:
                is_known = (reader.path.name, reader.start_ns) in known
        except LogError:
            continue
        if is_known:
            LOGGER.warning(
                "%s: learnt by the model in %s; new is what is new to the logs' own past",
                path.name,
                out,
            )
            return None
    return out


def _values(request: ExtractRequest) -> dict[str, object]:
    """Return what was asked for, for settings.json."""
    return {
        "reason": request.reason,
        "threshold": None if request.keep_ratio and request.reason == NOVEL else request.level,
        "keep-ratio": request.keep_ratio,
        "topics": list(request.topics),
        "split": request.split,
    }
