"""``compare``: how much of each log the others explain."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.meeting import known_scans, meet, sensor_to_meet
from mpap_cli.commands.inputs.models import Models
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import (
    Losses,
    Source,
    open_readable,
    open_sources,
    survey_source,
)
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest, settings_from
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.comparing import CompareRow, Comparison
from mpap_cli.observations import Float32Array
from mpap_cli.outputs.compare_plot import plot_comparison
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.outputs.tables import write_csv
from mpap_cli.params import Settings
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.obstacles import KnownExemplars

NOVEL = 4
"""Exit code where the last log is newer than allowed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CompareRequest:
    """Where results go, and how new the last log may be (a share of its observations)."""

    out: Path
    fail_if_novel: float | None = None
    jobs: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """How much of each log was unknown to the others, and where it lies."""

    folder: Path
    sensor: str
    names: list[str]
    rows: list[CompareRow]
    exit_code: int = 0

    @property
    def last_share(self) -> float:
        """Share of the last log that none of the others explains."""
        return self.rows[-1].percent_unknown / 100


def compare(
    selection: LogSelection,
    settings: SettingsRequest,
    request: CompareRequest,
    progress: Progress = no_progress,
) -> Compared:
    """Learn each log alone, then tell how much of each log the models of the others explain.

    Parameters
    ----------
    selection : LogSelection
        Two logs or more; images are taken if every log has them, else scans.
    settings : SettingsRequest
        Profile and settings.
    request : CompareRequest
        Results folder, and how new the last log may be.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Compared
        Each log against each other; exit code 4 if more than ``fail_if_novel`` of the last
        log is unknown to all others together, else 3 if part of the input was left out.

    Raises
    ------
    LogError
        If no log can be read.
    UsageError
        If fewer than two logs are left, or one lacks the sensor.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    chosen = settings_from(settings)
    if selection.sensor == "auto":
        selection = replace(selection, sensor=sensor_to_meet(selection, Models(chosen)))
    losses, inputs = Losses(), list[InputFile]()
    with one_thread_each(), ResultsFolder(request.out, "compare") as results:
        learnt: list[tuple[Source, KnownExemplars]] = []
        for source in open_sources(selection, chosen, losses):
            learnt.append((source, _learn(source, selection.sensor, chosen, request, progress)))
            inputs.append(describe_input(source.path))
        names = [source.name for source, _ in learnt]
        if len(names) == 1:
            msg = f"compare: found one log that can be read ({names[0]}), expected two or more"
            raise UsageError(msg)
        comparison = Comparison(names, [known for _, known in learnt])
        for index, (source, _) in enumerate(learnt):
            for features in _look(source, selection, chosen, request, progress):
                comparison.add(index, features)
        rows = comparison.rows()
        write_csv(results.path("compare.csv"), CompareRow, rows)
        plot_comparison(results.path("compare.png"), names, comparison.shares())
        results.commit(selection.values(chosen), inputs, chosen.affinity.seed)
    redraw(request.out)
    found = Compared(folder=results.folder, sensor=selection.sensor, names=names, rows=rows)
    is_new = request.fail_if_novel is not None and found.last_share > request.fail_if_novel
    return replace(found, exit_code=NOVEL if is_new else losses.exit_code)


def _learn(
    source: Source, sensor: str, settings: Settings, request: CompareRequest, progress: Progress
) -> KnownExemplars:
    """Learn one log alone and return what it can explain."""
    models = Models(settings)
    for _ in meet(models, source, sensor, request.jobs, progress):
        pass
    if models.appearance is not None:
        return models.appearance.known()
    if models.collision is not None:
        return known_scans(models.collision.meta_points)
    return KnownExemplars(np.zeros((0, 0), dtype=np.float32), 0.0)


def _look(
    learnt: Source,
    selection: LogSelection,
    settings: Settings,
    request: CompareRequest,
    progress: Progress,
) -> Iterator[Float32Array]:
    """Read a log once more, its findings told before, and yield features (n, d) of it."""
    reader = open_readable(learnt.path, selection)
    with reader:
        source = survey_source(reader, learnt.index, selection, settings, None)
        if selection.sensor == "image":
            images = AppearanceModel(settings)
            for _, patches in follow(source, request.jobs, progress, "compare", images.embed):
                if patches is not None:
                    yield patches.features.reshape(-1, patches.features.shape[-1])
            return
        scans = CollisionModel(settings)
        scans.begin_log(source.start)
        for batch, _ in follow(source, request.jobs, progress, "compare"):
            yield from (scans.embed(block).features for block in batch.scans)
