"""Tables: frozen dataclasses in, CSV or JSON out; the fields in order are the columns.

None and NaN are empty cells (``null`` in JSON), truth values are 1 and 0, floats carry
as many digits as they need to come back unchanged, infinities read ``inf`` and ``-inf``.
"""

import csv
import io
import json
import math
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from types import TracebackType
from typing import Generic, Self, TextIO, TypeVar

import numpy as np

Row = TypeVar("Row")


def columns_of(row_type: type) -> tuple[str, ...]:
    """Return the names of the columns of a row's type, in order."""
    return tuple(item.name for item in fields(row_type))


def cell_text(value: object) -> str:
    """Write one value as the text of a CSV cell.

    Parameters
    ----------
    value : object
        None, str, bool, int, float or a numpy scalar.

    Returns
    -------
    str
        Empty for None and NaN, 1 or 0 for truth values; floats come back unchanged.

    Examples
    --------
    >>> cell_text(0.1), cell_text(float("nan")), cell_text(True)
    ('0.1', '', '1')
    """
    if value is None:
        return ""
    if isinstance(value, (bool, np.bool_)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        # str of a float32 is the shortest text that gives this float32 again
        return "" if math.isnan(value) else str(value)
    return str(value)


class _UnixLines:
    """File for csv.writer that ends lines with a bare newline.

    The writer itself must end them with both characters, else it leaves a carriage
    return inside a cell without quotes and no reader can find the end of the row.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, line: str) -> int:
        """Write one row."""
        return self._stream.write(line.removesuffix("\r\n") + "\n")


def _write_rows(stream: TextIO, row_type: type[Row], rows: Iterable[Row]) -> int:
    """Write the header and the rows; return how many rows there were."""
    names = columns_of(row_type)
    writer = csv.writer(_UnixLines(stream), lineterminator="\r\n")
    writer.writerow(names)
    n_rows = 0
    for row in rows:
        writer.writerow([cell_text(getattr(row, name)) for name in names])
        n_rows += 1
    return n_rows


def write_csv(path: Path, row_type: type[Row], rows: Iterable[Row]) -> int:
    r"""Write rows as CSV: UTF-8, one header line, lines end with ``\n``.

    Parameters
    ----------
    path : Path
        File to write; an older one is overwritten.
    row_type : type
        Dataclass of the rows; its fields in order are the columns.
    rows : iterable
        Rows; they are taken one by one and not kept.

    Returns
    -------
    int
        Number of rows.

    Raises
    ------
    OSError
        If the file cannot be written.

    Notes
    -----
    A file name that is no valid text keeps its odd bytes as ``\udcxx``.
    """
    with path.open("w", encoding="utf-8", errors="backslashreplace", newline="") as stream:
        return _write_rows(stream, row_type, rows)


class TableWriter(Generic[Row]):
    """Context manager that writes a table bit by bit, as :func:`write_csv` does at once."""

    def __init__(self, path: Path, row_type: type[Row]) -> None:
        self._names = columns_of(row_type)
        self._stream = path.open("w", encoding="utf-8", errors="backslashreplace", newline="")
        self._writer = csv.writer(_UnixLines(self._stream), lineterminator="\r\n")
        self._writer.writerow(self._names)

    def add(self, rows: Iterable[Row]) -> None:
        """Append rows."""
        for row in rows:
            self._writer.writerow([cell_text(getattr(row, name)) for name in self._names])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stream.close()


def csv_text(row_type: type[Row], rows: Iterable[Row]) -> str:
    r"""Return rows as CSV text, as :func:`write_csv` writes it.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Pair:
    ...     name: str
    ...     auc: float | None
    >>> csv_text(Pair, [Pair("mpap", 0.5), Pair("k-means", None)])
    'name,auc\nmpap,0.5\nk-means,\n'
    """
    stream = io.StringIO(newline="")
    _write_rows(stream, row_type, rows)
    return stream.getvalue()


def json_value(value: object) -> object:
    """Turn one value into what JSON can hold; NaN becomes None, infinity a word."""
    if isinstance(value, np.generic):
        is_short = isinstance(value, np.floating)
        value = float(str(value)) if is_short else value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def json_text(row_type: type[Row], rows: Iterable[Row]) -> str:
    r"""Return rows as a JSON list of objects, keys in the order of the columns.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Pair:
    ...     name: str
    ...     auc: float | None
    >>> json_text(Pair, [Pair("mpap", float("nan"))])
    '[\n  {\n    "name": "mpap",\n    "auc": null\n  }\n]\n'
    """
    names = columns_of(row_type)
    records = [{name: json_value(getattr(row, name)) for name in names} for row in rows]
    return json.dumps(records, indent=2, allow_nan=False) + "\n"
