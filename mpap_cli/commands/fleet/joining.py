"""Leaves become one: a model by merging, a recording by writing one log after the other."""

from collections.abc import Sequence
from pathlib import Path

from mpap_cli.commands.fleet.tasks import Leaf
from mpap_cli.commands.inputs.models import load_collision_model
from mpap_cli.logs.reader import LogPath
from mpap_cli.outputs.model_file import MODEL_NAME
from mpap_cli.outputs.recorded_log import RecordedLog
from mpap_cli.outputs.recording import RECORDING_NAME, RecordingWriter, read_recording
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.merging import merge_models


def merge_leaves(leaves: Sequence[Leaf]) -> CollisionModel:
    """Merge the models of leaves at once; their order does not matter.

    Raises
    ------
    ModelError
        If one cannot be read.
    """
    return merge_models([load_collision_model(leaf.folder / MODEL_NAME) for leaf in leaves])


def join_recordings(path: Path, leaves: Sequence[tuple[LogPath, Leaf]]) -> None:
    """Write the recordings of leaves into one, as ``learn`` writes it of the same logs.

    Parameters
    ----------
    path : Path
        File to write.
    leaves : sequence of tuple of Path and Leaf
        Where each log lies, and its leaf; the logs stand in the order of the merged model.

    Raises
    ------
    ModelError
        If one cannot be read.
    """
    recorded = [
        (log, where, leaf.folder.name)
        for where, leaf in leaves
        for log in read_recording(leaf.folder / RECORDING_NAME)
    ]
    recorded.sort(key=lambda one: (one[0].start_ns, one[0].name, one[0].end_ns, one[2]))
    with RecordingWriter(path) as writer:
        for log, where, _ in recorded:
            for block in log.blocks():
                writer.add_block(block)
            writer.end_log(
                RecordedLog(
                    name=log.name,
                    path=str(where.absolute()),
                    start_ns=log.start_ns,
                    end_ns=log.end_ns,
                    forward_rad=log.forward_rad,
                    range_max=log.range_max,
                    presses=log.presses,
                    bump_source=log.bump_source,
                )
            )
