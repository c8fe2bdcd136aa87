"""The runs whose results lie in a folder, and their tables."""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from mpap_cli.errors import OutputError
from mpap_cli.outputs.results_record import SETTINGS_NAME, Results, read_record, sha256_of

COMMANDS = (
    "learn",
    "merge",
    "evaluate",
    "predict",
    "novelty",
    "compare",
    "extract",
    "similar",
    "cluster",
    "reproduce",
)
"""Commands that leave results, in the order in which one would use them."""

MOST_BYTES = 1 << 28
"""Of a table; larger ones are left out: the results are in place, and the page must not wait."""

MOST_ROWS = 5_000_000
MOST_SIGNS = 500
"""Of what is shown of one cell."""

Row = dict[str, str]


@dataclass(frozen=True, slots=True)
class Runs:
    """Whole results by command, and in words what was found broken."""

    by_command: dict[str, Results]
    problems: list[str] = field(default_factory=list)

    def warnings(self) -> list[str]:
        """Return what was found broken, and what the runs warned of."""
        told = [f"{one.command}: {t}" for one in self.by_command.values() for t in one.warnings]
        return [*self.problems, *told]

    def path(self, command: str, name: str) -> Path | None:
        """Return an output, None where no run wrote it."""
        results = self.by_command.get(command)
        return results.path(name) if results and name in results.outputs else None

    def rows(self, command: str, name: str, most: int = 100_000) -> Iterator[Row]:
        """Yield the first rows of a table, none where no run wrote it."""
        path = self.path(command, name)
        if path is None:
            return
        with path.open(encoding="utf-8", newline="") as stream:
            yield from islice(csv.DictReader(stream), most)

    def chosen(self, command: str, name: str, columns: Sequence[str]) -> Iterator[list[str]]:
        """Yield some cells of each row, without a dictionary for each; empty if not there."""
        path = self.path(command, name)
        if path is None:
            return
        with path.open(encoding="utf-8", newline="") as stream:
            lines = csv.reader(stream)
            header = next(lines, [])
            places = [header.index(name) if name in header else None for name in columns]
            for line in islice(lines, MOST_ROWS):
                yield ["" if at is None else line[at] for at in places]


def find_runs(out: Path) -> Runs:
    """Find the results of every command in a folder.

    Tables that are not those which their settings name (two runs mixed, or changed by hand)
    make a problem, and the run is left out; the recording, which may be large, is not looked at.
    """
    runs = Runs({})
    for command in COMMANDS:
        folder = out / command
        if not (folder / SETTINGS_NAME).is_file():
            continue
        try:
            results = read_record(folder)
            _require_tables(results)
        except OutputError as err:
            runs.problems.append(str(err))
        else:
            runs.by_command[command] = results
    return runs


def _require_tables(results: Results) -> None:
    """Hold the small outputs against their SHA-256."""
    for name, digest in results.outputs.items():
        if name.endswith((".csv", "exemplars.npz")):
            path = results.folder / name
            if path.is_file() and path.stat().st_size > MOST_BYTES:
                msg = f"{results.command}/{name} is too large for the page ({MOST_BYTES:,} bytes)"
                raise OutputError(msg)
            if not path.is_file() or sha256_of(path) != digest:
                command = results.command
                msg = (
                    f"{command}/{name} is not the file that {command}/settings.json names; "
                    f"run mpap {command} again"
                )
                raise OutputError(msg)


def number(text: str) -> float | None:
    """Return the number in a cell, None if it is empty.

    >>> number("0.5"), number("")
    (0.5, None)
    """
    return float(text) if text else None
