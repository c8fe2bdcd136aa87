"""A log of a simulated robot, and the truth about its contacts."""

import contextlib
import csv
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.errors import OutputError
from mpap_cli.logs.scratch import ScratchFolder
from mpap_cli.logs.writing.writer import LogWriter
from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation.camera_truth import CameraTruth
from mpap_cli.simulation.robot import Contact
from mpap_cli.simulation.settings import SimulationParams
from mpap_cli.simulation.sources import SCAN_TOPIC, Run

__all__ = ["SCAN_TOPIC", "SimulatedLog", "TruthContact", "simulate"]

TRUTH, PATCHES, IMAGES = ".truth.csv", ".patches.csv", ".images.csv"
CONTACT_COLUMNS = {
    "log": "base name of the log",
    "start_s": "onset in seconds since the first message of the log",
    "end_s": "release, likewise",
    "visible": "1 if the laser can see what is touched",
    "cause": "what was touched",
    "bearing_deg": "where it was touched, degrees to the left of straight ahead",
}


@dataclass(frozen=True, slots=True)
class TruthContact:
    """A contact as it was, whatever the bumper said: start <= t < end, log time.

    ``bearing_deg`` is where the robot was touched, to the left of straight ahead.
    """

    start_ns: int
    end_ns: int
    visible: bool
    cause: str
    bearing_deg: float


@dataclass(frozen=True, slots=True)
class SimulatedLog:
    """What was written.

    ``contacts`` is the truth, also in ``truth_path``; stamps are log time.
    """

    path: Path
    truth_path: Path
    contacts: tuple[TruthContact, ...]
    n_scans: int
    n_images: int
    n_messages: int
    start_ns: int
    end_ns: int


def simulate(path: Path, params: SimulationParams) -> SimulatedLog:
    """Write the log of a simulated robot, and the truth beside it.

    The truth is a table with the columns log, start_s, end_s, visible, cause, bearing_deg;
    times count from the log's first message. Its name is the log's with ``.truth.csv`` behind it.
    With a camera there are ``.patches.csv`` (log, stamp_ns, row, column, floor, wall,
    obstacle: shares of the pixels of each patch) and ``.images.csv`` (log, stamp_ns,
    free_ahead_m); stamps are those of the messages. The same settings give the same messages.
    Log and tables are written aside and take their names when all of them are whole.

    Parameters
    ----------
    path : Path
        The log, a file or (rosbag2) a folder; must not exist.
    params : SimulationParams
        What to simulate and how to write it.

    Returns
    -------
    SimulatedLog

    Raises
    ------
    OutputError
        If the log exists or cannot be written.
    """
    endings = (TRUTH,) if params.camera is None else (TRUTH, PATCHES, IMAGES)
    n_scans = n_messages = 0
    start_ns = end_ns = params.start_stamp_ns
    with (
        _tables_beside(path, endings) as tables,
        LogWriter(path, params.container, params.compression) as writer,
    ):
        with _camera_truth(path.name, tables) as truth:
            run = Run(params, truth)
            for topic, msgtype in run.topics():
                writer.add_topic(topic, msgtype)
            for stamp_ns, topic, msgtype, fields in run.events():
                writer.write(topic, msgtype, stamp_ns, fields)
                start_ns = stamp_ns if n_messages == 0 else start_ns
                end_ns = stamp_ns
                n_messages += 1
                n_scans += topic == SCAN_TOPIC
        contacts = tuple(_true_contact(run, contact, end_ns) for contact in run.walker.contacts)
        _write_truth(tables[TRUTH], path.name, start_ns, contacts)
    truth_path = _beside(path, TRUTH)
    n_images = 0 if run.camera is None else run.camera.n_taken
    return SimulatedLog(path, truth_path, contacts, n_scans, n_images, n_messages, start_ns, end_ns)


@contextlib.contextmanager
def _tables_beside(log: Path, endings: tuple[str, ...]) -> Iterator[Mapping[str, Path]]:
    """Give places aside for tables by their endings; without an error they come beside the log."""
    beside = {ending: _free_path(log, ending) for ending in endings}
    try:
        folder = ScratchFolder(".mpap-", log.parent)
        try:
            aside = {ending: folder.path / path.name for ending, path in beside.items()}
            yield aside
            for ending, path in beside.items():
                aside[ending].rename(path)
        finally:
            folder.remove()
    except OSError as err:
        found = (err.strerror or str(err)).lower()
        msg = f"{log}: cannot be written ({found}); choose another place"
        raise OutputError(msg) from err


def _camera_truth(
    log: str, tables: Mapping[str, Path]
) -> contextlib.AbstractContextManager[CameraTruth | None]:
    """Return what writes the truth about images, where there is a camera."""
    if IMAGES not in tables:
        return contextlib.nullcontext()
    return CameraTruth(log, tables[PATCHES], tables[IMAGES])


def _free_path(path: Path, ending: str) -> Path:
    """Return where a table beside a log goes; neither it nor a nameless log may be there."""
    if not path.name:
        msg = f"{path}: no name for a log; give a file or folder that is not there yet"
        raise OutputError(msg)
    beside = _beside(path, ending)
    if beside.exists():
        msg = f"{beside}: exists; choose another name for the log"
        raise OutputError(msg)
    return beside


def _beside(log: Path, ending: str) -> Path:
    return log.with_name(log.name + ending)


def _true_contact(run: Run, contact: Contact, end_ns: int) -> TruthContact:
    """Return a contact in log time, cut at the last message."""
    stop_ns = min(run.stamp(contact.end_step), end_ns)
    bearing_deg = math.degrees(contact.bearing_rad)
    start_ns = run.stamp(contact.start_step)
    return TruthContact(start_ns, stop_ns, contact.visible, contact.cause, bearing_deg)


def _write_truth(path: Path, log: str, start_ns: int, contacts: tuple[TruthContact, ...]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(CONTACT_COLUMNS)
        for contact in contacts:
            start_s = (contact.start_ns - start_ns) / NS_PER_S
            end_s = (contact.end_ns - start_ns) / NS_PER_S
            cells = (int(contact.visible), contact.cause, f"{contact.bearing_deg:.1f}")
            table.writerow((log, start_s, end_s, *cells))
