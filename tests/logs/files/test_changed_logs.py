"""Any bytes whatsoever: every reader gives messages or one line."""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.robustness.mutations import MUTATIONS, mutated
from mpap_cli.errors import LogError
from mpap_cli.logs.files.containers import MAGICS
from mpap_cli.logs.files.ros2 import read_metadata, storage_files
from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.reader import open_log
from tests.conftest import WRITERS
from tests.logs.rows import ROWS

HEADS = {
    "bag": b"#ROSBAG V2.0\n",
    "sqlite3": MAGICS["sqlite3"] + b"\x10\x00\x01\x01\x00\x40\x20\x20",
    "mcap": MAGICS["mcap"],
    "zstd": MAGICS["zstd"],
}


@cache
def contents() -> dict[str, bytes]:
    """Return a small file of every kind of log."""
    made = {}
    for kind, write in WRITERS.items():
        with tempfile.TemporaryDirectory() as name:
            path = write(Path(name), ROWS)
            files = path.iterdir() if path.is_dir() else [path]
            (file,) = (file for file in files if file.name != "metadata.yaml")
            made[kind] = file.read_bytes()
    return made


def read_all(path: Path) -> int:
    """Read whatever is there; no log is a result, too."""
    try:
        with open_log(path) as reader:
            return _count(reader)
    except LogError:
        return 0


def _count(reader: LogReader) -> int:
    """Count messages and see that runs and single messages agree."""
    names = [topic.name for topic in reader.topics]
    stamps_ns = [message.stamp_ns for message in reader.messages(names)]
    in_runs = [int(t) for group in reader.runs(names) for run in group.runs for t in run.stamps_ns]
    assert stamps_ns == sorted(stamps_ns) == sorted(in_runs)
    return len(stamps_ns)


@given(kind=st.sampled_from(list(HEADS)), content=st.binary(max_size=300))
def test_any_bytes_behind_a_magic(kind: str, content: bytes) -> None:
    """The first bytes promise a log; what follows does not keep it."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "log"
        path.write_bytes(HEADS[kind] + content)

        n_messages = read_all(path)

    assert n_messages >= 0


@given(kind=st.sampled_from(list(WRITERS)), seed=st.integers(0, 2**32))
def test_changed_bytes(kind: str, seed: int) -> None:
    """Lengths, counts, offsets and names that are wrong end nothing but the log."""
    rng = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "log"
        path.write_bytes(mutated(rng, contents()[kind]))

        n_messages = read_all(path)

    assert n_messages <= 16 * len(ROWS)  # four blocks doubled


@given(content=st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
def test_any_metadata(content: bytes) -> None:
    """A broken metadata.yaml is as good as none."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "metadata.yaml").write_bytes(content)
        (folder / "log.db3").write_bytes(b"")

        metadata, problem = read_metadata(folder)
        files, _ = storage_files(folder)

    assert bool(problem) or metadata.files
    assert files == [folder / "log.db3"]


@pytest.mark.parametrize("name", MUTATIONS)
def test_changes_change(name: str) -> None:
    """Most of the time, and the same way for the same seed."""
    content = bytes(range(256)) * 8
    once, again = bytearray(content), bytearray(content)

    MUTATIONS[name](np.random.default_rng(3), once)
    MUTATIONS[name](np.random.default_rng(3), again)

    assert once == again != content
