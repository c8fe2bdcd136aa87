"""Models as the user names them: a model file or a results folder."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.settings import SettingsRequest, settings_from
from mpap_cli.errors import ModelError, UsageError
from mpap_cli.observations import ObservedLog
from mpap_cli.outputs.model_file import find_model, read_model, write_model
from mpap_cli.outputs.recording import RECORDING_NAME, read_recording
from mpap_cli.params import Settings
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogSource
from mpap_cli.systems.model_parts import ModelState

LOGGER = logging.getLogger(__name__)
COLLISION, APPEARANCE = "collision", "appearance"


@dataclass(slots=True)
class Models:
    """What was learnt with one set of settings: from scans, from images, or from both."""

    settings: Settings
    collision: CollisionModel | None = None
    appearance: AppearanceModel | None = None

    @property
    def sensor(self) -> str:
        """The sensors that there is a model of, as ``--sensor`` names them."""
        if self.collision is None:
            return "image" if self.appearance is not None else "auto"
        return "both" if self.appearance is not None else "scan"

    @property
    def logs(self) -> tuple[LogSource, ...]:
        """Logs that were learnt, those of the scans first."""
        known = [model.logs for model in (self.collision, self.appearance) if model is not None]
        logs = {(log.name, log.start_ns): log for one in reversed(known) for log in one}
        return tuple(logs.values())


def begin_models(selection: LogSelection, settings: SettingsRequest, older: Path | None) -> Models:
    """Return new models, or the older ones that are to go on.

    Raises
    ------
    UsageError
        If settings are given beside an older model, which has its own.
    ModelError
        If the older model cannot be used.
    """
    if older is None:
        # the models keep the forward direction, for later logs of the same robot
        return Models(selection.settings_for(settings_from(settings)))
    if not settings.says_nothing:
        msg = "--model goes on with the model's own settings; leave out --profile, --set and such"
        raise UsageError(msg)
    return load_models(older)


def load_models(path: Path) -> Models:
    """Read what was learnt from a file or results folder.

    Raises
    ------
    ModelError
        If there is no model or it cannot be used; the file is named.
    """
    file = find_model(path)
    header, arrays = read_model(file)
    try:
        collision = _state(header, arrays, COLLISION)
        appearance = _state(header, arrays, APPEARANCE)
        known = CollisionModel.from_state(collision) if collision else None
        seen = AppearanceModel.from_state(appearance) if appearance else None
    except ModelError as error:
        msg = f"{file}: {error}"
        raise ModelError(msg) from error
    settings = next((model.settings for model in (known, seen) if model is not None), None)
    if settings is None:
        msg = f"{file}: neither scans nor images were learnt; learn it again"
        raise ModelError(msg)
    return Models(settings, known, seen)


def load_collision_model(path: Path) -> CollisionModel:
    """Read the collision model of a file or results folder.

    Raises
    ------
    ModelError
        If there is no model, or none of laser scans.
    """
    models = load_models(path)
    if models.collision is None:
        msg = f"{find_model(path)}: learnt from images only; learn logs with laser scans"
        raise ModelError(msg)
    return models.collision


def save_models(path: Path, models: Models) -> None:
    """Write what was learnt to a file."""
    header: dict[str, Any] = {}
    arrays: dict[str, NDArray[Any]] = {}
    for name, model in ((COLLISION, models.collision), (APPEARANCE, models.appearance)):
        if model is not None:
            state = model.state()
            header[name] = state.header
            arrays |= {f"{name}.{key}": array for key, array in state.arrays.items()}
    write_model(path, header, arrays)


def recorded_beside(path: Path) -> tuple[ObservedLog, ...] | None:
    """Return the logs that a model learnt from, if their recording lies beside it."""
    recording = find_model(path).with_name(RECORDING_NAME)
    return tuple(read_recording(recording)) if recording.is_file() else None


def _state(
    header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]], name: str
) -> ModelState | None:
    """Return the part of a file that holds one model."""
    part = header.get(name)
    if part is None:
        return None
    if not isinstance(part, dict):
        msg = f"model: {name} is no record; learn it again"
        raise ModelError(msg)
    prefix = f"{name}."
    own = {
        key.removeprefix(prefix): array for key, array in arrays.items() if key.startswith(prefix)
    }
    return ModelState(part, own)
