"""The models on their way through the logs of ``learn``."""

import logging
from collections.abc import Iterator, Sequence

from mpap_cli.commands.inputs.hints import tell_of_presses
from mpap_cli.commands.inputs.models import Models
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.replaying import follow, follow_in_parts
from mpap_cli.commands.inputs.sources import Source
from mpap_cli.commands.learning.recorder import Recorder
from mpap_cli.features.scans.scan_features import FEW_BEAMS
from mpap_cli.observations import Batch, Press
from mpap_cli.outputs.text_table import count
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogSource

LOGGER = logging.getLogger(__name__)


def learn_log(
    models: Models, recorder: Recorder, source: Source, jobs: int, progress: Progress
) -> None:
    """Replay one log through the models of its sensors, and into the recording.

    A model is made with the first log that has its sensor.
    """
    if "scan" in source.sensors and models.collision is None:
        models.collision = CollisionModel(models.settings)
    if "image" in source.sensors and models.appearance is None:
        models.appearance = AppearanceModel(models.settings)
    collision = models.collision if "scan" in source.sensors else None
    appearance = models.appearance if "image" in source.sensors else None
    for model in (collision, appearance):
        if model is not None:
            _tell_of_twice(source, model.logs)
            model.begin_log(source.start)
    recorder.begin_log()
    n_scans = n_learnt = 0
    for batch in _batches(source, appearance, jobs, progress):
        recorder.record(batch)
        if collision is not None:
            learnt = collision.observe(batch)
            n_scans += sum(len(block.stamps_ns) for block in batch.scans)
            n_learnt += sum(len(block.ids) for block in learnt)
        if appearance is not None:
            appearance.settle(batch.bumps, batch.poses, batch.until_ns)
    source.skipped[FEW_BEAMS] += n_scans - n_learnt
    presses = _end(source, collision, appearance)
    recorder.end_log(source, presses)
    tell_of_presses(source, presses, recorder.scan_span)


def _batches(
    source: Source, appearance: AppearanceModel | None, jobs: int, progress: Progress
) -> Iterator[Batch]:
    """Replay a log; the patches of a batch are learnt before it comes, its labels are not."""
    if appearance is None:
        for batch, _ in follow(source, jobs, progress, "learn"):
            yield batch
        return
    for part, patches in follow_in_parts(source, jobs, progress, "learn", appearance.embed):
        if patches is not None:
            appearance.learn(patches)
        if part is not None:
            yield part


def _end(
    source: Source, collision: CollisionModel | None, appearance: AppearanceModel | None
) -> tuple[Press, ...] | None:
    """End the log in each model and return its presses."""
    presses: tuple[Press, ...] | None = None
    if appearance is not None:
        presses = appearance.end_log(source.replay.end_ns)
        note_images(source, appearance)
    if collision is not None:
        presses = collision.end_log(source.replay.end_ns)
    return presses


def note_images(source: Source, appearance: AppearanceModel) -> None:
    """Take over which images of a log were left out, and tell what changed within it."""
    source.lost_images.update(appearance.skipped)
    for what, n_changes in (+appearance.changes).items():
        times = count(n_changes, "time")
        LOGGER.warning("%s: %s, %s; all images are used", source.name, what, times)


def _tell_of_twice(source: Source, logs: Sequence[LogSource]) -> None:
    if (source.name, source.start.start_ns) in {(log.name, log.start_ns) for log in logs}:
        LOGGER.warning("%s: learnt before; its observations count twice", source.name)
