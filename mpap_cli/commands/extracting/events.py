"""Moments of contact: presses, collisions that are predicted, and where the two part."""

import logging
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from mpap_cli.commands.evaluating.observed import drop_recording, observe_logs
from mpap_cli.commands.extracting.request import (
    FALSE_ALARMS,
    MISSED,
    PREDICTED,
    ExtractRequest,
    Found,
    FoundLog,
)
from mpap_cli.commands.inputs.models import load_collision_model
from mpap_cli.commands.inputs.press_file import press_inputs
from mpap_cli.commands.inputs.press_tracking import LogPresses
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, Source, open_sources
from mpap_cli.commands.settings import SettingsRequest, settings_from
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.keeping import Moment, best_within, merge, widen
from mpap_cli.evaluation.leads import GAP_NS, PressJudge
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.timelines import Timeline
from mpap_cli.observations import NS_PER_S, Press
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import describe_input

LOGGER = logging.getLogger(__name__)
_NO_BUMPER = (
    "%s: nothing tells of presses, so none is %s; name them with --bump-topic or --bump-from"
)


def found_log(source: Source) -> FoundLog:
    """Describe a log that is being replayed."""
    replay = source.replay
    return FoundLog(
        source.name, source.path, source.start.start_ns, replay.start_ns, replay.end_ns + 1
    )


def find_presses(
    selection: LogSelection, settings: SettingsRequest, request: ExtractRequest, progress: Progress
) -> Found:
    """Find the presses of every log; the longer, the more they are worth."""
    made, losses, found = settings_from(settings), Losses(), Found()
    moments: list[Moment] = []
    for source in open_sources(selection, made, losses, required=False):
        presses = LogPresses(source, made.bumper)
        for batch, _ in follow(source, request.jobs, progress, "read"):
            presses.add(batch)
        index, known = len(found.logs), presses.end()
        found.logs.append(found_log(source))
        if known is None:
            LOGGER.warning(_NO_BUMPER, source.name, "kept")
        moments += [
            Moment(index, press.start_ns, press.end_ns, (press.end_ns - press.start_ns) / NS_PER_S)
            for press in known or ()
        ]
        found.inputs.append(describe_input(source.path))
    found.inputs += press_inputs(selection)
    found.values = {**selection.values(made), **request.margin_values}
    found.seed, found.exit_code = made.affinity.seed, losses.exit_code
    found.segments = keep(moments, request, found)
    return found


def keep(moments: list[Moment], request: ExtractRequest, found: Found) -> list[Moment]:
    """Add the margins, and keep what fits into the ratio, if one was given."""
    widened = widen(moments, request.margins, found.bounds)
    if request.keep_ratio is None:
        return merge(widened)
    kept = best_within(widened, int(request.keep_ratio * found.length_ns))
    if widened and not kept:
        LOGGER.warning(
            "--keep-ratio %g: no segment fits with its %g s before and %g s after; "
            "give less with --lookback and --post, or keep more",
            request.keep_ratio,
            request.lookback,
            request.post,
        )
    return kept


def find_predicted(
    selection: LogSelection,
    request: ExtractRequest,
    model: Path,
    results: ResultsFolder,
    progress: Progress,
) -> Found:
    """Find what a model of scans announces, misses, or announces in vain."""
    learnt = load_collision_model(model)
    if selection.sensor == "image":
        msg = "--sensor image: collisions are predicted from scans; leave it out"
        raise UsageError(msg)
    observed = observe_logs(
        selection.with_sensor_of("scan"), learnt.settings, results, request.jobs, progress
    )
    question = Question(logs=observed.logs, threshold=request.level, model=learnt)
    variant = Variant("mpap", learnt.settings)
    timeline = evaluate_all(question, [variant], baselines=False).timeline
    drop_recording(results)
    logs = [
        FoundLog(log.name, Path(log.path), log.start_ns, log.start_ns, log.end_ns + 1)
        for log in observed.logs
    ]
    found = Found(
        logs=logs,
        inputs=[*observed.inputs, describe_input(find_model(model))],
        values={**selection.values(learnt.settings), **request.margin_values},
        seed=learnt.settings.affinity.seed,
        exit_code=observed.exit_code,
    )
    moments = [
        moment
        for index in range(len(logs))
        for moment in _PREDICTED[request.reason](timeline, index, request.level)
    ]
    found.segments = keep(moments, request, found)
    return found


def _announced(timeline: Timeline, index: int, level: float) -> Iterator[Moment]:
    """Yield the runs of scans of a log with a probability from the level up."""
    rows = np.flatnonzero(timeline.sheet.rows.log_index == index)
    stamps_ns = timeline.sheet.rows.stamps_ns[rows]
    above = np.flatnonzero(timeline.prediction.p_collision[rows] >= level)
    breaks = (np.diff(above) > 1) | (np.diff(stamps_ns[above]) > GAP_NS)
    for run in np.split(above, np.flatnonzero(breaks) + 1):
        if run.size:
            yield _run(timeline, index, rows[run[0] : run[-1] + 1].tolist())


def _run(timeline: Timeline, index: int, rows: list[int]) -> Moment:
    """Return the moment of a run of scans; its best scan gives score and cluster."""
    found, stamps_ns = timeline.prediction, timeline.sheet.rows.stamps_ns
    best = rows[int(np.argmax(found.p_collision[rows]))]
    cluster = int(found.cluster[best])
    return Moment(
        index,
        int(stamps_ns[rows[0]]),
        int(stamps_ns[rows[-1]]) + 1,
        float(found.p_collision[best]),
        cluster if cluster >= 0 else None,
    )


def _false_alarms(timeline: Timeline, index: int, level: float) -> Iterator[Moment]:
    """Yield the runs of a log that no contact follows."""
    presses = _known_presses(timeline, index, "a false alarm")
    if presses is None:
        return
    rows = np.flatnonzero(timeline.sheet.rows.log_index == index)
    p = timeline.prediction.p_collision[rows]
    judge = PressJudge(timeline.sheet.rows.stamps_ns[rows], p, presses)
    for first, behind in judge.false_runs(level):
        yield _run(timeline, index, rows[first:behind].tolist())


def _missed(timeline: Timeline, index: int, _level: float) -> Iterator[Moment]:
    """Yield the presses of a log that were not announced; the surer it was of none, the better."""
    presses = _known_presses(timeline, index, "missed") or ()
    found, scans = timeline.prediction, timeline.sheet.rows
    rows = np.flatnonzero(scans.log_index == index)
    for press, lead in zip(presses, timeline.leads[index], strict=True):
        if lead.predicted is False:
            last = rows[np.searchsorted(scans.stamps_ns[rows], press.start_ns, side="right") - 1]
            cluster = int(found.cluster[last])
            score = 1.0 - float(found.p_collision[last])
            known = cluster if cluster >= 0 else None
            yield Moment(index, press.start_ns, press.end_ns, score, known)


def _known_presses(timeline: Timeline, index: int, what: str) -> tuple[Press, ...] | None:
    """Return the presses of a log; None, and a warning, where nothing tells of them."""
    log = timeline.logs[index]
    if log.presses is None:
        LOGGER.warning(_NO_BUMPER, log.name, what)
    return log.presses


_PREDICTED: dict[str, Callable[[Timeline, int, float], Iterator[Moment]]] = {
    PREDICTED: _announced,
    MISSED: _missed,
    FALSE_ALARMS: _false_alarms,
}
