"""The recording: scans and presses of what was learnt, so that they can be scored later.

A chunk of scans is three arrays in a zip: the stamps, one line of ``runs`` for each block
(number of scans, geometry, frame) and the ranges of all its scans one after the other.
A log's record follows its chunks, the list of logs is last: memory stays flat.
"""

import math
import zipfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path, PurePath
from types import TracebackType
from typing import Any, NoReturn, Self

import numpy as np
from numpy.typing import NDArray

from mpap_cli.errors import ModelError
from mpap_cli.observations import IntArray, ObservedLog, Press, ScanBlock
from mpap_cli.outputs.array_members import (
    map_array,
    open_members,
    read_array,
    read_record,
    write_joined,
    write_record,
)
from mpap_cli.outputs.model_file import check_format
from mpap_cli.outputs.recorded_log import RecordedLog
from mpap_cli.outputs.scan_chunks import ChunkPacker, make_chunk, unpack

RECORDING_NAME = "recording.npz"
FORMAT, VERSION = "mpap recording", 1
_CHUNK_BYTES = 4 * 1024 * 1024
_WHAT = "recording"
ArrayReader = Callable[[zipfile.ZipFile, str], NDArray[Any]]


class RecordingWriter:
    """Context manager that writes a recording block by block; the same logs, the same bytes.

    For each log in turn: :meth:`add_block` for its scans, then :meth:`end_log`.

    Parameters
    ----------
    path : Path
        File to write, by custom ``recording.npz``.
    chunk_bytes : int
        Scans are kept in memory up to that size.
    """

    def __init__(self, path: Path, chunk_bytes: int = _CHUNK_BYTES) -> None:
        self._path = path
        self._chunk_bytes = chunk_bytes
        self._packer = ChunkPacker()
        self._n_chunks = 0
        self._n_logs = 0

    def __enter__(self) -> Self:
        self._archive = zipfile.ZipFile(self._path, "w")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        with self._archive:
            if error is None:
                record = {"format": FORMAT, "version": VERSION, "logs": self._n_logs}
                write_record(self._archive, _WHAT, record)

    def add_block(self, block: ScanBlock) -> None:
        """Write scans of the log that is being read; blocks in time order."""
        self._packer.add(block)
        if self._packer.n_bytes >= self._chunk_bytes:
            self._write_chunk()

    def end_log(self, log: RecordedLog) -> None:
        """Write what is known of the log whose blocks have been added."""
        self._write_chunk()
        presses = None
        if log.presses is not None:
            presses = [
                [int(one.start_ns), int(one.end_ns), int(one.held_from_start), int(one.released)]
                for one in log.presses
            ]
        record = {
            "name": log.name,
            "path": "/".join(PurePath(log.path).parts[-2:]),
            "start_ns": int(log.start_ns),
            "end_ns": int(log.end_ns),
            "forward_rad": float(log.forward_rad),
            "range_max": None if log.range_max is None else float(log.range_max),
            "presses": presses,
            "bump_source": log.bump_source,
            "frames": self._packer.frames,
            "chunks": self._n_chunks,
        }
        write_record(self._archive, f"{_folder(self._n_logs)}/log", record)
        self._n_logs += 1
        self._n_chunks = 0
        self._packer = ChunkPacker()

    def _write_chunk(self) -> None:
        """Write the blocks that wait."""
        chunk = self._packer.take()
        if not chunk.runs:
            return
        name = _chunk(self._n_logs, self._n_chunks)
        for part, pieces in chunk._asdict().items():
            write_joined(self._archive, f"{name}/{part}", pieces)
        self._n_chunks += 1


def read_recording(path: Path) -> list[ObservedLog]:
    """Read a recording; the scans stay on disk until ``blocks`` is called.

    Parameters
    ----------
    path : Path
        A file that :class:`RecordingWriter` wrote.

    Returns
    -------
    list of ObservedLog
        One a log, in the order written. ``blocks()`` opens the file again each time and
        yields the blocks as they were added, a chunk of them in memory at once; it raises
        ``ModelError`` where the file is garbled or has been replaced.

    Raises
    ------
    ModelError
        If the file is missing, no recording, of another version, cut off or garbled.
    """
    with open_members(path, _WHAT) as archive:
        record = read_record(archive, _WHAT)
        check_format(path, record, FORMAT, VERSION)
        # a number larger than the list of members is never counted up to
        if not 0 <= record["logs"] <= len(archive.namelist()):
            _garbled("the number of logs")
        stamp = _fingerprint(path)
        return [_observed(path, archive, stamp, index) for index in range(record["logs"])]


def _folder(log: int) -> str:
    return f"log{log:05d}"


def _chunk(log: int, chunk: int) -> str:
    return f"{_folder(log)}/chunk{chunk:06d}"


def _garbled(what: str) -> NoReturn:
    msg = f"{what} cannot be right"
    raise ValueError(msg)


def _fingerprint(path: Path) -> tuple[int, int, int]:
    """Return what changes when a file is replaced."""
    facts = path.stat()
    return facts.st_ino, facts.st_size, facts.st_mtime_ns


def _observed(
    path: Path, archive: zipfile.ZipFile, stamp: tuple[int, int, int], index: int
) -> ObservedLog:
    """Read and check the record of one log."""
    record = read_record(archive, f"{_folder(index)}/log")
    texts = (record["name"], record["path"], record["bump_source"], *record["frames"])
    whole = (record["start_ns"], record["end_ns"], record["chunks"])
    if not all(isinstance(text, str) for text in texts):
        _garbled(f"a text of log {index}")
    if not all(type(number) is int for number in whole) or whole[0] > whole[1]:
        _garbled(f"the times of log {index}")
    if not 0 <= record["chunks"] <= len(archive.namelist()):
        _garbled(f"the number of chunks of log {index}")
    range_max = None if record["range_max"] is None else float(record["range_max"])
    forward_rad = float(record["forward_rad"])
    if not math.isfinite(forward_rad) or (range_max is not None and not range_max > 0):
        _garbled(f"the scanner of log {index}")
    read = partial(_blocks, path, stamp, index, record)
    return ObservedLog(
        name=record["name"],
        path=record["path"],
        start_ns=record["start_ns"],
        end_ns=record["end_ns"],
        forward_rad=forward_rad,
        range_max=range_max,
        presses=_presses(record["presses"], index),
        bump_source=record["bump_source"],
        blocks=read,
    )


def _presses(lines: Any, index: int) -> tuple[Press, ...] | None:
    """Read the presses of a log."""
    if lines is None:
        return None
    presses = []
    for start_ns, end_ns, held, released in lines:
        if type(start_ns) is not int or type(end_ns) is not int or start_ns > end_ns:
            _garbled(f"a press of log {index}")
        presses.append(Press(start_ns, end_ns, bool(held), bool(released)))
    return tuple(presses)


def _blocks(
    path: Path, stamp: tuple[int, int, int], index: int, record: dict[str, Any]
) -> Iterator[ScanBlock]:
    """Yield the blocks of one log, chunk by chunk."""
    with open_members(path, _WHAT) as archive:
        if _fingerprint(path) != stamp:
            msg = f"{path}: has been replaced while it was read; start again"
            raise ModelError(msg)
        for chunk in range(record["chunks"]):
            yield from _chunk_blocks(archive, _chunk(index, chunk), record["frames"])


def _chunk_blocks(
    archive: zipfile.ZipFile, name: str, frames: list[str], ranges_of: ArrayReader = read_array
) -> Iterator[ScanBlock]:
    """Yield the blocks of one chunk."""
    stamps_ns, runs = (read_array(archive, f"{name}/{part}") for part in ("stamps_ns", "runs"))
    arrays = [stamps_ns, ranges_of(archive, f"{name}/ranges"), runs]
    yield from unpack(make_chunk(arrays, len(frames)), frames)


def blocks_around(path: Path, stamps_ns: IntArray) -> Iterator[tuple[int, ScanBlock]]:
    """Yield the blocks that hold some scans, with the index of their log.

    Their ranges stay on the disk until they are looked at, and are not held against a
    checksum: for a recording that this process wrote.

    Raises
    ------
    ModelError
        As :func:`read_recording`.
    """
    with open_members(path, _WHAT) as archive:
        for index in range(read_record(archive, _WHAT)["logs"]):
            log = read_record(archive, f"{_folder(index)}/log")
            for chunk in range(log["chunks"]):
                name = _chunk(index, chunk)
                for block in _chunk_blocks(archive, name, log["frames"], map_array):
                    if np.isin(block.stamps_ns, stamps_ns).any():
                        yield index, block
