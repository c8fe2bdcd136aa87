"""Segments that are new: to a model, or to the past of the logs themselves."""

import logging
import math
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.commands.extracting.events import found_log
from mpap_cli.commands.extracting.request import ExtractRequest, Found
from mpap_cli.commands.extracting.sightings import Seen, SightingsLog
from mpap_cli.commands.inputs.meeting import known_scans, meet, sensor_to_meet
from mpap_cli.commands.inputs.models import Models, begin_models
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, open_sources
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.coverage import Asked, Chosen, choose_cells
from mpap_cli.evaluation.keeping import Moment, merge, widen
from mpap_cli.observations import NS_PER_S, BoolArray, IntArray
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.results_reader import describe_input

LOGGER = logging.getLogger(__name__)
_CELL_S = {"scan": 1.0, "image": 0.5}  # features of scans look back a second


def find_novel(
    selection: LogSelection,
    settings: SettingsRequest,
    request: ExtractRequest,
    model: Path | None,
    progress: Progress,
) -> Found:
    """Find what is new in logs to a model, or without one to what came before in the logs.

    Parameters
    ----------
    selection, settings : LogSelection, SettingsRequest
        Logs in order; with a model its own settings count.
    request : ExtractRequest
        How much is kept.
    model : Path or None
        What is known before.
    progress : Progress
        Told how far each log is.

    Returns
    -------
    Found
        By ``keep_ratio`` the segments from which most of what is new can be learnt
        (:mod:`mpap_cli.evaluation.coverage`), else every second of scans,
        or half second of images, of which ``threshold`` was
        new when it came.
    """
    models = begin_models(selection, settings, model)
    if selection.sensor == "auto":
        selection = replace(selection, sensor=sensor_to_meet(selection, models))
    if selection.sensor == "image" and request.lookback_s is None:
        request = replace(request, lookback_s=0.0)  # patches do not look back
    losses, found = Losses(), Found()
    if selection.sensor not in {"scan", "image"}:
        msg = f"--sensor {selection.sensor}: --novel looks at scans or at images; choose one"
        raise UsageError(msg)
    seen = SightingsLog(
        round(_CELL_S[selection.sensor] * NS_PER_S), _radius(models, selection.sensor)
    )
    for source in open_sources(selection, models.settings, losses):
        found.logs.append(found_log(source))
        seen.begin_log(*found.bounds[-1])
        for met in meet(models, source, selection.sensor, request.jobs, progress):
            seen.add(met)
        found.inputs.append(describe_input(source.path))
    if model is not None:
        found.inputs.append(describe_input(find_model(model)))
    found.values = {**selection.values(models.settings), **request.margin_values}
    found.seed, found.exit_code = models.settings.affinity.seed, losses.exit_code
    if request.keep_ratio is None:
        moments = seen.novel_moments(request.level)
        found.segments = merge(widen(moments, request.margins, found.bounds))
    else:
        meeting = _Meeting(models, selection.sensor, seen)
        found.segments = _most_worthwhile(meeting, request, found)
    return found


def _radius(models: Models, sensor: str) -> float:
    """Return how near to its first one the observations of a place are.

    Any two of them are as near to one another as what explains is to what it explains.
    """
    settings = models.settings
    return 0.5 * (settings.strap.eps if sensor == "image" else settings.meta_point.theta)


@dataclass(frozen=True, slots=True)
class _Meeting:
    """Models that have met the logs with one sensor, and what they saw."""

    models: Models
    sensor: str
    seen: SightingsLog

    @property
    def enough(self) -> int:
        """So many sightings teach a place."""
        return self.models.settings.meta_point.min_points if self.sensor == "scan" else 1

    @property
    def context(self) -> int:
        """So many cells before one are needed for what features show in it."""
        return 1 if self.sensor == "scan" else 0

    def clusters_of(self, ids: IntArray) -> IntArray:
        """Return the clusters of places as learning the same logs numbers them, -1 for none."""
        if self.sensor == "image" and self.models.appearance is not None:
            return self.models.appearance.parts().coarse_of(ids)
        if self.sensor == "scan" and self.models.collision is not None:
            return self.models.collision.parts().clustered.clusters_of(ids)
        return np.full(ids.size, -1, np.int64)


def _most_worthwhile(meeting: _Meeting, request: ExtractRequest, found: Found) -> list[Moment]:
    """Return the segments that teach most of what is new, within the ratio."""
    seen = meeting.seen.seen()
    sightings = seen.sightings
    if not seen.ids.size:
        return []
    weight = np.bincount(sightings.places, sightings.counts).astype(np.float64)
    budget_ns = int((request.keep_ratio or 1.0) * found.length_ns)
    before, after = _margins(request, budget_ns, _CELL_S[meeting.sensor])
    asked = Asked(
        before=before,
        after=after,
        budget_ns=budget_ns,
        context=min(before, meeting.context),
        enough=meeting.enough,
    )
    explain = partial(_explained, meeting, seen) if meeting.sensor == "scan" else None
    chosen = choose_cells(sightings, weight, asked, explain)
    clusters = meeting.clusters_of(seen.ids)
    return [
        _segment(meeting.seen, chosen, clusters, int(sightings.log_index[run[0]]), run)
        for run in _runs(chosen, sightings.log_index)
    ]


def _explained(meeting: _Meeting, seen: Seen, cells: BoolArray) -> BoolArray:
    """Tell which places of scans a model explains that learns what some cells show."""
    shown, params = seen.shown_in(cells), meeting.models.settings.meta_point
    points = MetaPoints(params, seen.exemplars.shape[1])
    points.add_data_points(shown, np.zeros(len(shown), np.int64))
    return ~known_scans(points).unknown(seen.exemplars)


def _margins(request: ExtractRequest, budget_ns: int, cell_s: float) -> tuple[int, int]:
    """Return how many cells are kept before and after one; fewer if none would fit."""
    before, after = (math.ceil(margin_s / cell_s) for margin_s in (request.lookback, request.post))
    most = int(budget_ns / NS_PER_S / cell_s) - 1
    if most < 0:
        msg = f"--keep-ratio {request.keep_ratio:g}: less than {cell_s:g} s of the logs; keep more"
        raise UsageError(msg)
    if before + after > most:
        share = most / (before + after)
        before, after = int(before * share), int(after * share)
        LOGGER.warning(
            "--keep-ratio %g: shorter than one segment; %g s are kept before and %g s after",
            request.keep_ratio,
            before * cell_s,
            after * cell_s,
        )
    return before, after


def _runs(chosen: Chosen, log_index: IntArray) -> list[IntArray]:
    """Return the cells of each segment: kept ones of one log that follow one another."""
    kept = np.flatnonzero(chosen.kept)
    breaks = (np.diff(kept) > 1) | (np.diff(log_index[kept]) > 0)
    return [run for run in np.split(kept, np.flatnonzero(breaks) + 1) if run.size]


def _segment(
    seen: SightingsLog, chosen: Chosen, clusters: IntArray, log_index: int, run: IntArray
) -> Moment:
    """Return a segment; its score is the share of all that is new which it adds."""
    best = int(chosen.best[run[chosen.gains[run].argmax()]])
    cluster = int(clusters[best]) if best >= 0 else -1
    start_ns, end_ns = seen.bounds_of(log_index, int(run[0]), int(run[-1]) + 1)
    score = float(chosen.gains[run].sum())
    return Moment(log_index, start_ns, end_ns, score, cluster if cluster >= 0 else None)
