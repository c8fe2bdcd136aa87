"""A recording gives back what was learnt from, block by block."""

import tracemalloc
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mpap_cli.errors import ModelError
from mpap_cli.observations import Press, ScanBlock, ScanGeometry
from mpap_cli.outputs.model_file import write_model
from mpap_cli.outputs.recorded_log import RecordedLog
from mpap_cli.outputs.recording import RecordingWriter, blocks_around, read_recording
from mpap_cli.outputs.scan_chunks import make_chunk

GEOMETRY = ScanGeometry(5, -1.0, 0.5, 0.1, 5.0, "laser")


def block_of(first: int, n_scans: int, geometry: ScanGeometry = GEOMETRY) -> ScanBlock:
    """Make scans with all kinds of ranges."""
    values = np.arange(n_scans * geometry.n_beams, dtype=np.float32) + first
    ranges = values.reshape(n_scans, geometry.n_beams)
    ranges[0, 0], ranges[0, 1] = np.nan, np.inf
    return ScanBlock(np.arange(first, first + n_scans, dtype=np.int64), ranges, geometry)


def log_of(name: str, presses: tuple[Press, ...] | None = None) -> RecordedLog:
    """Make the record of a log."""
    return RecordedLog(
        name=name,
        path=f"some/where/{name}",
        start_ns=-5,
        end_ns=2**62,
        forward_rad=np.pi,
        range_max=None,
        presses=presses,
        bump_source="topic /bump",
    )


def write(path: Path, logs: Sequence[tuple[RecordedLog, Sequence[ScanBlock]]], size: int) -> None:
    """Write a recording."""
    with RecordingWriter(path, chunk_bytes=size) as writer:
        for log, blocks in logs:
            for block in blocks:
                writer.add_block(block)
            writer.end_log(log)


def assert_same(found: ScanBlock, expected: ScanBlock) -> None:
    """Assert that two blocks hold the same."""
    assert found.geometry == expected.geometry
    np.testing.assert_array_equal(found.stamps_ns, expected.stamps_ns, strict=True)
    np.testing.assert_array_equal(found.ranges, expected.ranges, strict=True)


@pytest.mark.parametrize("chunk_bytes", [1, 200, 2**20])
def test_blocks_come_back_as_they_were(tmp_path: Path, chunk_bytes: int) -> None:
    """Whatever the size of the chunks, blocks of any geometry come back, again and again."""
    other = ScanGeometry(3, 0.0, 0.1, 0.0, np.inf, "rear")
    blocks = [block_of(0, 4), block_of(4, 1, other), block_of(5, 7)]
    logs = [(log_of("a.bag"), blocks), (log_of("b.bag"), []), (log_of("c.bag"), blocks[:1])]

    write(tmp_path / "recording.npz", logs, chunk_bytes)
    found = read_recording(tmp_path / "recording.npz")

    assert [log.name for log in found] == ["a.bag", "b.bag", "c.bag"]
    for _ in range(2):
        for log, (_, expected) in zip(found, logs, strict=True):
            for one, two in zip(log.blocks(), expected, strict=True):
                assert_same(one, two)


def test_blocks_around_are_those_that_hold_the_stamps(tmp_path: Path) -> None:
    """Of several logs and chunks the blocks with one of the stamps come, whole, with their log."""
    path = tmp_path / "r.npz"
    blocks = [block_of(0, 4), block_of(4, 3), block_of(7, 5)]
    write(path, [(log_of("a.bag"), blocks), (log_of("b.bag"), blocks[2:])], 200)

    found = list(blocks_around(path, np.array([5, 8, 99])))

    assert [log for log, _ in found] == [0, 0, 1]
    for (_, one), two in zip(found, [blocks[1], blocks[2], blocks[2]], strict=True):
        assert_same(one, two)


def test_facts_of_a_log_come_back(tmp_path: Path) -> None:
    """All that is known of a log comes back; of its path the base name and folder."""
    presses = (Press(1, 5, held_from_start=True), Press(7, 9, released=False))

    write(tmp_path / "r.npz", [(log_of("a.bag", presses), []), (log_of("b.bag", ()), [])], 100)
    first, second = read_recording(tmp_path / "r.npz")

    assert (first.path, first.start_ns, first.end_ns) == ("where/a.bag", -5, 2**62)
    assert (first.forward_rad, first.range_max) == (np.pi, None)
    assert first.bump_source == "topic /bump"
    assert first.presses == presses
    assert second.presses == ()


def test_log_without_bumper_has_no_presses(tmp_path: Path) -> None:
    """No bumper is not the same as no press."""
    write(tmp_path / "r.npz", [(log_of("a.bag"), [])], 100)

    (log,) = read_recording(tmp_path / "r.npz")

    assert log.presses is None


def test_same_logs_same_bytes(tmp_path: Path) -> None:
    """Neither time nor place enters the file, and blocks are copied when they are added."""
    block = block_of(0, 4)
    with RecordingWriter(tmp_path / "a.npz") as writer:
        writer.add_block(block)
        block.ranges[:] = 7
        writer.end_log(log_of("a.bag"))

    write(tmp_path / "b.npz", [(log_of("a.bag"), [block_of(0, 4)])], 2**20)

    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_empty_block_leaves_no_trace(tmp_path: Path) -> None:
    """A block without scans is not written."""
    empty = ScanBlock(np.empty(0, np.int64), np.empty((0, 5), np.float32), GEOMETRY)

    write(tmp_path / "r.npz", [(log_of("a.bag"), [empty])], 1)

    (log,) = read_recording(tmp_path / "r.npz")
    assert list(log.blocks()) == []


def test_memory_stays_flat(tmp_path: Path) -> None:
    """Writing and reading take memory for a chunk or two, not for the log."""
    geometry = ScanGeometry(361, 0.0, 0.01, 0.1, 5.0)
    block = ScanBlock(np.arange(256), np.ones((256, 361), np.float32), geometry)
    path = tmp_path / "r.npz"

    tracemalloc.start()
    with RecordingWriter(path, chunk_bytes=2**19) as writer:
        for _ in range(60):
            writer.add_block(block)
        writer.end_log(log_of("a.bag"))
    (log,) = read_recording(path)
    n_scans = sum(found.stamps_ns.size for found in log.blocks())
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()

    assert n_scans == 60 * 256
    assert path.stat().st_size > 20 * 2**20
    assert peak < 8 * 2**20


def test_unfinished_recording_is_named(tmp_path: Path) -> None:
    """A recording whose writing failed is not taken for a whole one."""

    def fail() -> None:
        with RecordingWriter(tmp_path / "r.npz") as writer:
            writer.add_block(block_of(0, 4))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()

    with pytest.raises(ModelError, match=r"r.npz: not a whole recording of mpap .*mpap learn"):
        read_recording(tmp_path / "r.npz")


def test_model_is_no_recording(tmp_path: Path) -> None:
    """Another file of ours is told apart."""
    write_model(tmp_path / "model.npz", {}, {"recording": np.zeros(3, np.uint8)})

    with pytest.raises(ModelError, match="not a whole recording"):
        read_recording(tmp_path / "model.npz")


def test_missing_recording_is_named(tmp_path: Path) -> None:
    """A missing file is one line."""
    with pytest.raises(ModelError, match=r"there is no such file; check the path of the rec"):
        read_recording(tmp_path / "r.npz")


def test_replaced_recording_is_noticed(tmp_path: Path) -> None:
    """Scans of one recording are never read with the records of another."""
    path = tmp_path / "r.npz"
    write(path, [(log_of("a.bag"), [block_of(0, 4)])], 100)
    (log,) = read_recording(path)
    write(tmp_path / "new.npz", [(log_of("a.bag"), [block_of(0, 5)])], 100)
    (tmp_path / "new.npz").replace(path)

    with pytest.raises(ModelError, match="has been replaced while it was read"):
        list(log.blocks())


RUNS = np.array([[2.0, 3.0, 0.0, 0.1, 0.1, 5.0, 0.0]])


@pytest.mark.parametrize(
    ("arrays", "found"),
    [
        ((np.zeros(2), np.zeros(6, np.float32), RUNS), "types"),
        ((np.zeros(2, np.int64), np.zeros((2, 3), np.float32), RUNS), "types"),
        ((np.zeros(2, np.int64), np.zeros(6, np.float32), RUNS[0]), "runs"),
        ((np.zeros(2, np.int64), np.zeros(6, np.float32), RUNS[:, :6]), "runs"),
        ((np.zeros(2, np.int64), np.zeros(6, np.float32), RUNS * 1e300), "runs"),
        ((np.zeros(2, np.int64), np.zeros(6, np.float32), -RUNS), "runs"),
        ((np.zeros(2, np.int64), np.zeros(6, np.float32), RUNS + np.nan), "runs"),
        ((np.zeros(2, np.int64), np.zeros(6, np.float32), RUNS + 1), "runs"),
        ((np.zeros(3, np.int64), np.zeros(6, np.float32), RUNS), "sizes"),
        ((np.zeros(2, np.int64), np.zeros(7, np.float32), RUNS), "sizes"),
        ((np.array([2, 1]), np.zeros(6, np.float32), RUNS), "stamps"),
    ],
)
def test_chunks_are_checked(arrays: Sequence[NDArray[Any]], found: str) -> None:
    """Arrays of other types, or that do not fit each other, are refused."""
    with pytest.raises(ValueError, match=f"the {found} of a chunk"):
        make_chunk(arrays, n_frames=1)


@given(data=st.data())
def test_damaged_recording_is_one_line(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    """Cut off or with bytes changed, a recording is read or is a ModelError, nothing else."""
    path = tmp_path_factory.mktemp("recording") / "r.npz"
    write(path, [(log_of("a.bag", (Press(1, 5),)), [block_of(0, 4)])], 100)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)) | st.just(len(content)))])

    message = ""
    try:
        for log in read_recording(path):
            list(log.blocks())
    except ModelError as error:
        message = str(error)

    assert message.isprintable()
