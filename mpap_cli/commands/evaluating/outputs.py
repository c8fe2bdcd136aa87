"""The files of ``evaluate``: tables and plots of one evaluation."""

import numpy as np

from mpap_cli.evaluation.calibration import N_BINS
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.operating import operating_rows
from mpap_cli.evaluation.rows import (
    AucRow,
    DifferenceRow,
    OperatingRow,
    PressRow,
    RocRow,
    TimelineRow,
)
from mpap_cli.evaluation.scoring import Evaluation
from mpap_cli.evaluation.timelines import Timeline
from mpap_cli.outputs import plots
from mpap_cli.outputs.latex import latex_table
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.cluster_rows import ClusterRow


def write_evaluation(results: ResultsFolder, evaluation: Evaluation) -> None:
    """Write the tables and plots of an evaluation.

    Parameters
    ----------
    results : ResultsFolder
        Where they go.
    evaluation : Evaluation
        What was found; clusters.csv and the timeline are of its first variant.
    """
    model = evaluation.models[0]
    scores = [marks.row for marks in evaluation.marks]
    write_csv(results.path("auc.csv"), AucRow, scores)
    results.path("auc.tex").write_text(latex_table(scores), encoding="utf-8")
    roc_rows = (row for marks in evaluation.marks for row in marks.roc_rows())
    write_csv(results.path("roc.csv"), RocRow, roc_rows)
    write_csv(results.path("differences.csv"), DifferenceRow, evaluation.differences)
    operating = (row for one in evaluation.marks for row in operating_rows(one.row, one.points))
    write_csv(results.path("operating.csv"), OperatingRow, operating)
    write_csv(results.path("timeline.csv"), TimelineRow, evaluation.timeline.rows())
    write_csv(results.path("presses.csv"), PressRow, evaluation.timeline.press_rows())
    write_csv(results.path("clusters.csv"), ClusterRow, model.clusters())
    first = evaluation.marks[0].row
    title = f"target {first.target}, {first.protocol}, truth: {first.truth}"
    plots.plot_roc(results.path("roc.png"), _roc_lines(evaluation.marks), title)
    plots.plot_timeline(
        results.path("timeline.png"),
        timelines_of(evaluation.timeline),
        evaluation.timeline.threshold,
    )
    plots.plot_calibration(
        results.path("calibration.png"),
        _reliability(evaluation.marks[0]),
        f"{first.method}, {title}{_recalibration(first)}",
    )


def _recalibration(row: AucRow) -> str:
    """Return slope and intercept on a line of their own, nothing where there are none."""
    if row.calibration_slope is None:
        return ""
    return f"\nslope {row.calibration_slope:.2f}, intercept {row.calibration_intercept:.2f}"


def _roc_lines(marks: tuple[Marks, ...]) -> list[plots.RocLine]:
    """Return the curves, features side by side in a panel for each number of bins (Fig. 10).

    Beside several features only the nearest range is drawn of the baselines.
    """
    ours = [one for one in marks if one.row.profile is not None]
    panels = list(dict.fromkeys(_panel(one) for one in ours))
    lines: list[plots.RocLine] = []
    for one in marks:
        if one.curve is None or (_is_baseline(one) and len(ours) > len(panels) + 1):
            continue
        where = panels if one.row.profile is None else [_panel(one)]
        lines.extend(
            plots.RocLine(_curve_name(one), panel, one.curve.fpr, one.curve.tpr, one.row.auc)
            for panel in where
        )
    return lines


def _is_baseline(marks: Marks) -> bool:
    """Tell the fitted baselines from mpap and from the nearest ranges."""
    return marks.row.profile is None and not marks.row.method.startswith("nearest-range")


def _curve_name(marks: Marks) -> str:
    """Name a curve by its feature if it is mpap's, else by its method."""
    return str(marks.row.feature) if marks.row.method == "mpap" else marks.row.method


def _panel(marks: Marks) -> str:
    """Return the panel that a curve of mpap belongs to."""
    return f"profile {marks.row.profile}, {marks.row.bins} bins"


def timelines_of(timeline: Timeline) -> list[plots.Timeline]:
    """Return truth and prediction of each log as they are drawn (Fig. 9)."""
    rows = timeline.sheet.rows
    truth = np.where(timeline.sheet.truth >= 0, timeline.sheet.truth, np.nan)
    p = timeline.prediction.p_collision
    predicted = np.where(np.isnan(p), np.nan, p >= timeline.threshold)
    found = []
    for index, log in enumerate(timeline.logs):
        inside = rows.log_index == index
        time_s = (rows.stamps_ns[inside] - log.start_ns) * 1e-9
        found.append(plots.Timeline(log.name, time_s, truth[inside], predicted[inside], p[inside]))
    return found


def _reliability(marks: Marks) -> plots.Reliability:
    """Return the reliability of one method, all empty if it gives no probabilities."""
    if marks.calibration is None:
        nothing = np.full(N_BINS, np.nan)
        return plots.Reliability(np.zeros(N_BINS, dtype=np.int64), nothing, nothing)
    bins = marks.calibration.bins
    return plots.Reliability(
        np.array([part.scans for part in bins], dtype=np.int64),
        np.array([part.mean_p for part in bins], dtype=np.float64),
        np.array([part.share_positive for part in bins], dtype=np.float64),
    )
