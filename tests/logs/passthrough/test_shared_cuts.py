"""Cuts of recorded logs: byte by byte what the readers find in the windows."""

from pathlib import Path

import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from mpap_cli.errors import LogError
from mpap_cli.logs.passthrough.cuts import Cut
from mpap_cli.logs.passthrough.reader import PassthroughLog
from mpap_cli.logs.reader import open_log
from tests.logs.passthrough.test_cuts import cut_log, messages

FEW = (
    "real/neato-2018-a4.bag",
    "real/neato-2024-e4",
    "converted/neato-2018-a1-ros1profile.mcap",
    "converted/neato-2018-a2-json.mcap",
    "traps/made-no-metadata",
    "traps/folder-named.bag",
    "traps/split-5-files-mcap",
    "traps/split-5-files-sqlite3",
    "traps/example-bz2.bag",
    "damaged/killed.bag.active",
    "damaged/flipped-byte-zstd.mcap",
    "damaged/cut70.db3",
    "damaged/cut70.mcap",
)


def logs_under(folder: Path) -> list[Path]:
    """Return every file and folder that may be a log."""
    return sorted(path for kind in folder.iterdir() for path in kind.iterdir())


@pytest.fixture
def linked(tmp_path: Path) -> Path:
    """Return a folder in which new logs lie beside links to recorded ones."""
    folder = tmp_path / "logs"
    folder.mkdir()
    return folder


def check_cut(path: Path, folder: Path) -> bool:
    """Cut a log in three; tell whether it is a log with messages."""
    link = folder / path.name
    link.symlink_to(path, target_is_directory=path.is_dir())
    try:
        with open_log(link) as log, PassthroughLog(link) as raw:
            span_ns = log.end_ns - log.start_ns
            cuts = [
                Cut(log.start_ns + span_ns // 5, log.start_ns + 2 * span_ns // 5),
                Cut(log.start_ns + 4 * span_ns // 5, log.end_ns + 1),
            ]
            whole = [
                (m.topic.name, m.topic.msgtype, m.stamp_ns, m.payload)
                for m in log.messages([topic.name for topic in log.topics])
            ]
            latched = {channel.topic for channel in raw.channels if channel.latched}
            container, n_messages = log.container, log.n_messages
    except LogError:
        return False
    if not n_messages:
        return False
    cut = cut_log(link, cuts)
    found = messages(cut)
    expected = [row for row in whole if any(c.start_ns <= row[2] < c.end_ns for c in cuts)]
    repeated = [row for row in found if row[0] in latched and row[2] in {c.start_ns for c in cuts}]
    assert sorted(row for row in found if row[0] not in latched) == sorted(
        row for row in expected if row[0] not in latched
    )
    assert set(expected) <= set(found)
    assert len(found) <= len(expected) + len(repeated)
    assert {row[3] for row in repeated} <= {row[3] for row in whole}
    read_by_peers(cut, container, found)
    return True


def read_by_peers(cut: Path, container: str, found: list[tuple[str, str, int, bytes]]) -> None:
    """Compare what rosbags and mcap's own reader find."""
    expected = [(stamp_ns, payload) for _, _, stamp_ns, payload in found]
    if container == "mcap":
        with cut.open("rb") as stream:
            read = make_reader(stream, validate_crcs=True).iter_messages()
            assert sorted((m.log_time, m.data) for _, _, m in read) == sorted(expected)
        with PassthroughLog(cut) as log:
            if log.origin.profile != "ros2":
                return
    store = get_typestore(Stores.ROS2_HUMBLE)
    with AnyReader([cut], default_typestore=store) as reader:
        rows = [(stamp_ns, bytes(raw)) for _, stamp_ns, raw in reader.messages()]
        assert sorted(rows) == sorted(expected)


@pytest.mark.parametrize("name", FEW)
def test_cuts_of_recorded_logs_are_the_same_bytes(
    name: str, shared_logs: Path, linked: Path
) -> None:
    """Windows, containers and damage of every kind."""
    assert check_cut(shared_logs / name, linked)


@pytest.mark.slow
def test_every_recorded_log_is_cut(shared_logs: Path, linked: Path) -> None:
    """Of all that can be read at all."""
    logs = [path for path in logs_under(shared_logs) if path.name != "zero-db3-folder"]

    n_cut = 0
    for number, path in enumerate(logs):
        own = linked / str(number)
        own.mkdir()
        n_cut += check_cut(path, own)

    assert n_cut > 40
