"""Tables as CSV and JSON."""

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

from mpap_cli.outputs.tables import columns_of, csv_text, json_text, write_csv


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


def read_back(text: str) -> list[Line]:
    """Read a table by the rules that the cells are written by."""
    lines = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    return [
        Line(
            log=line["log"],
            scans=int(line["scans"]),
            predicted={"0": False, "1": True}[line["predicted"]],
            p=float(line["p"]),
            auc=float(line["auc"]) if line["auc"] else None,
            cluster=int(line["cluster"]) if line["cluster"] else None,
        )
        for line in lines
    ]


@given(st.lists(LINES, max_size=5))
def test_tables_round_trip(tmp_path_factory: pytest.TempPathFactory, rows: list[Line]) -> None:
    """What is written comes back, whatever the texts and numbers."""
    path = tmp_path_factory.mktemp("table") / "table.csv"

    n_rows = write_csv(path, Line, rows)

    assert n_rows == len(rows)
    assert csv_text(Line, rows).encode() == path.read_bytes()
    assert read_back(csv_text(Line, rows)) == rows


def test_none_and_nan_are_empty_cells(tmp_path: Path) -> None:
    """Nothing known is nothing written."""
    path = tmp_path / "table.csv"

    write_csv(path, Line, [Line("a", 1, True, math.nan, math.nan, None)])

    assert path.read_bytes() == b"log,scans,predicted,p,auc,cluster\na,1,1,,,\n"


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

    assert path.read_text(encoding="utf-8").splitlines()[1] == "a\\udcff.bag,1,0,0.5,,"


def test_lines_end_in_newlines_only() -> None:
    """A carriage return in a name stays inside quotes and adds none elsewhere."""
    text = csv_text(Line, [Line("a\rb\n", 1, False, 0.5, None, None)])

    rows = list(csv.reader(io.StringIO(text, newline="")))

    assert text.count("\r") == 1
    assert rows[1][0] == "a\rb\n"
