"""Tables of results as the page shows them: the columns that matter, short numbers."""

from dataclasses import dataclass
from itertools import islice

from mpap_cli.outputs.report.runs import MOST_SIGNS, Runs

MOST_ROWS = 200
_DIGITS = 4


@dataclass(frozen=True, slots=True)
class TableView:
    """One table: where it comes from, its columns and cells, and how many rows are not shown."""

    command: str
    name: str
    columns: tuple[str, ...]
    rows: list[list[str]]
    is_cut: bool


_SHOWN: dict[tuple[str, str], tuple[str, ...]] = {
    ("evaluate", "auc.csv"): (
        "method",
        "feature",
        "bins",
        "profile",
        "target",
        "protocol",
        "auc",
        "auc_low",
        "auc_high",
        "auc_in_sample",
        "average_precision",
        "brier_skill",
        "positives",
        "negatives",
        "presses",
        "logs",
        "clusters",
    ),
    ("evaluate", "differences.csv"): (
        "method",
        "against",
        "scored",
        "logs",
        "diff_per_log",
        "diff_per_log_low",
        "diff_per_log_high",
    ),
    ("compare", "compare.csv"): ("log", "against", "observations", "unknown", "percent_unknown"),
    ("extract", "segments.csv"): (
        "log",
        "start_s",
        "end_s",
        "reason",
        "score",
        "cluster",
        "messages",
        "bytes",
    ),
    ("similar", "similar.csv"): ("log", "time_s", "cluster", "distance"),
    ("cluster", "cluster.csv"): (
        "method",
        "variant",
        "clusters",
        "points",
        "coverage",
        "v_measure",
        "homogeneity",
        "completeness",
        "ari",
        "seconds",
    ),
}


def table_views(runs: Runs) -> list[TableView]:
    """Return the tables that are there, at most 200 rows of each."""
    found = []
    for (command, name), columns in _SHOWN.items():
        lines = list(islice(runs.chosen(command, name, columns), MOST_ROWS + 1))
        if lines:
            rows = [[short(cell[:MOST_SIGNS]) for cell in line] for line in lines[:MOST_ROWS]]
            found.append(TableView(command, name, columns, rows, len(lines) > MOST_ROWS))
    return found


def short(cell: str) -> str:
    """Return a cell with four digits at most, if it is a number with a fraction.

    >>> short("0.83411478"), short("12"), short("mpap")
    ('0.8341', '12', 'mpap')
    """
    try:
        value = float(cell) if "." in cell else None
    except ValueError:
        return cell
    if value is None:
        return cell
    return f"{value:.0f}" if abs(value) >= 10**_DIGITS else f"{value:.{_DIGITS}g}"
