"""What a collision model says of every scan of new logs."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.commands.evaluating.observed import drop_recording, observe_logs
from mpap_cli.commands.evaluating.outputs import timelines_of
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.evaluation.leads import LeadSummary
from mpap_cli.evaluation.rows import PressRow, TimelineRow
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.timelines import Timeline
from mpap_cli.outputs.plots import plot_timeline
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.collision import CollisionModel


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedScans:
    """How many scans were predicted, and what was announced."""

    timeline: Timeline
    inputs: tuple[InputFile, ...]
    exit_code: int

    @property
    def n_scans(self) -> int:
        """Scans that a probability was asked for."""
        return self.timeline.sheet.rows.n_scans

    @property
    def n_predicted(self) -> int:
        """Scans at which a collision is announced."""
        return int((self.timeline.prediction.p_collision >= self.timeline.threshold).sum())

    @property
    def n_novel(self) -> int:
        """Scans unlike anything that was learnt."""
        return int(np.sum(self.timeline.prediction.novel))

    @property
    def alarms(self) -> LeadSummary | None:
        """How early the alarms of profile robust announced them; None under profile paper."""
        alarms = self.timeline.alarms
        return None if alarms is None else alarms.point.every

    @property
    def leads(self) -> LeadSummary:
        """How early presses were announced."""
        return self.timeline.summary


def predict_scans(
    model: CollisionModel,
    selection: LogSelection,
    results: ResultsFolder,
    threshold: float,
    jobs: int,
    progress: Progress,
) -> PredictedScans:
    """Predict every scan, and write timeline.csv, presses.csv and timeline.png."""
    observed = observe_logs(selection, model.settings, results, jobs, progress)
    question = Question(logs=observed.logs, threshold=threshold, model=model)
    evaluation = evaluate_all(question, [Variant("mpap", model.settings)], baselines=False)
    timeline = evaluation.timeline
    write_csv(results.path("timeline.csv"), TimelineRow, timeline.rows())
    write_csv(results.path("presses.csv"), PressRow, timeline.press_rows())
    plot_timeline(results.path("timeline.png"), timelines_of(timeline), threshold)
    drop_recording(results)
    return PredictedScans(timeline=timeline, inputs=observed.inputs, exit_code=observed.exit_code)
