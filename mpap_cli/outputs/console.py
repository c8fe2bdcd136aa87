"""Talk and tables for people: color and bars only where there is a terminal for them."""

import math
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Protocol, TextIO, TypeVar, get_args, get_type_hints

import numpy as np

from mpap_cli.outputs.tables import columns_of, csv_text, json_text
from mpap_cli.outputs.text_table import aligned, printable

Row = TypeVar("Row")


def is_styled(stream: TextIO) -> bool:
    """Tell whether color and bars are welcome.

    Parameters
    ----------
    stream : file
        Where the text goes.

    Returns
    -------
    bool
        True on a terminal that can move its cursor, unless NO_COLOR is set.
    """
    plain = bool(os.environ.get("NO_COLOR")) or os.environ.get("TERM") == "dumb"
    return stream.isatty() and not plain


def shown(value: object) -> str:
    """Return a value as people read it; tables for machines use ``tables.cell_text``.

    >>> shown(None), shown(True), shown(0.8349), shown(1234567)
    ('-', 'yes', '0.83', '1234567')
    """
    if value is None:
        return "-"
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return "-" if math.isnan(value) else f"{value:.2f}"
    return str(value)


def _numeric_columns(row_type: type) -> set[int]:
    """Return the columns of numbers."""
    kinds = get_type_hints(row_type)
    wanted = {int, float}
    return {
        index
        for index, name in enumerate(columns_of(row_type))
        if wanted & set(get_args(kinds[name]) or (kinds[name],))
    }


def table_text(row_type: type[Row], rows: Iterable[Row]) -> str:
    r"""Return rows as plain aligned text, numbers flush right.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Score:
    ...     method: str
    ...     auc: float | None
    >>> table_text(Score, [Score("mpap", 0.5), Score("k-means", None)])
    'method    auc\nmpap     0.50\nk-means     -\n'
    """
    names = columns_of(row_type)
    lines = [names, *(tuple(shown(getattr(row, name)) for name in names) for row in rows)]
    return "".join(f"{line}\n" for line in aligned(lines, _numeric_columns(row_type)))


def print_rows(row_type: type[Row], rows: Sequence[Row], form: str, stream: TextIO) -> None:
    """Print a table as ``--format`` asks for it.

    Parameters
    ----------
    row_type : type
        Dataclass of the rows; its fields in order are the columns.
    rows : sequence
        The rows.
    form : str
        ``table``, ``csv`` or ``json``. A table is styled where :func:`is_styled` says so,
        else plain aligned text.
    stream : file
        Where it goes, by custom stdout.
    """
    texts: dict[str, Callable[[type[Row], Iterable[Row]], str]] = {
        "table": table_text,
        "csv": csv_text,
        "json": json_text,
    }
    if form == "table" and is_styled(stream):
        _print_styled(row_type, rows, stream)
    else:
        stream.write(texts[form](row_type, rows))


def _print_styled(row_type: type[Row], rows: Sequence[Row], stream: TextIO) -> None:
    """Print a table on a terminal."""
    from rich.box import SIMPLE_HEAD  # noqa: PLC0415  # only where there is a terminal
    from rich.console import Console  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    table = Table(box=SIMPLE_HEAD, pad_edge=False, header_style="bold")
    right = _numeric_columns(row_type)
    for index, name in enumerate(columns_of(row_type)):
        table.add_column(name, justify="right" if index in right else "left", overflow="fold")
    for row in rows:
        # Text, because a name like [red] from a log must not be read as markup
        values = (shown(getattr(row, name)) for name in columns_of(row_type))
        table.add_row(*(Text(printable(value)) for value in values))
    Console(file=stream, highlight=False).print(table)


class Report(Protocol):
    """Told how far a replay is."""

    def __call__(self, done_s: float, n_observations: int) -> None:
        """Take the seconds of log time that are done and the observations so far."""
        ...


def _ignore(done_s: float, n_observations: int) -> None:  # as Report has it
    """Report nothing."""


@contextmanager
def progress(
    title: str, total_s: float | None, *, quiet: bool = False, stream: TextIO | None = None
) -> Iterator[Report]:
    """Show how far a replay is: observations per second, speed against real time, time left.

    Parameters
    ----------
    title : str
        What is done.
    total_s : float or None
        Seconds of log time that there are; None if not known.
    quiet : bool
        Show nothing.
    stream : file, optional
        Where the bar goes; stderr if not given. Nothing is shown unless it is a terminal.

    Yields
    ------
    callable
        To be told the seconds of log time done and the number of observations so far; cheap
        enough for every block.
    """
    stream = sys.stderr if stream is None else stream
    if quiet or not is_styled(stream):
        yield _ignore
        return
    bar = _bar(stream)
    with bar:
        task = bar.add_task(printable(title), total=total_s, speed="")

        def report(done_s: float, n_observations: int) -> None:
            elapsed = bar.tasks[0].elapsed or 0.0
            bar.update(task, completed=done_s, speed=speed_text(done_s, n_observations, elapsed))

        yield report


def _bar(stream: TextIO) -> Any:
    """Make the bar; stdout is left alone, it may go elsewhere."""
    from rich import progress as parts  # noqa: PLC0415  # only where there is a terminal
    from rich.console import Console  # noqa: PLC0415

    return parts.Progress(
        parts.TextColumn("{task.description}", markup=False),
        parts.BarColumn(),
        parts.TextColumn("{task.fields[speed]}", markup=False),
        parts.TimeRemainingColumn(),
        console=Console(file=stream),
        redirect_stdout=False,
        transient=True,
    )


def speed_text(done_s: float, n_observations: int, elapsed_s: float) -> str:
    """Return the speed of a replay in words.

    >>> speed_text(120.0, 600, 2.0)
    '300 observations/s, 60 x real time'
    """
    if elapsed_s <= 0:
        return ""
    return (
        f"{n_observations / elapsed_s:,.0f} observations/s, {done_s / elapsed_s:,.0f} x real time"
    )
