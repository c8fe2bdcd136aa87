"""Predictions as a log that viewers open beside the original: values, images and events."""

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext

import numpy as np

from mpap_cli.commands.predicting.image_decisions import JudgedLog
from mpap_cli.evaluation.alarms import BEGINS
from mpap_cli.evaluation.timelines import Timeline
from mpap_cli.logs.writing.event_log import EventLogWriter
from mpap_cli.observations import BoolArray, IntArray, Press
from mpap_cli.outputs.file_names import file_name
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.systems.decision import ACTIONS

COLLISION_TOPIC, DECISION_TOPIC, IMAGE_TOPIC = (
    "/mpap/collision",
    "/mpap/decision",
    "/mpap/annotated",
)


def prediction_log(
    results: ResultsFolder, log_index: int, name: str, *, wanted: bool
) -> AbstractContextManager[EventLogWriter | None]:
    """Open the log of predictions for one log; None if it is not wanted.

    Parameters
    ----------
    results : ResultsFolder
        Where it goes, as ``INDEX-NAME.mcap``.
    log_index : int
        Which log it is about.
    name : str
        Base name of that log.
    wanted : bool
        Whether ``--to-mcap`` was asked for.
    """
    if not wanted:
        return nullcontext(None)
    return EventLogWriter(results.path(file_name(f"{log_index}-{name}", ".mcap")))


def write_scan_logs(results: ResultsFolder, timeline: Timeline) -> None:
    """Write the logs of predictions where there are scans only."""
    for index, log in enumerate(timeline.logs):
        with prediction_log(results, index, log.name, wanted=True) as writer:
            if writer is not None:
                write_scan_predictions(writer, timeline, index)


def write_scan_predictions(writer: EventLogWriter, timeline: Timeline, log_index: int) -> None:
    """Write the probability at every scan of one log, presses, and what was announced."""
    found, scans = timeline.prediction, timeline.sheet.rows
    rows = np.flatnonzero(scans.log_index == log_index)
    stamps_ns = scans.stamps_ns[rows]
    for row, stamp_ns in zip(rows.tolist(), stamps_ns.tolist(), strict=True):
        values = {
            "p_collision": float(found.p_collision[row]),
            "p_cluster": float(found.p_cluster[row]),
            "cluster": float(found.cluster[row]),
            "distance": float(found.distance[row]),
            "novel": float(found.novel[row]),
        }
        writer.value(COLLISION_TOPIC, stamp_ns, values)
    write_presses(writer, timeline.presses[log_index])
    announced = found.p_collision[rows] >= timeline.threshold
    write_runs(writer, stamps_ns, announced, "collision predicted")
    if timeline.alarms is not None:
        raised = timeline.alarms.levels[rows] >= BEGINS
        write_runs(writer, stamps_ns, raised, "alarm")


def write_decisions(writer: EventLogWriter, judged: JudgedLog) -> None:
    """Write the decision at every image of one log, and where it would not have gone on."""
    for row in judged.rows():
        values: dict[str, float | str | None] = {
            "action": row.action,
            "obstacle_patches": row.obstacle_patches,
            "unknown_patches": row.unknown_patches,
            "nearest_ahead_m": row.nearest_ahead_m,
        }
        writer.value(DECISION_TOPIC, row.stamp_ns, values)
    for number, action in enumerate(ACTIONS[1:], start=1):
        write_runs(writer, judged.table[:, 0], judged.table[:, 1] == number, action)


def write_presses(writer: EventLogWriter, presses: Sequence[Press]) -> None:
    """Write every press as an event."""
    for press in presses:
        writer.event(press.start_ns, press.end_ns - press.start_ns, {"kind": "press"})


def write_runs(writer: EventLogWriter, stamps_ns: IntArray, holds: BoolArray, kind: str) -> None:
    """Write an event for each stretch of observations (n,) at which something holds."""
    edges = np.flatnonzero(np.diff(holds, prepend=False, append=False))
    for first, behind in edges.reshape(-1, 2).tolist():
        start_ns, end_ns = int(stamps_ns[first]), int(stamps_ns[behind - 1])
        writer.event(start_ns, end_ns - start_ns, {"kind": kind})
