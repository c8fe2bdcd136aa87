"""Models as the user names them: a model file or a results folder."""

from pathlib import Path

from mpap_cli.errors import ModelError
from mpap_cli.observations import ObservedLog
from mpap_cli.outputs.model_file import find_model, read_model, write_model
from mpap_cli.outputs.recording import read_recording
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.model_parts import ModelState


def load_model(path: Path) -> CollisionModel:
    """Read a model from a file or results folder.

    Raises
    ------
    ModelError
        If there is none or it cannot be used; the file is named.
    """
    file = find_model(path)
    header, arrays = read_model(file)
    try:
        return CollisionModel.from_state(ModelState(header, arrays))
    except ModelError as error:
        msg = f"{file}: {error}"
        raise ModelError(msg) from error


def save_model(path: Path, model: CollisionModel) -> None:
    """Write a model to a file."""
    state = model.state()
    write_model(path, state.header, state.arrays)


def recorded_beside(path: Path) -> tuple[ObservedLog, ...] | None:
    """Return the logs that a model learnt from, if their recording lies beside it."""
    recording = find_model(path).with_name("recording.npz")
    return tuple(read_recording(recording)) if recording.is_file() else None
