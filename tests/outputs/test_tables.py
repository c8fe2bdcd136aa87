"""Tables round-trip through CSV."""

import csv
import io
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import OutputError
from mpap_cli.outputs.tables import columns_of, csv_text, json_text, read_csv, write_csv


@dataclass(frozen=True)
class Line:
    """A row with every kind of column."""

    log: str
    scans: int
    predicted: bool
    p: float
    auc: float | None
    cluster: int | None


LINES = st.builds(
    Line,
    log=st.text(st.characters(exclude_categories=["Cs"])),
    scans=st.integers(),
    predicted=st.booleans(),
    p=st.floats(allow_nan=False),
    auc=st.none() | st.floats(allow_nan=False),
    cluster=st.none() | st.integers(),
)


def test_columns_are_the_fields_in_order() -> None:
    """The header is the names of the fields."""
    assert columns_of(Line) == ("log", "scans", "predicted", "p", "auc", "cluster")


@given(st.lists(LINES, max_size=5))
def test_tables_round_trip(tmp_path_factory: pytest.TempPathFactory, rows: list[Line]) -> None:
    """What is written comes back, whatever the texts and numbers."""
    path = tmp_path_factory.mktemp("table") / "table.csv"

    n_rows = write_csv(path, Line, rows)

    assert n_rows == len(rows)
    assert read_csv(path, Line) == rows
    assert csv_text(Line, rows).encode() == path.read_bytes()


def test_empty_cells_are_none_and_nan(tmp_path: Path) -> None:
    """None and NaN are empty; a field that may be None is None again, another NaN."""
    path = tmp_path / "table.csv"

    write_csv(path, Line, [Line("a", 1, True, math.nan, math.nan, None)])

    assert path.read_bytes() == b"log,scans,predicted,p,auc,cluster\na,1,1,,,\n"
    (row,) = read_csv(path, Line)
    assert math.isnan(row.p)
    assert row.auc is None


def test_numpy_scalars_are_written_as_numbers() -> None:
    """A float32 is written with the digits it has, a numpy truth value as 1 or 0."""
    row = Line("a", np.int64(3), np.bool_(True), np.float32(0.1), np.float64(0.1), None)  # type: ignore[arg-type]

    text = csv_text(Line, [row])

    assert text.splitlines()[1] == "a,3,1,0.1,0.1,"
    (record,) = json.loads(json_text(Line, [row]))
    assert (record["scans"], record["p"], record["predicted"]) == (3, 0.1, True)


def test_json_is_strict() -> None:
    """NaN is null and infinity a word: every JSON reader takes it."""
    rows = [Line("a", 1, False, math.inf, math.nan, None)]

    text = json_text(Line, rows)

    assert json.loads(text) == [
        {"log": "a", "scans": 1, "predicted": False, "p": "inf", "auc": None, "cluster": None}
    ]
    assert "NaN" not in text


def test_odd_file_names_stay_utf8(tmp_path: Path) -> None:
    """A log whose name is no valid text does not spoil the table."""
    path = tmp_path / "table.csv"

    write_csv(path, Line, [Line("a\udcff.bag", 1, False, 0.5, None, None)])

    assert read_csv(path, Line)[0].log == "a\\udcff.bag"


def test_lines_end_in_newlines_only() -> None:
    """A carriage return in a name stays inside quotes and adds none elsewhere."""
    text = csv_text(Line, [Line("a\rb\n", 1, False, 0.5, None, None)])

    rows = list(csv.reader(io.StringIO(text, newline="")))

    assert text.count("\r") == 1
    assert rows[1][0] == "a\rb\n"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", "line 1: expected the columns log,scans"),
        ("log,scans\n", "line 1: expected the columns log,scans"),
        ("log,scans,predicted,p,auc,cluster\na,1\n", "line 2: 2 cells, expected 6"),
        ("log,scans,predicted,p,auc,cluster\na,x,1,1,,\n", "line 2: column scans: found 'x'"),
        ("log,scans,predicted,p,auc,cluster\na,1,2,1,,\n", "column predicted: found '2'"),
        ('log,scans,predicted,p,auc,cluster\n"a"b,1,1,1,,\n', "cannot be read as a table"),
    ],
)
def test_foreign_tables_are_named(tmp_path: Path, text: str, found: str) -> None:
    """A table of other columns or values is one line with file, line and column."""
    path = tmp_path / "table.csv"
    path.write_text(text)

    with pytest.raises(OutputError, match=found):
        read_csv(path, Line)


def test_table_that_is_no_text_is_named(tmp_path: Path) -> None:
    """Bytes that are no UTF-8, or no file, are one line."""
    path = tmp_path / "table.csv"
    path.write_bytes(b"\xff\xfe")

    with pytest.raises(OutputError, match=r"table.csv: cannot be read as a table"):
        read_csv(path, Line)
    with pytest.raises(OutputError, match=r"gone.csv: cannot be read"):
        read_csv(tmp_path / "gone.csv", Line)
