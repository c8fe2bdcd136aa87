"""``learn --merge``: a leaf model of each log, in parallel, merged into one."""

import logging
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from mpap_cli import __version__
from mpap_cli.commands.fleet.identity import Sighting, definitions_digest, sight
from mpap_cli.commands.fleet.joining import join_recordings, merge_leaves
from mpap_cli.commands.fleet.leaves import clear_private
from mpap_cli.commands.fleet.manifest import MANIFEST, Manifest
from mpap_cli.commands.fleet.run import Fleet
from mpap_cli.commands.fleet.tasks import LeafTask
from mpap_cli.commands.inputs.hints import tell_of_model
from mpap_cli.commands.inputs.models import Models
from mpap_cli.commands.inputs.press_file import press_inputs, presses_by_hand
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import DAMAGED
from mpap_cli.commands.learning.exemplars import draw_exemplars
from mpap_cli.commands.learning.summary import Learnt, write_learnt
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest, config, settings_from
from mpap_cli.errors import LogError, UsageError
from mpap_cli.logs.reader import LogPath
from mpap_cli.outputs.exemplar_file import EXEMPLARS_NAME, write_exemplar_file
from mpap_cli.outputs.recording import RECORDING_NAME
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.text_table import count
from mpap_cli.params import Settings
from mpap_cli.properties.press_files import PressRow
from mpap_cli.systems.collision import CollisionModel

LOGGER = logging.getLogger(__name__)
LEAVES = "leaves"


@dataclass(frozen=True, slots=True, kw_only=True)
class MergeRequest:
    """What ``learn --merge`` shall do beside reading logs with settings.

    ``jobs`` processes learn leaves (1: this one), or the workers of a Dask ``scheduler``;
    results do not depend on either. Leaves are kept in ``OUT/leaves``.
    """

    out: Path
    keep_recording: bool = True
    jobs: int = 2
    scheduler: str | None = None


def learn_merged(
    selection: LogSelection, settings: SettingsRequest, request: MergeRequest
) -> Learnt:
    """Learn a collision model of each log apart, and merge them.

    Parameters
    ----------
    selection : LogSelection
        Logs in any order: the result is the same.
    settings : SettingsRequest
        Profile and settings, settled once for all logs; the reference of a meta-point is
        its exemplar unless another is asked for.
    request : MergeRequest
        Results folder, workers.

    Returns
    -------
    Learnt
        Clusters and counts of the merged model; exit code 3 if a log or a part of one was
        left out.

    Raises
    ------
    LogError
        If no log can be learnt, or with ``strict`` if one cannot.
    UsageError
        If images are asked for, or what is asked for fits none of the logs.
    MpapError
        If no scheduler answers.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    if selection.sensor in {"image", "both"}:
        msg = f"--merge learns from laser scans only; leave out --sensor {selection.sensor}"
        raise UsageError(msg)
    selection = replace(selection, sensor="scan")
    chosen = selection.settings_for(_settled(settings))
    with one_thread_each(), ResultsFolder(request.out, "learn") as results:
        fleet = _fleet(selection, chosen, request)
        fleet.learn(request.jobs, request.scheduler)
        _tell_of_leaves(fleet)
        _require_leaves(fleet, strict=selection.strict)
        merged = merge_leaves(list(fleet.leaves.values()))
        learnt = _write(results, merged, fleet, request)
        inputs = [leaf.log for leaf in fleet.leaves.values()] + press_inputs(selection)
        inputs.sort(key=lambda one: (one.name, one.sha256))
        values = {**selection.values(chosen), "merge": True}
        results.commit(values, inputs, chosen.affinity.seed)
    redraw(request.out)
    return learnt


def _settled(request: SettingsRequest) -> Settings:
    """Return the settings of all leaves: models that are merged refer to exemplars."""
    chosen = settings_from(request)
    origin = next(row.origin for row in config(request) if row.key == "reference")
    if origin != "default" and not origin.startswith("profile"):
        return chosen
    return replace(chosen, meta_point=replace(chosen.meta_point, reference="exemplar"))


def _fleet(selection: LogSelection, settings: Settings, request: MergeRequest) -> Fleet:
    """Make the tasks of all logs, and their manifest."""
    folder = (request.out / LEAVES).absolute()
    folder.mkdir(exist_ok=True)
    clear_private(folder)
    paths = [path.absolute() for path in selection.paths()]
    seen = [_seen(path) for path in paths]
    try:
        manifest = Manifest(folder, [path.name for path in paths], seen)
    except OSError:
        with suppress(OSError):  # not empty: there are leaves
            folder.rmdir()
        raise
    presses = presses_by_hand(selection, paths)
    definitions = definitions_digest(selection.msgs)
    msgs = tuple(path.absolute() for path in selection.msgs)
    tasks = [
        LeafTask(
            number=number,
            path=path,
            described=manifest.known(number, seen[number]),
            leaves=folder,
            selection=replace(selection, logs=(), msgs=msgs),
            settings=settings,
            presses=None if presses is None else _presses_of(presses, number, path),
            definitions=definitions,
            keep_recording=request.keep_recording,
            version=__version__,
        )
        for number, path in enumerate(paths)
    ]
    return Fleet(tasks, manifest)


def _seen(path: LogPath) -> Sighting | None:
    try:
        return sight(path)
    except LogError:
        return None  # told by who tries to read it


def _presses_of(
    presses: dict[str, tuple[PressRow, ...]], number: int, path: LogPath
) -> tuple[PressRow, ...]:
    """Return the rows of one log, which is the only one of its leaf."""
    mine = (row for row in presses.get(path.name, ()) if row.log_index in {None, number})
    return tuple(replace(row, log_index=None) for row in mine)


def _tell_of_leaves(fleet: Fleet) -> None:
    """Say what was odd about the logs, in an order of their own, and what is missing."""
    leaves = sorted(fleet.leaves.items(), key=lambda item: str(fleet.tasks[item[0]].path))
    for number, leaf in leaves:
        for text in leaf.facts.warnings if number not in fleet.told else ():
            LOGGER.warning("%s", text)
    n_images = sum(leaf.facts.has_images for _, leaf in leaves)
    if n_images:
        said = count(n_images, "log")
        LOGGER.info("images of %s are left out: --merge learns from laser scans only", said)
    if fleet.missing:
        missing, asked = count(len(fleet.missing), "log"), len(fleet.tasks)
        again = "the same command again tries them, and only them"
        LOGGER.warning("left out: %s of %d (%s); %s", missing, asked, _names(fleet), again)


def _names(fleet: Fleet) -> str:
    return ", ".join(sorted(fleet.tasks[number].name for number in fleet.missing))


def _require_leaves(fleet: Fleet, *, strict: bool) -> None:
    """Refuse to go on without a leaf, or with --strict without one of them."""
    outcomes = list(fleet.missing.values())
    if not fleet.leaves and outcomes:
        if all(outcome.exit_code == UsageError.exit_code for outcome in outcomes):
            raise UsageError(outcomes[0].reason)
        none = f"none of the {len(outcomes)} logs could be learnt: {_names(fleet)}"
        msg = f"{none}; {LEAVES}/{MANIFEST} says why"
        raise LogError(msg)
    if strict and outcomes:
        msg = f"--strict: {_names(fleet)} could not be learnt; {LEAVES}/{MANIFEST} says why"
        raise LogError(msg)
    if not sum(leaf.facts.n_scans for leaf in fleet.leaves.values()):
        msg = "no scan could be used; check --start, --end, --scan-topic and --fov"
        raise UsageError(msg)


def _write(
    results: ResultsFolder, merged: CollisionModel, fleet: Fleet, request: MergeRequest
) -> Learnt:
    """Write the merged model, its table and pictures, and the recording of all logs."""
    models = Models(merged.settings, merged)
    damaged = any(leaf.facts.damaged for leaf in fleet.leaves.values())
    code = DAMAGED if fleet.missing or damaged else 0
    learnt = write_learnt(results, models, code)
    tell_of_model(merged)
    if request.keep_recording:
        recording = results.path(RECORDING_NAME)
        placed = [(fleet.tasks[number].path, leaf) for number, leaf in fleet.leaves.items()]
        join_recordings(recording, placed)
        # no log is read again for the image of a moment
        nothing = LogSelection()
        pictures = draw_exemplars(
            results.path("exemplars.png"), learnt.clusters, recording, nothing
        )
        write_exemplar_file(results.path(EXEMPLARS_NAME), pictures, [])
    return learnt
