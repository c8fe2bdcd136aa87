"""The leaf model of one log: learnt in whichever process, written whole or not at all."""

import hashlib
import json
import logging
import os
import shutil
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from mpap_cli import __version__
from mpap_cli.commands.fleet.identity import describe_log
from mpap_cli.commands.fleet.tasks import Leaf, LeafFacts, LeafTask, Outcome
from mpap_cli.commands.inputs.hints import tell_of_heading
from mpap_cli.commands.inputs.models import Models, save_models
from mpap_cli.commands.inputs.progress import no_progress
from mpap_cli.commands.inputs.sources import (
    Losses,
    open_readable,
    survey_source,
    tell_of_source,
)
from mpap_cli.commands.learning.models_in_progress import learn_log
from mpap_cli.commands.learning.recorder import Recorder
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.errors import MpapError, OutputError, UsageError
from mpap_cli.logs.topics import choose_roles
from mpap_cli.outputs import model_file, recording
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, read_results
from mpap_cli.systems import model_parts

_FACTS = "facts.json"
ONLY_IMAGES = "has images but no scan topic, and --merge learns from laser scans only"
_FORMATS = (model_file.VERSION, model_parts.VERSION, recording.VERSION)
_KEY_DIGITS = 32


def learn_leaf(task: LeafTask) -> Outcome:
    """Learn one log into a folder of its own, unless a whole leaf of it is there.

    Parameters
    ----------
    task : LeafTask
        The log, the settings, and where leaves lie.

    Returns
    -------
    Outcome
        The leaf, or why there is none. What a user can mend is not raised: one log that
        fails stops no other.
    """
    keep_kernels_writable()
    if task.version != __version__:
        reason = f"the worker runs mpap {__version__}, this is {task.version}; install the same"
        return Outcome(reason=reason)
    with _warnings() as told:
        try:
            return _learn_missing(task, told)
        except MpapError as error:
            return Outcome(reason=str(error), exit_code=error.exit_code)
        except (OSError, MemoryError) as error:
            found = getattr(error, "strerror", None) or str(error) or "out of memory"
            return Outcome(reason=f"{task.name}: {found.lower()}")


def _leaf_key(task: LeafTask, log: InputFile) -> str:
    """Return what names a leaf: the log's content and all else that can change the leaf."""
    said = {
        "versions": [__version__, *_FORMATS],
        "log": asdict(log),
        "settings": task.selection.values(task.settings),
        "presses": task.presses and [(one.start_ns, one.end_ns) for one in task.presses],
        "definitions": task.definitions,
    }
    text = json.dumps(said, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:_KEY_DIGITS]


def find_leaf(task: LeafTask, log: InputFile) -> Leaf | None:
    """Return the leaf of a log if it is there and whole, with a recording if one is wanted."""
    folder = task.leaves / _leaf_key(task, log)
    try:
        results = read_results(folder)
        record = json.loads(results.path(_FACTS).read_text(encoding="utf-8"))
        facts = LeafFacts(**{**record, "warnings": tuple(record["warnings"])})
    except (OutputError, OSError, ValueError, TypeError, KeyError):
        return None  # learnt again, whatever is wrong with it
    wanted = {model_file.MODEL_NAME, *([recording.RECORDING_NAME] * task.keep_recording)}
    return Leaf(folder=folder, log=log, facts=facts) if wanted <= results.outputs.keys() else None


def _learn_missing(task: LeafTask, told: list[str]) -> Outcome:
    """Learn the log if there is no leaf of it."""
    log = task.described or describe_log(task.path)
    leaf = find_leaf(task, log)
    if leaf is not None:
        return Outcome(leaf=leaf, reused=True)
    key = _leaf_key(task, log)
    # a folder of one's own: a worker that outlived its run may be at the same log
    private = Path(tempfile.mkdtemp(prefix=f".{key}.", dir=task.leaves))
    try:
        with one_thread_each(), ResultsFolder(private, key) as results:
            facts = _learn(task, results, told)
            text = json.dumps(asdict(facts), indent=2) + "\n"
            results.path(_FACTS).write_text(text, encoding="utf-8")
            values = task.selection.values(task.settings)
            results.commit(values, [log], task.settings.affinity.seed)
        leaf = _put_in_place(task, private / key, log)
    finally:
        shutil.rmtree(private, ignore_errors=True)
    return Outcome(leaf=leaf)


def _put_in_place(task: LeafTask, made: Path, log: InputFile) -> Leaf:
    """Give a finished leaf its name, unless another worker was first."""
    leaf = find_leaf(task, log)
    if leaf is None:
        target = task.leaves / made.name
        shutil.rmtree(target, ignore_errors=True)
        made.rename(target)
        leaf = find_leaf(task, log)
    if leaf is None:
        msg = f"{task.leaves / made.name}: the leaf does not stay as it was written"
        raise OutputError(msg)
    return leaf


def _learn(task: LeafTask, results: ResultsFolder, told: list[str]) -> LeafFacts:
    """Replay the log into a model and a recording."""
    began_s = time.perf_counter()
    selection, losses = task.selection, Losses()
    models = Models(selection.settings_for(task.settings))
    by_hand = None if task.presses is None else {task.name: task.presses}
    path = results.path(recording.RECORDING_NAME)
    with open_readable(task.path, selection) as reader, Recorder(path) as recorder:
        roles = choose_roles(reader, selection.topic_choice)
        has_images = roles.image is not None or bool(roles.image_candidates)
        if has_images and roles.scan is None and not roles.scan_candidates:
            msg = f"{task.name}: {ONLY_IMAGES}; mpap learn without --merge learns from images"
            raise UsageError(msg)
        source = survey_source(reader, 0, selection, models.settings, by_hand)
        tell_of_source(source)
        learn_log(models, recorder, source, 1, no_progress)
        losses.note(source)
    collision = models.collision
    assert collision is not None  # noqa: S101  # scans are required
    collision.finish()
    save_models(results.path(model_file.MODEL_NAME), models)
    if recorder.headings_assumed:
        tell_of_heading(recording.read_recording(path), models.settings.scan)
    if not task.keep_recording:
        path.unlink()
    return LeafFacts(
        n_scans=sum(log.n_observations for log in collision.logs),
        n_presses=collision.logs[0].n_presses,
        seconds=round(time.perf_counter() - began_s, 3),
        damaged=losses.exit_code != 0,
        has_images=has_images,
        warnings=tuple(told),
    )


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """Collect the warnings of this thread; a worker's may share its process with others."""
    told: list[str] = []
    thread = threading.get_ident()

    class Collector(logging.Handler):
        """Keeps the texts."""

        def emit(self, record: logging.LogRecord) -> None:
            """Keep one text."""
            if record.thread == thread:
                told.append(record.getMessage())

    collector = Collector(logging.WARNING)
    logger = logging.getLogger("mpap_cli")
    logger.addHandler(collector)
    try:
        yield told
    finally:
        logger.removeHandler(collector)


def clear_private(leaves: Path) -> None:
    """Remove what workers that were killed left of their leaves."""
    for left in leaves.glob(f".{'[0-9a-f]' * _KEY_DIGITS}.*"):
        if left.is_dir() and not left.is_symlink() and os.access(left, os.W_OK):
            shutil.rmtree(left, ignore_errors=True)
