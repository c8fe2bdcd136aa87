"""What an appearance model says of every image of new logs, and what the robot would do."""

from collections import Counter
from dataclasses import dataclass, replace

from mpap_cli.commands.inputs.press_file import press_inputs
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sensors import IMAGE_AND_SCANS_IF_ANY
from mpap_cli.commands.inputs.sources import Losses, Source, open_sources
from mpap_cli.commands.learning.models_in_progress import note_images
from mpap_cli.commands.predicting.annotations import Annotator
from mpap_cli.commands.predicting.image_decisions import JudgedLog, LogDecisions, Outlook
from mpap_cli.commands.predicting.map_drawing import MapDrawing
from mpap_cli.commands.predicting.prediction_log import (
    prediction_log,
    write_decisions,
    write_presses,
    write_scan_predictions,
)
from mpap_cli.commands.predicting.request import PredictRequest
from mpap_cli.commands.predicting.scans import PredictedScans
from mpap_cli.evaluation.leads import Lead
from mpap_cli.evaluation.rows import DecisionRow, PatchRow
from mpap_cli.evaluation.stopping import StoppingSummary, Stops, summarize_stops
from mpap_cli.logs.writing.event_log import EventLogWriter
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.outputs.tables import TableWriter
from mpap_cli.params import Settings
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.decision import ACTIONS


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedImages:
    """How much was predicted of images, and how the decisions turned out.

    ``actions`` counts images by decision; ``contacts_foreseen`` of the ``contacts`` were
    preceded by a decision to stop or turn; ``stops`` of each log are summed up in ``stopping``.
    """

    n_images: int
    n_patches: int
    n_obstacle: int
    n_unknown: int
    actions: dict[str, int]
    contacts: int
    contacts_foreseen: int
    stops: tuple[Stops, ...]
    stopping: StoppingSummary
    patch_threshold: float
    inputs: tuple[InputFile, ...]
    exit_code: int


class _Totals:
    """Sums over the logs."""

    def __init__(self) -> None:
        self.actions: Counter[str] = Counter()
        self.n_obstacle = self.n_unknown = 0
        self.leads: list[Lead] = []
        self.stops: list[Stops] = []

    def add(self, judged: JudgedLog) -> None:
        """Add one log."""
        self.actions.update(ACTIONS[action] for action in judged.table[:, 1].tolist())
        self.n_obstacle += int(judged.table[:, 2].sum())
        self.n_unknown += int(judged.table[:, 3].sum())
        self.leads += judged.leads
        self.stops.append(judged.stops)

    def outcome(
        self, *, settings: Settings, n_patches: int, inputs: tuple[InputFile, ...], exit_code: int
    ) -> PredictedImages:
        """Return what was found in all logs, of images with so many patches each."""
        n_images = self.actions.total()
        leads = [lead for lead in self.leads if lead.predicted is not None]
        return PredictedImages(
            n_images=n_images,
            n_patches=n_images * n_patches,
            n_obstacle=self.n_obstacle,
            n_unknown=self.n_unknown,
            actions={action: self.actions[action] for action in ACTIONS},
            contacts=len(leads),
            contacts_foreseen=sum(lead.predicted is True for lead in leads),
            stops=tuple(self.stops),
            stopping=summarize_stops(self.stops),
            patch_threshold=settings.obstacle.patch_threshold,
            inputs=inputs,
            exit_code=exit_code,
        )


def predict_images(
    model: AppearanceModel,
    selection: LogSelection,
    results: ResultsFolder,
    request: PredictRequest,
    progress: Progress,
    scans: PredictedScans | None = None,
) -> PredictedImages:
    """Predict every image; writes decisions.csv, patches.csv, annotated.png and logs."""
    settings = _with_threshold(model.settings, request.patch_threshold)
    selection = replace(selection, sensor=IMAGE_AND_SCANS_IF_ANY)
    losses, inputs, totals = Losses(), list[InputFile](), _Totals()
    annotator = Annotator(settings)
    with (
        TableWriter(results.path("decisions.csv"), DecisionRow) as decisions,
        TableWriter(results.path("patches.csv"), PatchRow) as patches,
    ):
        for source in open_sources(selection, settings, losses):
            annotator.begin_log(source)
            asked = request.to_mcap
            with prediction_log(results, source.index, source.name, wanted=asked) as log:
                judge, sketch = LogDecisions(source, settings), MapDrawing(source, settings)
                for batch, block in follow(source, request.jobs, progress, "predict", model.embed):
                    judge.look_around(batch)
                    outlook: Outlook | None = None
                    if block is not None and block.stamps_ns.size:
                        outlook = judge.decide(block, model.predict(block))
                        patches.add(judge.patch_rows(outlook))
                        annotator.add(batch, outlook, log)
                    sketch.add(batch, outlook)
                judged = judge.end()
                if log is not None:
                    _write_log(log, judged, scans, source)
            sketch.write(results.path(_map_name(source.index)), source.name)
            decisions.add(judged.rows())
            totals.add(judged)
            note_images(source, model)
            inputs.append(describe_input(source.path))
    annotator.write(results.path("annotated.png"))
    return totals.outcome(
        settings=settings,
        n_patches=model.n_patches,
        inputs=(*inputs, *press_inputs(selection)),
        exit_code=losses.exit_code,
    )


def _map_name(log_index: int) -> str:
    """Return the name of the map of a log.

    >>> _map_name(0), _map_name(1)
    ('map.png', 'map-1.png')
    """
    return f"map-{log_index}.png" if log_index else "map.png"


def _with_threshold(settings: Settings, threshold: float | None) -> Settings:
    """Return the settings with another probability from which a patch is an obstacle."""
    if threshold is None:
        return settings
    return replace(settings, obstacle=replace(settings.obstacle, patch_threshold=threshold))


def _write_log(
    log: EventLogWriter, judged: JudgedLog, scans: PredictedScans | None, source: Source
) -> None:
    """Write what is known at the end of a log: decisions, and predictions from its scans."""
    write_decisions(log, judged)
    if scans is None:
        write_presses(log, judged.presses)
    else:
        write_scan_predictions(log, scans.timeline, source.index)
