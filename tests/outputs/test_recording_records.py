"""The records of a recording are checked before they are believed."""

import zipfile
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.errors import ModelError
from mpap_cli.outputs.array_members import write_record
from mpap_cli.outputs.recording import FORMAT, VERSION, read_recording

LOG: dict[str, Any] = {
    "name": "a.bag",
    "path": "a.bag",
    "start_ns": 0,
    "end_ns": 10,
    "forward_rad": 0.0,
    "range_max": 5.0,
    "presses": [[1, 5, 0, 1]],
    "bump_source": "topic /bump",
    "frames": ["laser"],
    "chunks": 0,
}


def recording_of(path: Path, log: dict[str, Any], **changes: object) -> Path:
    """Write a recording with one log's record and a changed list."""
    with zipfile.ZipFile(path, "w") as archive:
        write_record(archive, "log00000/log", log)
        record = {"format": FORMAT, "version": VERSION, "logs": 1, **changes}
        write_record(archive, "recording", record)
    return path


def test_sound_record_is_read(tmp_path: Path) -> None:
    """The record that the other tests spoil is itself good."""
    (log,) = read_recording(recording_of(tmp_path / "r.npz", LOG))

    assert log.range_max == 5.0


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"format": "mpap model"}, "not an mpap recording file"),
        ({"version": 9}, "format version 9"),
        ({"logs": -1}, "the number of logs"),
        ({"logs": 10**12}, "the number of logs"),
        ({"logs": "1"}, "not a whole recording"),
    ],
)
def test_list_of_logs_is_checked(tmp_path: Path, changes: dict[str, object], found: str) -> None:
    """Other formats and versions, and impossible counts, are told."""
    with pytest.raises(ModelError, match=found):
        read_recording(recording_of(tmp_path / "r.npz", LOG, **changes))


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"name": 5}, "a text of log 0"),
        ({"frames": [None]}, "a text of log 0"),
        ({"start_ns": 0.5}, "the times of log 0"),
        ({"start_ns": 11}, "the times of log 0"),
        ({"chunks": 10**12}, "the number of chunks of log 0"),
        ({"forward_rad": float("nan")}, "the scanner of log 0"),
        ({"range_max": -1}, "the scanner of log 0"),
        ({"presses": [[5, 1, 0, 1]]}, "a press of log 0"),
        ({"presses": [[1, 5]]}, "not a whole recording"),
        ({"presses": 3}, "not a whole recording"),
    ],
)
def test_record_of_a_log_is_checked(tmp_path: Path, changes: dict[str, object], found: str) -> None:
    """Texts that are none, times that go back and impossible counts are told."""
    with pytest.raises(ModelError, match=found):
        read_recording(recording_of(tmp_path / "r.npz", {**LOG, **changes}))
