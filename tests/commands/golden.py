"""Tables that were found right once: compared number by number, or rewritten."""

import csv
import os
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent / "golden"
# relative and absolute; sums of float32 differ in the last digits from processor to processor
CLOSE = (1e-5, 1e-7)
# the trees and regressions of scikit-learn change from version to version
FITTED = (0.1, 0.05)
FITTED_METHODS = ("logistic-regression", "random-forest", "k-means")


def assert_golden(path: Path, name: str) -> None:
    """Compare a table with the golden one of this name.

    With MPAP_REWRITE_GOLDEN=1 the golden one is written instead. Columns named seconds
    are not looked at.
    """
    golden = FOLDER / name
    if os.environ.get("MPAP_REWRITE_GOLDEN") == "1":
        golden.parent.mkdir(exist_ok=True)
        golden.write_bytes(path.read_bytes())
    found, expected = _table(path), _table(golden)
    assert found[0] == expected[0]
    assert len(found) == len(expected)
    for cells, wanted in zip(found[1:], expected[1:], strict=True):
        tolerance = FITTED if wanted[0] in FITTED_METHODS else CLOSE
        for column, cell, want in zip(found[0], cells, wanted, strict=True):
            if column != "seconds":
                assert _value(cell) == _expected(want, tolerance), (column, cells)


def _table(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


def _expected(cell: str, tolerance: tuple[float, float]) -> object:
    """Return what a cell may read; whole numbers and words are exact."""
    value = _value(cell)
    relative, absolute = tolerance
    return pytest.approx(value, relative, absolute) if isinstance(value, float) else value


def _value(cell: str) -> int | float | str:
    """Return a cell as a number if it is one."""
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell
