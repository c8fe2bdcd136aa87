"""``simulate``: the log of a simulated robot."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mpap_cli.simulation.scenario import SimulatedLog
from mpap_cli.simulation.scenario import simulate as write_log
from mpap_cli.simulation.settings import CameraParams, SimulationParams

BY_ENDING = {".bag": "bag", ".mcap": "mcap"}


def container_for(path: Path) -> str:
    """Return the container that the ending of a log's name means.

    >>> container_for(Path("run.bag")), container_for(Path("run"))
    ('bag', 'rosbag2-sqlite3')
    """
    return BY_ENDING.get(path.suffix, "rosbag2-sqlite3")


def simulate(path: Path, camera: Mapping[str, Any] | None = None, **params: Any) -> SimulatedLog:
    """Write a log and the truth beside it.

    Parameters
    ----------
    path : Path
        Log to write; must not exist.
    camera : mapping, optional
        Fields of ``CameraParams``; without it the robot has no camera.
    **params
        Fields of ``SimulationParams``.

    Returns
    -------
    SimulatedLog
        Counts, contacts and paths.

    Raises
    ------
    SettingError
        If a parameter does not exist or does not fit.
    OutputError
        If the log exists or cannot be written.
    """
    lens = None if camera is None else CameraParams(**camera)
    return write_log(path, SimulationParams(camera=lens, **params))
