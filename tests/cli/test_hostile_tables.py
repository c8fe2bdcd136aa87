"""Tables and settings that a user hands in may hold anything: one line, never a traceback."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mpap_cli.commands.settings import SettingsRequest, settings_from
from mpap_cli.errors import MpapError
from mpap_cli.evaluation.groups import group_names
from mpap_cli.observations import ObservedLog
from mpap_cli.properties.press_files import presses_from_csv

LOG = ObservedLog("a.bag", "day/a.bag", 0, 10**9, 0.0, None, (), "", lambda: iter(()))
ODD = (
    "",
    "\0",
    "\ufeff",
    "9" * 5000,
    "-1",
    "nan",
    "sNaN",
    "1e999999999",
    "1e-999999999",
    "inf",
    '"',
    "../../a.bag",
    "\x1b[31m",
    "x" * 200_000,
    "\u0663",
)


def read_presses(path: Path) -> None:
    """Read a file as --bump-from and --truth do."""
    presses_from_csv(path)


def read_groups(path: Path) -> None:
    """Read a file as --groups does."""
    group_names([LOG], str(path))


def read_config(path: Path) -> None:
    """Read a file as --config does."""
    settings_from(SettingsRequest(config=path))


READERS: dict[Callable[[Path], None], tuple[str, str]] = {
    read_presses: ("log,start_s,end_s,log_index", "a.bag,1,2,0"),
    read_groups: ("log,group", "a.bag,1"),
    read_config: ("bins = 6", "theta = 0.08"),
}


def line_of(read: Callable[[Path], None], path: Path) -> str:
    """Read a file; return what is wrong with it, nothing if nothing is."""
    try:
        read(path)
    except MpapError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("read", READERS)
@given(data=st.data())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_mutated_files_are_read_or_refused(
    tmp_path: Path, read: Callable[[Path], None], data: st.DataObject
) -> None:
    """Cells and bytes may be anything."""
    head, line = READERS[read]
    cells = line.replace(" = ", ",").split(",")
    cells[data.draw(st.integers(0, len(cells) - 1))] = data.draw(st.sampled_from(ODD) | st.text())
    joint = " = " if " = " in line else ","
    content = bytearray(f"{head}\n{joint.join(cells)}\n".encode("utf-8", "surrogatepass"))
    for _ in range(data.draw(st.integers(0, 2))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "odd.csv"
    path.write_bytes(content)

    said = line_of(read, path)

    assert said == "" or "odd.csv" in said or said.startswith("setting ")


@pytest.mark.parametrize(
    "content",
    [
        b"x = " + b"[" * 100_000,
        b"x = " + b"{a=" * 50_000,
        b"a" + b".a" * 100_000 + b" = 1",
        b"x = " + b"9" * 100_000,
        b"x = 0x" + b"f" * 100_000,
        b"\xff\xfe\0",
        b"# " + b"x" * (2 << 20),
    ],
)
def test_deep_and_huge_settings_are_one_line(tmp_path: Path, content: bytes) -> None:
    """Nesting, numbers and sizes without end are refused."""
    path = tmp_path / "odd.toml"
    path.write_bytes(content)

    said = line_of(read_config, path)

    assert said.startswith("--config odd.toml: ")
    assert len(said) < 300


@pytest.mark.parametrize("read", [read_presses, read_groups])
@pytest.mark.parametrize(
    "content", [b"", b"\0" * 1000, b'"' + b"x" * (1 << 20), b"\x89PNG\r\n\x1a\n"]
)
def test_what_is_no_table_is_one_line(
    tmp_path: Path, read: Callable[[Path], None], content: bytes
) -> None:
    """Empty, binary and endless cells are refused with the name of the file."""
    path = tmp_path / "odd.csv"
    path.write_bytes(content)

    said = line_of(read, path)

    assert "odd.csv" in said
    assert len(said) < 3000
